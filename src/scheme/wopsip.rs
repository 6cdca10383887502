//! The weakly over-penalised symmetric interior penalty method.

use std::sync::Arc;

use super::{
    ExpectedOrders, Scheme, SchemeOptions, Setting, broken_energy_order, name_of_degree,
    with_duality,
};
use crate::element::{Broken, Element, P1};
use crate::facet::{FacetForm, OverPenalty, WeightRule};
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

/// Weak over-penalty on broken elements: no consistency terms, positive definite for every factor.
///
/// Orders: Y. Zeng, J. Chen, F. Wang, Comput. Math. Appl. 69 (2015), energy norm, both inequalities,
/// for linears; S. C. Brenner, L. Owens, L.-Y. Sung, J. Comput. Appl. Math. 236 (2012), 2883-2894 for
/// equations in the plane with quadratics, for which nothing is proven under inequalities.
#[derive(Clone, Debug)]
pub struct Wopsip<const D: usize> {
    /// The factor.
    pub eta: Eta,
    /// How the factor becomes a weight.
    pub weight: WeightRule,
    /// The element, which is broken.
    pub element: Arc<dyn Element<D>>,
}

impl<const D: usize> Default for Wopsip<D> {
    fn default() -> Self {
        let eta = Eta::Dimensionless(1.0);
        Self { eta, weight: WeightRule::Isotropic, element: Arc::new(Broken(P1)) }
    }
}

impl<const D: usize> Wopsip<D> {
    /// The scheme by name: with what the options give.
    pub(super) fn with_options(options: &SchemeOptions) -> Self {
        let chosen = options.eta.map(Eta::Absolute).or(options.factor.map(Eta::Dimensionless));
        let default = Self::default();
        Self {
            eta: chosen.unwrap_or(default.eta),
            weight: options.weight.unwrap_or(default.weight),
            ..default
        }
    }
    /// The scheme on the broken version of another element: `Wopsip::default().on(P2)`.
    #[must_use]
    pub fn on(self, element: impl Element<D> + 'static) -> Self {
        Self { element: Arc::new(Broken(element)), ..self }
    }
}

impl<const D: usize> Scheme<D> for Wopsip<D> {
    fn name(&self) -> &str {
        name_of_degree!("wopsip", self.element.degree())
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        self.element.clone()
    }
    fn is_consistent(&self) -> bool {
        false
    }
    fn choices(&self) -> SchemeOptions {
        let weight = Some(self.weight).filter(|&weight| weight != WeightRule::Isotropic);
        let none = SchemeOptions { weight, ..SchemeOptions::default() };
        match self.eta {
            eta if eta == Self::default().eta => none,
            Eta::Dimensionless(factor) => SchemeOptions { factor: Some(factor), ..none },
            Eta::Absolute(eta) => SchemeOptions { eta: Some(eta), ..none },
        }
    }
    fn form(&self, mesh: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let degree = self.element.degree();
        let eta = match self.eta {
            Eta::Absolute(eta) => eta,
            Eta::Dimensionless(factor) => factor * mesh.domain_diameter().powi(2 * degree as i32),
        };
        let mesh_size = match self.weight {
            WeightRule::Isotropic => f64::NAN,
            WeightRule::Anisotropic => mesh.mesh_size(),
        };
        Box::new(OverPenalty { eta, degree, rule: self.weight, mesh_size })
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        match self.element.degree() {
            2 if !setting.is_linear() || setting.dimension > 2 => ExpectedOrders::default(),
            degree => with_duality(broken_energy_order(setting, degree), setting),
        }
    }
}
