//! Methods with a penalty by the lifts of single facets: of Bassi and Rebay, and of Brezzi and others.

use super::{
    BrokenScheme, ExpectedOrders, SchemeOptions, Setting, broken_energy_order, with_duality,
};
use crate::element::Element;
use crate::facet::{FacetForm, FacetLifts, Lifts};
use crate::mesh::Mesh;

/// Penalty by the lifts of single facets, on broken elements, by default of degree `k - 1` on elements of degree `k`:
/// written once for [`Br2`] and [`Bmmpr`], which adds the product of all lifts.
///
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiftingMethod<const WITH_ALL_LIFTS: bool> {
    /// The factor of the penalty: of [`Br2`] over the number of facets of a cell, by default 3/2, of [`Bmmpr`] as it
    /// stands, by default one.
    pub factor: f64,
    /// The degree of the lifts.
    pub lifts: Lifts,
}

/// The second method of Bassi and Rebay: coercive for factors above one.
///
/// Source: F. Bassi, S. Rebay, G. Mariotti, S. Pedinotti, M. Savini, 2nd European Conference on
/// Turbomachinery (1997), 99-108.
pub type Br2 = LiftingMethod<false>;

/// The method of Brezzi, Manzini, Marini, Pietra and Russo, `int alpha (grad u + r(u)) . (grad v + r(v))` with the
/// penalty: coercive for every positive factor.
///
/// Source: F. Brezzi, G. Manzini, L. D. Marini, P. Pietra, A. Russo, Numer. Methods Partial
/// Differential Equations 16 (2000), 365-378.
pub type Bmmpr = LiftingMethod<true>;

impl<const WITH_ALL_LIFTS: bool> Default for LiftingMethod<WITH_ALL_LIFTS> {
    fn default() -> Self {
        Self { factor: if WITH_ALL_LIFTS { 1.0 } else { 1.5 }, lifts: Lifts::Reduced }
    }
}

impl<const WITH_ALL_LIFTS: bool> BrokenScheme for LiftingMethod<WITH_ALL_LIFTS> {
    fn name_on_linears(&self) -> &str {
        if WITH_ALL_LIFTS { "bmmpr" } else { "br2" }
    }
    fn form_on<const D: usize>(&self, on: &dyn Element<D>, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let lift_degree = self.lifts.degree(on.basis_degree());
        let eta = if WITH_ALL_LIFTS { self.factor } else { self.factor * (D + 1) as f64 };
        Box::new(FacetLifts { eta, lift_degree, with_all_lifts: WITH_ALL_LIFTS })
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
