//! Local discontinuous Galerkin fluxes.

use super::{FacetForm, FacetView, FormTheory, Lifts, PenaltyParameters, Trace};

/// `int alpha (grad u + r(u)) . (grad v + r(v)) + eta alpha_F / h_F [u][v]`: coercive for every positive
/// factor.
///
/// Source: B. Cockburn, C.-W. Shu, SIAM J. Numer. Anal. 35 (1998), 2440-2463; without auxiliary
/// variables D. N. Arnold, F. Brezzi, B. Cockburn, L. D. Marini, SIAM J. Numer. Anal. 39 (2002),
/// 1749-1779.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalFluxes {
    /// The factor of the penalty.
    pub eta: f64,
    /// The switch `beta`: off for the mean flux, on for the flux of one side, the side from which a
    /// fixed direction points to the other.
    pub switch: bool,
    /// The degree of the lifts.
    pub lifts: Lifts,
}

impl Default for LocalFluxes {
    fn default() -> Self {
        Self { eta: 1.0, switch: false, lifts: Lifts::Reduced }
    }
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
        let parameters = PenaltyParameters { sigma, eta: None, rule };
        FormTheory { parameters, ..FormTheory::default() }.with_coercivity(self.eta > 0.0)
    }
    fn is_uniform(&self) -> bool {
        true
    }
    #[inline(always)]
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump - u.flux * v.jump - v.flux * u.jump
    }
}
