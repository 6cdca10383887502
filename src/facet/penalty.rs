//! Interior penalty and over-penalty.

use super::{FacetForm, FacetView, Sampling, Trace};
use crate::real::Real;
use crate::study::PenaltyParameters;

/// How an interior penalty gets its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PenaltyRule {
    /// The provable bound times one plus this margin.
    Proven(f64),
    /// This factor times the coefficient over the facet's diameter.
    Diameter(f64),
}

/// The least weight for which the symmetric interior penalty form is provably positive definite:
///
/// ```text
/// w_F C_p max_K ( alpha_F^2 / alpha_K  |dK| / |K| ),   C_p = p (p + D - 1) / D
/// ```
///
/// with `w_F` 1/2 on interior and 1 on Dirichlet facets, `|dK|` the measure of the boundary of cell
/// `K` and `alpha_F` the harmonic mean of the coefficients. Derivation: the consistency terms are
/// bounded by `sum_K sum_{F in dK} w_F |F| alpha_F^2 (d_n v)^2 / sigma_F`, and on a simplex
/// `||grad v||_F^2 <= C_p |F|/|K| ||grad v||_K^2` for `grad v` of degree `p - 1`
/// (T. Warburton, J. S. Hesthaven, CMAME 192 (2003), 2765-2773).
pub fn proven_bound<T: Real, const D: usize>(degree: usize, facet: &FacetView<T>) -> T {
    let weight = if facet.there.is_some() { 0.5 } else { 1.0 };
    let constant = (degree * (degree + D - 1)) as f64 / D as f64;
    let mean = facet.coefficient();
    let ratio = facet.largest(|side| mean * mean / side.coefficient * side.surface / side.volume);
    T::lit(weight * constant) * ratio
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

impl<T: Real, const D: usize, const THETA: i8> FacetForm<T, D> for InteriorPenalty<THETA> {
    const USES_FLUX: bool = true;
    const SYMMETRIC: bool = THETA == -1;

    fn penalty(&self, facet: &FacetView<T>) -> T {
        match self.rule {
            PenaltyRule::Proven(margin) => {
                T::lit(1.0 + margin) * proven_bound::<T, D>(self.degree, facet)
            }
            PenaltyRule::Diameter(sigma) => T::lit(sigma) * facet.coefficient() / facet.diameter,
        }
    }
    fn least_penalty(&self, facet: &FacetView<T>) -> Option<T> {
        match self.rule {
            // the non-symmetric form is coercive for every positive weight
            PenaltyRule::Diameter(_) if THETA < 1 => {
                // coercivity of the incomplete form needs a quarter of what the symmetric one does
                let share = if THETA == 0 { 0.25 } else { 1.0 };
                Some(T::lit(share) * proven_bound::<T, D>(self.degree, facet))
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

/// How the over-penalty gets its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WeightRule {
    /// `eta h_F^-3`.
    Isotropic,
    /// `eta h^-2 (sqrt(l_here) + sqrt(l_there))^-2`, on the boundary `eta h^-2 / l`, with `l` the
    /// height of a cell over the facet and `h` the mesh size: robust on stretched meshes.
    ///
    /// Source: H. Ishizaka, arXiv 2212.03822 and 2403.07899.
    Anisotropic,
}

/// `kappa_F P[u] P[v]`, `P` the mean over the facet: the weak over-penalty, without consistency
/// terms and without normal derivatives. The weight carries the coefficient's harmonic mean.
///
/// Source: S. C. Brenner, L. Owens, L.-Y. Sung, ETNA 30 (2008), 107-127.
#[derive(Clone, Copy, Debug)]
pub struct OverPenalty {
    /// The factor, of the dimension of a length squared.
    pub eta: f64,
    /// How it becomes a weight.
    pub rule: WeightRule,
    /// The largest cell diameter, for the anisotropic rule.
    pub mesh_size: f64,
}

impl<T: Real, const D: usize> FacetForm<T, D> for OverPenalty {
    const USES_FLUX: bool = false;

    fn sampling(_: usize) -> Sampling {
        Sampling::Means
    }
    fn penalty(&self, facet: &FacetView<T>) -> T {
        let eta = T::lit(self.eta) * facet.coefficient();
        match self.rule {
            WeightRule::Isotropic => {
                let h = facet.diameter;
                eta / (h * h * h)
            }
            WeightRule::Anisotropic => {
                let root = nalgebra::ComplexField::sqrt(facet.here.height);
                let length = match &facet.there {
                    None => facet.here.height,
                    Some(there) => {
                        let sum = root + nalgebra::ComplexField::sqrt(there.height);
                        sum * sum
                    }
                };
                let h = T::lit(self.mesh_size);
                eta / (h * h * length)
            }
        }
    }
    /// With lengths in units of the domain's diameter the condition number grows like `eta h^-4`
    /// and the discretisation error falls like `h^2`: they meet at the sixth root of
    /// `epsilon eta`.
    fn rounding_limit(&self, epsilon: f64, length: f64) -> f64 {
        0.5 * length * (epsilon * self.eta / (length * length)).powf(1.0 / 6.0)
    }
    fn parameters(&self) -> PenaltyParameters {
        let rule = match self.rule {
            WeightRule::Isotropic => "eta / h_F^3",
            WeightRule::Anisotropic => "eta / (h^2 l_F)",
        };
        PenaltyParameters { sigma: None, eta: Some(self.eta), rule: Some(rule.to_owned()) }
    }
    #[inline(always)]
    fn integrand(&self, v: Trace<T>, u: Trace<T>, penalty: T) -> T {
        penalty * u.jump * v.jump
    }
}
