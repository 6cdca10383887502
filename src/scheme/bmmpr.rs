//! The method of Brezzi, Manzini, Marini, Pietra and Russo.

use super::{
    BrokenScheme, ExpectedOrders, SchemeOptions, Setting, broken_energy_order, with_duality,
};
use crate::element::Element;
use crate::facet::{FacetForm, FacetLifts, Lifts};
use crate::mesh::Mesh;

/// `int alpha (grad u + r(u)) . (grad v + r(v))` with a penalty by the lifts of single facets, on broken elements, by
/// default of degree `k - 1` on elements of degree `k`. The form is coercive for every positive factor.
///
/// Source: F. Brezzi, G. Manzini, L. D. Marini, P. Pietra, A. Russo, Numer. Methods Partial
/// Differential Equations 16 (2000), 365-378.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bmmpr {
    /// The factor of the penalty; by default one.
    pub eta: f64,
    /// The degree of the lifts.
    pub lifts: Lifts,
}

impl Default for Bmmpr {
    fn default() -> Self {
        Self { eta: 1.0, lifts: Lifts::Reduced }
    }
}

impl BrokenScheme for Bmmpr {
    fn name_on_linears(&self) -> &str {
        "bmmpr"
    }
    fn form_on<const D: usize>(&self, on: &dyn Element<D>, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let lift_degree = self.lifts.degree(on.basis_degree());
        Box::new(FacetLifts { eta: self.eta, lift_degree, with_all_lifts: true })
    }
    fn options(&self) -> SchemeOptions {
        SchemeOptions { factor: Some(self.eta), lifts: Some(self.lifts), ..Default::default() }
    }
    fn with_options(self, options: &SchemeOptions) -> Self {
        let eta = options.factor.unwrap_or(self.eta);
        Self { eta, lifts: options.lifts.unwrap_or(self.lifts) }
    }
    fn orders_of_degree(&self, degree: usize, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, degree), setting)
    }
}
