//! An over-penalty without the coefficient, to show the effect of the harmonic mean.

use std::sync::Arc;

use crate::element::{Broken, Element, P1};
use crate::facet::{FacetForm, FacetView, Trace};
use crate::mesh::Mesh;
use crate::scheme::{Scheme, Wopsip};

/// WOPSIP with the penalty `eta / h_F^3` for every coefficient, for comparison with the default:
/// the scheme fails for coefficients that are not of size one.
pub(crate) struct UnweightedWopsip;

/// The form of [`UnweightedWopsip`].
struct UnweightedPenalty<const D: usize>(Box<dyn FacetForm<D>>);

impl<const D: usize> FacetForm<D> for UnweightedPenalty<D> {
    fn uses_flux(&self) -> bool {
        false
    }
    fn moments(&self, degree: usize) -> usize {
        self.0.moments(degree)
    }
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        self.0.penalty(facet) / facet.coefficient()
    }
    fn is_uniform(&self) -> bool {
        true
    }
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump
    }
}

impl<const D: usize> Scheme<D> for UnweightedWopsip {
    fn name(&self) -> &str {
        "wopsip"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(Broken(P1))
    }
    fn form(&self, mesh: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(UnweightedPenalty(Wopsip::default().form(mesh)))
    }
    fn is_consistent(&self) -> bool {
        false
    }
}
