//! The weakly over-penalised symmetric interior penalty method.

use super::{
    BrokenScheme, ExpectedOrders, SchemeOptions, Setting, broken_energy_order, with_duality,
};
use crate::element::Element;
use crate::facet::{Eta, FacetForm, OverPenalty, WeightRule};
use crate::mesh::Mesh;

/// Weak over-penalty on broken elements: no consistency terms, positive definite for every factor.
///
/// Orders: Y. Zeng, J. Chen, F. Wang, Comput. Math. Appl. 69 (2015), energy norm, both inequalities,
/// for linears; S. C. Brenner, L. Owens, L.-Y. Sung, J. Comput. Appl. Math. 236 (2012), 2883-2894 for
/// equations in the plane with quadratics, for which nothing is proven under inequalities, as
/// with friction for linears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wopsip {
    /// The factor.
    pub eta: Eta,
    /// How the factor becomes a weight.
    pub weight: WeightRule,
}

impl Default for Wopsip {
    fn default() -> Self {
        Self { eta: Eta::Dimensionless(1.0), weight: WeightRule::Isotropic }
    }
}

impl BrokenScheme for Wopsip {
    fn name_on_linears(&self) -> &str {
        "wopsip"
    }
    fn form_on<const D: usize>(
        &self,
        on: &dyn Element<D>,
        mesh: &Mesh<D>,
    ) -> Box<dyn FacetForm<D>> {
        Box::new(OverPenalty::new(self.eta, self.weight, on.degree(), mesh))
    }
    fn has_consistency_terms(&self) -> bool {
        false
    }
    fn options(&self) -> SchemeOptions {
        let weight = SchemeOptions { weight: Some(self.weight), ..SchemeOptions::default() };
        match self.eta {
            Eta::Dimensionless(factor) => SchemeOptions { factor: Some(factor), ..weight },
            Eta::Absolute(eta) => SchemeOptions { eta: Some(eta), ..weight },
        }
    }
    fn with_options(self, options: &SchemeOptions) -> Self {
        let chosen = options.eta.map(Eta::Absolute).or(options.factor.map(Eta::Dimensionless));
        let weight = options.weight.unwrap_or(self.weight);
        Self { eta: chosen.unwrap_or(self.eta), weight }
    }
    fn orders_of_degree(&self, degree: usize, setting: &Setting) -> ExpectedOrders {
        match degree {
            _ if setting.friction => ExpectedOrders::default(),
            2 if !setting.is_linear() || setting.dimension > 2 => ExpectedOrders::default(),
            _ => with_duality(broken_energy_order(setting, degree), setting),
        }
    }
}
