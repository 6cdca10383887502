//! The weakly over-penalised symmetric interior penalty method.

use super::{DirichletBy, Scheme, Setting, linear_energy_order};
use crate::element::{Broken, P1};
use crate::facet::{OverPenalty, WeightRule};
use crate::mesh::Mesh;
use crate::real::Real;
use crate::study::ExpectedOrders;

/// How the factor of the over-penalty is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eta {
    /// This number times the square of the domain's diameter: invariant under scaling.
    Dimensionless(f64),
    /// This number as it stands, of the dimension of a length squared.
    Absolute(f64),
}

/// Weak over-penalty on broken linears: no consistency terms, positive definite for every factor.
///
/// Orders: Y. Zeng, J. Chen, F. Wang, Comput. Math. Appl. 69 (2015), energy norm, both inequalities.
#[derive(Clone, Copy, Debug)]
pub struct Wopsip {
    /// The factor.
    pub eta: Eta,
    /// How it becomes a weight.
    pub weight: WeightRule,
}

impl Default for Wopsip {
    fn default() -> Self {
        Self { eta: Eta::Dimensionless(1.0), weight: WeightRule::Isotropic }
    }
}

impl<T: Real, const D: usize> Scheme<T, D> for Wopsip {
    type Element = Broken<P1>;
    type Facet = OverPenalty;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;
    const CONSISTENT: bool = false;

    fn name(&self) -> &str {
        "wopsip"
    }
    fn facet(&self, mesh: &Mesh<T, D>) -> OverPenalty {
        let eta = match self.eta {
            Eta::Absolute(eta) => eta,
            Eta::Dimensionless(factor) => factor * mesh.domain_diameter().powi(2),
        };
        let mesh_size = match self.weight {
            WeightRule::Isotropic => f64::NAN,
            WeightRule::Anisotropic => mesh.mesh_size(),
        };
        OverPenalty { eta, rule: self.weight, mesh_size }
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        linear_energy_order(setting)
    }
}
