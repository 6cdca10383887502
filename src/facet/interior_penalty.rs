//! Interior penalty.

use super::{FacetForm, FacetView, FormTheory, PenaltyParameters, Trace, proven_bound};

/// How an interior penalty gets its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PenaltyRule {
    /// The provable bound of the form times one plus this margin; for the non-symmetric form, which
    /// needs no bound, that of the symmetric one.
    Proven(f64),
    /// This factor times the coefficient over the facet's diameter.
    Diameter(f64),
}

/// Which of the three forms: what becomes of `{d_n v}[u]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Subtracted: the form is symmetric (SIPG).
    Symmetric,
    /// Left out (IIPG).
    Incomplete,
    /// Added: coercive for every positive weight (NIPG).
    NonSymmetric,
}

/// `sigma_F [u][v] - {d_n u}[v] + theta {d_n v}[u]` with theta = -1, 0, 1 for the symmetric, the
/// incomplete and the non-symmetric form.
///
/// Source: D. N. Arnold, SIAM J. Numer. Anal. 19 (1982), 742-760; the family in D. N. Arnold,
/// F. Brezzi, B. Cockburn, L. D. Marini, SIAM J. Numer. Anal. 39 (2002), 1749-1779; the weights for
/// jumping coefficients in A. Ern, A. F. Stephansen, P. Zunino, IMA J. Numer. Anal. 29 (2009),
/// 235-256.
#[derive(Clone, Copy, Debug)]
pub struct InteriorPenalty {
    /// Which of the three.
    pub symmetry: Symmetry,
    /// How the weight is chosen.
    pub rule: PenaltyRule,
    /// Largest degree of a basis function of the element, for the proven bound.
    pub degree: usize,
}

impl InteriorPenalty {
    /// Which share of the symmetric form's bound is enough: the incomplete form has half of the
    /// consistency terms, and their square counts.
    fn share_of_bound(&self) -> f64 {
        if self.symmetry == Symmetry::Incomplete { 0.25 } else { 1.0 }
    }
}

impl<const D: usize> FacetForm<D> for InteriorPenalty {
    fn is_symmetric(&self) -> bool {
        self.symmetry == Symmetry::Symmetric
    }
    #[inline(always)]
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        match self.rule {
            PenaltyRule::Proven(margin) => {
                ((1.0 + margin) * self.share_of_bound()) * proven_bound::<D>(self.degree, facet)
            }
            PenaltyRule::Diameter(sigma) => sigma * facet.coefficient() / facet.diameter(),
        }
    }
    fn theory(&self) -> FormTheory<'_, D> {
        let (margin, sigma, rule) = match self.rule {
            PenaltyRule::Proven(margin) => {
                (Some(margin), None, format!("proven bound times {}", 1.0 + margin))
            }
            PenaltyRule::Diameter(sigma) => (None, Some(sigma), "sigma / h_F".to_owned()),
        };
        let parameters = PenaltyParameters { sigma, eta: None, rule: Some(rule) };
        let theory = FormTheory { parameters, margin, ..FormTheory::default() };
        match (self.rule, self.symmetry) {
            (PenaltyRule::Proven(margin), Symmetry::NonSymmetric) => {
                theory.with_coercivity(margin > -1.0)
            }
            (PenaltyRule::Diameter(sigma), Symmetry::NonSymmetric) => {
                theory.with_coercivity(sigma > 0.0)
            }
            (PenaltyRule::Proven(margin), _) if margin >= 0.0 => theory.with_coercivity(true),
            _ => theory.with_least_penalty(|facet| {
                self.share_of_bound() * proven_bound::<D>(self.degree, facet)
            }),
        }
    }
    fn is_uniform(&self) -> bool {
        true
    }
    #[inline(always)]
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        let theta = match self.symmetry {
            Symmetry::Symmetric => -1.0,
            Symmetry::Incomplete => 0.0,
            Symmetry::NonSymmetric => 1.0,
        };
        penalty * u.jump * v.jump - u.flux * v.jump + theta * v.flux * u.jump
    }
}
