//! The weak over-penalty.

use super::{FacetForm, FacetView, FormTheory, PenaltyParameters, Trace};
use crate::mesh::Mesh;

/// How the factor of the over-penalty is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eta {
    /// This number times the domain's diameter to the power `2k`, `k` the element's degree:
    /// invariant under scaling.
    Dimensionless(f64),
    /// This number as it stands, of the dimension of a length to the power `2k`.
    Absolute(f64),
}

/// How the over-penalty gets its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WeightRule {
    /// `eta h_F^-(2k+1)` for elements of degree `k`.
    Isotropic,
    /// `eta h^-2k (sqrt(l_here) + sqrt(l_there))^-2`, on the boundary `eta h^-2k / l`, with `l` the
    /// height of a cell over the facet and `h` the mesh size: robust on stretched meshes.
    ///
    /// Source: H. Ishizaka, arXiv 2212.03822 and 2403.07899.
    Anisotropic,
}

/// `kappa_F P[u] P[v]`, `P` the projection on polynomials of degree `k - 1` on the facet, its mean
/// for linear elements: the weak over-penalty, without consistency terms and without normal
/// derivatives. The weight contains the harmonic mean of the coefficients.
///
/// Source: S. C. Brenner, L. Owens, L.-Y. Sung, ETNA 30 (2008), 107-127; for degrees above one
/// S. C. Brenner, L. Owens, L.-Y. Sung, J. Comput. Appl. Math. 236 (2012), 2883-2894.
#[derive(Clone, Copy, Debug)]
pub struct OverPenalty {
    /// The factor, of the dimension of a length to the power `2k`.
    pub eta: f64,
    /// The degree `k` of the polynomials that the element contains.
    pub degree: usize,
    /// How it becomes a weight.
    pub rule: WeightRule,
    /// The largest cell diameter, for the anisotropic rule.
    pub mesh_size: f64,
}

impl OverPenalty {
    /// The over-penalty on a mesh, for elements that contain all polynomials of this degree.
    pub fn new<const D: usize>(eta: Eta, rule: WeightRule, degree: usize, mesh: &Mesh<D>) -> Self {
        let eta = match eta {
            Eta::Absolute(eta) => eta,
            Eta::Dimensionless(factor) => factor * mesh.domain_diameter().powi(2 * degree as i32),
        };
        let mesh_size = match rule {
            WeightRule::Isotropic => f64::NAN,
            WeightRule::Anisotropic => mesh.mesh_size(),
        };
        Self { eta, degree, rule, mesh_size }
    }
}

impl<const D: usize> FacetForm<D> for OverPenalty {
    fn uses_flux(&self) -> bool {
        false
    }
    fn moments(&self, _: usize) -> usize {
        self.degree - 1
    }
    #[inline(always)]
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        let eta = self.eta * facet.coefficient();
        match self.rule {
            WeightRule::Isotropic => {
                let h = facet.diameter();
                (1..self.degree).fold(eta / (h * h * h), |weight, _| weight / (h * h))
            }
            WeightRule::Anisotropic => {
                let root = facet.here.height.sqrt();
                let length = match &facet.there {
                    None => facet.here.height,
                    Some(there) => {
                        let sum = root + there.height.sqrt();
                        sum * sum
                    }
                };
                let h = self.mesh_size;
                (0..self.degree).fold(eta / length, |weight, _| weight / (h * h))
            }
        }
    }
    fn theory(&self) -> FormTheory<'_, D> {
        let k = self.degree;
        let rule = match self.rule {
            WeightRule::Isotropic => format!("eta / h_F^{}", 2 * k + 1),
            WeightRule::Anisotropic => format!("eta / (h^{} l_F)", 2 * k),
        };
        let parameters = PenaltyParameters { sigma: None, eta: Some(self.eta), rule: Some(rule) };
        FormTheory { parameters, ..FormTheory::default() }.with_coercivity(self.eta > 0.0)
    }
    fn is_uniform(&self) -> bool {
        true
    }
    #[inline(always)]
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump
    }
}
