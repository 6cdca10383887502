//! The local discontinuous Galerkin method.

use super::{
    BrokenScheme, ExpectedOrders, SchemeOptions, Setting, broken_energy_order, with_duality,
};
use crate::element::Element;
use crate::facet::{FacetForm, LocalFluxes};
use crate::mesh::Mesh;

/// The form [`LocalFluxes`] on broken elements, by default with the factor one, mean fluxes and lifts of degree `k - 1`
/// on elements of degree `k`.
///
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
pub type Ldg = LocalFluxes;

impl BrokenScheme for Ldg {
    fn name_on_linears(&self) -> &str {
        if self.switch { "ldg-switch" } else { "ldg" }
    }
    fn form_on<const D: usize>(&self, _: &dyn Element<D>, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(*self)
    }
    fn options(&self) -> SchemeOptions {
        SchemeOptions { sigma: Some(self.eta), lifts: Some(self.lifts), ..Default::default() }
    }
    fn with_options(self, options: &SchemeOptions) -> Self {
        let eta = options.sigma.unwrap_or(self.eta);
        Self { eta, lifts: options.lifts.unwrap_or(self.lifts), ..self }
    }
    fn orders_of_degree(&self, degree: usize, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, degree), setting)
    }
}
