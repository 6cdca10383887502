//! Forms made of lifts of jumps.

use super::{FacetForm, FacetView, FormTheory, PenaltyParameters, Trace};
use crate::arrays::map_entries;

/// The degree of the polynomials that jumps are lifted to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lifts {
    /// The degree of the element less one, the least for which the form is consistent: D. N. Arnold,
    /// F. Brezzi, B. Cockburn, L. D. Marini, SIAM J. Numer. Anal. 39 (2002), 1749-1779. A penalty made
    /// of such lifts sees the moments of jumps up to this degree only, on linears their means; what
    /// remains of a jump is bounded by the gradient on either side, so that orders stand.
    #[default]
    Reduced,
    /// The degree of the element: a penalty made of such lifts bounds the whole jump, on which the proofs of
    /// F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 rest.
    Full,
}

impl Lifts {
    /// The degree on an element whose basis functions have at most this degree.
    pub fn degree(self, element: usize) -> usize {
        match self {
            Self::Reduced => element - 1,
            Self::Full => element,
        }
    }
}

/// `eta sum_F int alpha r_F(u) . r_F(v)` with the consistency terms of the symmetric interior
/// penalty: the lifts of single facets as a penalty.
///
/// With `w` the coefficient `alpha_F` times the average weight of a cell, the lift of a moment `m`
/// of the jump has the energy `w^2 / alpha |F|^2 / |K| c(m)` in each cell of the facet, where `c`
/// depends on the degree of the moment and of the lift only. Coercive for `eta` above the number of facets of a cell, because the
/// square of a sum of so many lifts is at most so many times the sum of their squares.
///
/// Source: F. Bassi, S. Rebay, G. Mariotti, S. Pedinotti, M. Savini, 2nd European Conference on
/// Turbomachinery (1997), 99-108; F. Brezzi, G. Manzini, L. D. Marini, P. Pietra, A. Russo, Numer.
/// Methods Partial Differential Equations 16 (2000), 365-378.
#[derive(Clone, Copy, Debug)]
pub struct FacetLifts {
    /// The factor, without dimension.
    pub eta: f64,
    /// The degree of the lifts.
    pub lift_degree: usize,
    /// Whether `int alpha r(u) . r(v)` is added, with which the form is coercive for every positive `eta`;
    /// without it `eta` must be above the number of facets of a cell.
    pub with_all_lifts: bool,
}

impl FacetLifts {
    fn weight<const D: usize>(eta: f64, facet: &FacetView<D>) -> f64 {
        let average = if facet.there.is_some() { 0.5 } else { 1.0 };
        let w = facet.coefficient() * average;
        let energy =
            facet.sum(|side| w * w * facet.measure / (side.bound_coefficient * side.volume));
        eta * energy
    }
}

impl<const D: usize> FacetForm<D> for FacetLifts {
    fn is_lifted(&self) -> bool {
        self.with_all_lifts
    }
    fn moments(&self, _: usize) -> usize {
        self.lift_degree
    }
    fn lift_degree(&self, _: usize) -> usize {
        self.lift_degree
    }
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        Self::weight(self.eta, facet)
    }
    /// `|K| / |F|^2 int_K s^2` for the polynomial `s` of the lift's degree `p - 1` with
    /// `int_K s q = int_F e q`, `e` a normalised moment of degree `m`: `(p - m)(p + m + D - 1) / D`,
    /// the sum over `j < p - m` of `(2 j + 2 m + D) / D`, the squares on the facet of the orthonormal
    /// polynomials that are `e` times a Jacobi polynomial of degree `j` in the height.
    fn moment_weight(&self, moment: usize) -> f64 {
        let [d, p, m] = map_entries([D, self.lift_degree + 1, moment], |k| k as f64);
        (p - m) * (p + m + d - 1.0) / d
    }
    fn theory(&self) -> FormTheory<'_, D> {
        let (eta, rule) = (Some(self.eta), Some("eta int r_F . r_F".to_owned()));
        let parameters = PenaltyParameters { sigma: None, eta, rule };
        let theory = FormTheory { parameters, ..FormTheory::default() };
        match self.with_all_lifts {
            true => theory.with_coercivity(self.eta > 0.0),
            false => theory.with_least_penalty(|facet| Self::weight((D + 1) as f64, facet)),
        }
    }
    fn is_uniform(&self) -> bool {
        true
    }
    #[inline(always)]
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump - u.flux * v.jump - v.flux * u.jump
    }
}
