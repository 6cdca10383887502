//! The second method of Bassi and Rebay.

use super::{
    BrokenScheme, ExpectedOrders, SchemeOptions, Setting, broken_energy_order, with_duality,
};
use crate::element::Element;
use crate::facet::{FacetForm, FacetLifts, Lifts};
use crate::mesh::Mesh;

/// Penalty by the lifts of single facets, on broken elements, by default of degree `k - 1` on elements of degree `k`.
///
/// Source: F. Bassi, S. Rebay, G. Mariotti, S. Pedinotti, M. Savini, 2nd European Conference on
/// Turbomachinery (1997), 99-108.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Br2 {
    /// The factor of the penalty over the number of facets of a cell: the form is coercive above one; by default 3/2.
    pub factor: f64,
    /// The degree of the lifts.
    pub lifts: Lifts,
}

impl Default for Br2 {
    fn default() -> Self {
        Self { factor: 1.5, lifts: Lifts::Reduced }
    }
}

impl BrokenScheme for Br2 {
    fn name_on_linears(&self) -> &str {
        "br2"
    }
    fn form_on<const D: usize>(&self, on: &dyn Element<D>, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let lift_degree = self.lifts.degree(on.basis_degree());
        let eta = self.factor * (D + 1) as f64;
        Box::new(FacetLifts { eta, lift_degree, with_all_lifts: false })
    }
    fn options(&self) -> SchemeOptions {
        SchemeOptions { factor: Some(self.factor), lifts: Some(self.lifts), ..Default::default() }
    }
    fn with_options(self, options: &SchemeOptions) -> Self {
        let factor = options.factor.unwrap_or(self.factor);
        Self { factor, lifts: options.lifts.unwrap_or(self.lifts) }
    }
    fn orders_of_degree(&self, degree: usize, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, degree), setting)
    }
}
