//! The methods whose penalty is made of lifts of jumps.

use std::sync::Arc;

use super::{
    ExpectedOrders, Scheme, SchemeOptions, Setting, broken_energy_order, name_of_degree,
    with_duality,
};
use crate::element::{Broken, Element, P1};
use crate::facet::{FacetForm, FacetLifts, Lifts};
use crate::mesh::Mesh;

/// The second method of Bassi and Rebay: penalty by the lifts of single facets, on broken elements, by
/// default of degree `k - 1` on elements of degree `k`.
///
/// Source: F. Bassi, S. Rebay, G. Mariotti, S. Pedinotti, M. Savini, 2nd European Conference on
/// Turbomachinery (1997), 99-108.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Debug)]
pub struct Br2<const D: usize> {
    /// The factor of the penalty; where absent three halves of the number of facets of a cell,
    /// above which the form is coercive.
    pub eta: Option<f64>,
    /// The degree of the lifts.
    pub lifts: Lifts,
    /// The element, which is broken.
    pub element: Arc<dyn Element<D>>,
}

impl<const D: usize> Default for Br2<D> {
    fn default() -> Self {
        Self { eta: None, lifts: Lifts::Reduced, element: Arc::new(Broken(P1)) }
    }
}

/// The factor of the penalty over the number of facets of a cell.
const MARGIN: f64 = 1.5;

impl<const D: usize> Br2<D> {
    /// The scheme by name: with what the options give.
    pub(super) fn with_options(options: &SchemeOptions) -> Self {
        let eta = options.factor.map(|factor| factor * (D + 1) as f64);
        Self { eta, lifts: options.lifts.unwrap_or_default(), ..Self::default() }
    }
    /// The scheme on the broken version of another element: `Br2::default().on(P2)`.
    #[must_use]
    pub fn on(self, element: impl Element<D> + 'static) -> Self {
        Self { element: Arc::new(Broken(element)), ..self }
    }
}

impl<const D: usize> Scheme<D> for Br2<D> {
    fn name(&self) -> &str {
        name_of_degree!("br2", self.element.degree())
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        self.element.clone()
    }
    fn choices(&self) -> SchemeOptions {
        let factor = self.eta.map(|eta| eta / (D + 1) as f64).filter(|&factor| factor != MARGIN);
        SchemeOptions { factor, lifts: self.lifts.unless_default(), ..SchemeOptions::default() }
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let eta = self.eta.unwrap_or(MARGIN * (D + 1) as f64);
        let lift_degree = self.lifts.degree(self.element.basis_degree());
        Box::new(FacetLifts { eta, lift_degree, with_all_lifts: false })
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, self.element.degree()), setting)
    }
}

/// The method of Brezzi, Manzini, Marini, Pietra and Russo: `int alpha (grad u + r(u)) . (grad v +
/// r(v))` with a penalty by the lifts of single facets, on broken elements, by default of degree `k - 1`
/// on elements of degree `k`. The form is coercive for every positive factor.
///
/// Source: F. Brezzi, G. Manzini, L. D. Marini, P. Pietra, A. Russo, Numer. Methods Partial
/// Differential Equations 16 (2000), 365-378.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Debug)]
pub struct Bmmpr<const D: usize> {
    /// The factor of the penalty; by default one.
    pub eta: f64,
    /// The degree of the lifts.
    pub lifts: Lifts,
    /// The element, which is broken.
    pub element: Arc<dyn Element<D>>,
}

impl<const D: usize> Default for Bmmpr<D> {
    fn default() -> Self {
        Self { eta: 1.0, lifts: Lifts::Reduced, element: Arc::new(Broken(P1)) }
    }
}

impl<const D: usize> Bmmpr<D> {
    /// The scheme by name: with what the options give.
    pub(super) fn with_options(options: &SchemeOptions) -> Self {
        let default = Self::default();
        let eta = options.factor.unwrap_or(default.eta);
        Self { eta, lifts: options.lifts.unwrap_or_default(), ..default }
    }
    /// The scheme on the broken version of another element: `Bmmpr::default().on(P2)`.
    #[must_use]
    pub fn on(self, element: impl Element<D> + 'static) -> Self {
        Self { element: Arc::new(Broken(element)), ..self }
    }
}

impl<const D: usize> Scheme<D> for Bmmpr<D> {
    fn name(&self) -> &str {
        name_of_degree!("bmmpr", self.element.degree())
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        self.element.clone()
    }
    fn choices(&self) -> SchemeOptions {
        let factor = Some(self.eta).filter(|&eta| eta != Self::default().eta);
        SchemeOptions { factor, lifts: self.lifts.unless_default(), ..SchemeOptions::default() }
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let lift_degree = self.lifts.degree(self.element.basis_degree());
        Box::new(FacetLifts { eta: self.eta, lift_degree, with_all_lifts: true })
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, self.element.degree()), setting)
    }
}
