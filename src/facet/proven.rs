//! The penalty that is provably enough.

use super::FacetView;

/// The least weight for which the symmetric interior penalty form is provably positive definite:
///
/// ```text
/// w_F C_p max_K ( alpha_F^2 / alpha_K  |dK| / |K| ),   C_p = p (p + D - 1) / D
/// ```
///
/// with `p` the given degree, that of the basis functions, `w_F` 1/2 on interior and 1 on Dirichlet facets, `|dK|` the measure of the boundary of cell
/// `K`, `alpha_F` the harmonic mean of the coefficients and `alpha_K` the coefficient of the cell. Where the
/// coefficient varies in a cell, `alpha_F` is made of the largest values on the facet and `alpha_K` is
/// [`Side::bound_coefficient`](super::Side::bound_coefficient). Derivation: the consistency terms are
/// bounded by `sum_K sum_{F in dK} w_F |F| alpha_F^2 (d_n v)^2 / sigma_F`, and on a simplex
/// `||grad v||_F^2 <= C_p |F|/|K| ||grad v||_K^2` for `grad v` of degree `p - 1`
/// (T. Warburton, J. S. Hesthaven, CMAME 192 (2003), 2765-2773).
#[inline(always)]
pub fn proven_bound<const D: usize>(degree: usize, facet: &FacetView<D>) -> f64 {
    let weight = if facet.there.is_some() { 0.5 } else { 1.0 };
    let constant = (degree * (degree + D - 1)) as f64 / D as f64;
    let mean = facet.coefficient();
    let ratio =
        facet.largest(|side| mean * mean / side.bound_coefficient * side.surface / side.volume);
    (weight * constant) * ratio
}
