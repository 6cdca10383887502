//! Interior penalty.

use super::{FacetForm, FacetView, Trace, proven_bound};
use crate::real::Real;
use crate::study::PenaltyParameters;

/// How an interior penalty gets its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PenaltyRule {
    /// The provable bound of the form times one plus this margin.
    Proven(f64),
    /// This factor times the coefficient over the facet's diameter.
    Diameter(f64),
}

/// `sigma_F [u][v] - {d_n u}[v] + theta {d_n v}[u]`: theta = -1 symmetric (SIPG), 1 non-symmetric,
/// 0 incomplete.
///
/// Source: D. N. Arnold, SIAM J. Numer. Anal. 19 (1982), 742-760; the family in D. N. Arnold,
/// F. Brezzi, B. Cockburn, L. D. Marini, SIAM J. Numer. Anal. 39 (2002), 1749-1779; the weights for
/// jumping coefficients in A. Ern, A. F. Stephansen, P. Zunino, IMA J. Numer. Anal. 29 (2009),
/// 235-256.
#[derive(Clone, Copy, Debug)]
pub struct InteriorPenalty<const THETA: i8> {
    /// How the weight is chosen.
    pub rule: PenaltyRule,
    /// Polynomial degree of the element, for the proven bound.
    pub degree: usize,
}

impl<const THETA: i8> InteriorPenalty<THETA> {
    /// Which part of the symmetric form's bound is enough: the incomplete form has half of the
    /// consistency terms, and their square counts.
    const PART: f64 = if THETA == 0 { 0.25 } else { 1.0 };
}

impl<T: Real, const D: usize, const THETA: i8> FacetForm<T, D> for InteriorPenalty<THETA> {
    const USES_FLUX: bool = true;
    const SYMMETRIC: bool = THETA == -1;

    #[inline(always)]
    fn penalty(&self, facet: &FacetView<T, D>) -> T {
        match self.rule {
            PenaltyRule::Proven(margin) => {
                T::lit((1.0 + margin) * Self::PART) * proven_bound::<T, D>(self.degree, facet)
            }
            PenaltyRule::Diameter(sigma) => T::lit(sigma) * facet.coefficient() / facet.diameter(),
        }
    }
    fn least_penalty(&self, facet: &FacetView<T, D>) -> Option<T> {
        match self.rule {
            // the non-symmetric form is coercive for every positive weight
            PenaltyRule::Diameter(_) if THETA < 1 => {
                Some(T::lit(Self::PART) * proven_bound::<T, D>(self.degree, facet))
            }
            _ => None,
        }
    }
    fn parameters(&self) -> PenaltyParameters {
        let (sigma, rule) = match self.rule {
            PenaltyRule::Proven(margin) => (None, format!("proven bound times {}", 1.0 + margin)),
            PenaltyRule::Diameter(sigma) => (Some(sigma), "sigma / h_F".to_owned()),
        };
        PenaltyParameters { sigma, eta: None, rule: Some(rule) }
    }
    #[inline(always)]
    fn integrand(&self, v: Trace<T>, u: Trace<T>, penalty: T) -> T {
        let theta = T::lit(f64::from(THETA));
        penalty * u.jump * v.jump - u.flux * v.jump + theta * v.flux * u.jump
    }
}
