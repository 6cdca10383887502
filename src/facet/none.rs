//! No facet terms.

use super::{FacetForm, FacetView, FormTheory, Trace};

/// The form of schemes that have no terms on facets.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFacets;

impl<const D: usize> FacetForm<D> for NoFacets {
    fn uses_flux(&self) -> bool {
        false
    }
    fn couples(&self) -> bool {
        false
    }
    fn penalty(&self, _: &FacetView<D>) -> f64 {
        0.0
    }
    fn theory(&self) -> FormTheory<'_, D> {
        FormTheory::default().with_coercivity(true)
    }
    #[inline(always)]
    fn integrand(&self, _: &FacetView<D>, _: Trace, _: Trace, _: f64) -> f64 {
        0.0
    }
}
