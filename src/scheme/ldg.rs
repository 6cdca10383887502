//! The local discontinuous Galerkin method.

use std::sync::Arc;

use super::{
    ExpectedOrders, Scheme, SchemeOptions, Setting, broken_energy_order, name_of_degree,
    with_duality,
};
use crate::element::{Broken, Element, P1};
use crate::facet::{FacetForm, FacetView, FormTheory, Lifts, PenaltyParameters, Trace};
use crate::mesh::Mesh;

/// `int alpha (grad u + r(u)) . (grad v + r(v)) + eta alpha_F / h_F [u][v]` on broken elements:
/// coercive for every positive factor. The lifts are by default of degree `k - 1` on elements of degree
/// `k`.
///
/// Source: B. Cockburn, C.-W. Shu, SIAM J. Numer. Anal. 35 (1998), 2440-2463; without auxiliary
/// variables D. N. Arnold, F. Brezzi, B. Cockburn, L. D. Marini, SIAM J. Numer. Anal. 39 (2002),
/// 1749-1779.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Debug)]
pub struct Ldg<const D: usize> {
    /// The factor of the penalty; by default one.
    pub eta: f64,
    /// The switch `beta`: off for the mean flux, on for the flux of one side, the side from which a
    /// fixed direction points to the other.
    pub switch: bool,
    /// The degree of the lifts.
    pub lifts: Lifts,
    /// The element, which is broken.
    pub element: Arc<dyn Element<D>>,
}

impl<const D: usize> Default for Ldg<D> {
    fn default() -> Self {
        Self { eta: 1.0, switch: false, lifts: Lifts::Reduced, element: Arc::new(Broken(P1)) }
    }
}

impl<const D: usize> Ldg<D> {
    /// The scheme by name: with the penalty factor that the options give.
    pub(super) fn with_options(options: &SchemeOptions, switch: bool) -> Self {
        let default = Self::default();
        let lifts = options.lifts.unwrap_or_default();
        Self { eta: options.sigma.unwrap_or(default.eta), switch, lifts, ..default }
    }
    /// The scheme on the broken version of another element: `Ldg::default().on(P2)`.
    #[must_use]
    pub fn on(self, element: impl Element<D> + 'static) -> Self {
        Self { element: Arc::new(Broken(element)), ..self }
    }
}

impl<const D: usize> Scheme<D> for Ldg<D> {
    fn name(&self) -> &str {
        match self.switch {
            false => name_of_degree!("ldg", self.element.degree()),
            true => name_of_degree!("ldg-switch", self.element.degree()),
        }
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        self.element.clone()
    }
    fn choices(&self) -> SchemeOptions {
        let sigma = Some(self.eta).filter(|&eta| eta != Self::default().eta);
        SchemeOptions { sigma, lifts: self.lifts.unless_default(), ..SchemeOptions::default() }
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(LocalFluxes { eta: self.eta, switch: self.switch, lifts: self.lifts })
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, self.element.degree()), setting)
    }
}

/// The facet terms of the method.
#[derive(Clone, Copy, Debug)]
pub struct LocalFluxes {
    eta: f64,
    switch: bool,
    lifts: Lifts,
}

/// The direction of the switch: across no facet of a mesh along the axes or their diagonals.
const DIRECTION: [f64; 3] = [1.0, 0.377, 0.142];

impl<const D: usize> FacetForm<D> for LocalFluxes {
    fn is_lifted(&self) -> bool {
        true
    }
    fn lift_degree(&self, degree: usize) -> usize {
        self.lifts.degree(degree)
    }
    fn average_weight(&self, facet: &FacetView<D>) -> f64 {
        if !self.switch {
            return 0.5;
        }
        let normal = facet.normal();
        let along: f64 = normal.iter().zip(DIRECTION).map(|(n, d)| n * d).sum();
        if along > 0.0 { 1.0 } else { 0.0 }
    }
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        self.eta * facet.coefficient() / facet.diameter()
    }
    fn theory(&self) -> FormTheory<'_, D> {
        let beta = if self.switch { "one-sided flux" } else { "mean flux" };
        let rule = Some(format!("eta / h_F, {beta}"));
        let sigma = Some(self.eta);
        FormTheory::new()
            .with_parameters(PenaltyParameters { sigma, eta: None, rule })
            .with_coercivity(self.eta > 0.0)
    }
    fn is_uniform(&self) -> bool {
        true
    }
    #[inline(always)]
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump - u.flux * v.jump - v.flux * u.jump
    }
}
