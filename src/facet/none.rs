//! No facet terms.

use super::{FacetForm, FacetView, FormTheory, Trace};
use crate::real::Real;

/// The form of schemes that have no terms on facets.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFacets;

impl<T: Real, const D: usize> FacetForm<T, D> for NoFacets {
    fn uses_flux(&self) -> bool {
        false
    }
    fn couples(&self) -> bool {
        false
    }
    fn penalty(&self, _: &FacetView<T, D>) -> T {
        T::lit(0.0)
    }
    fn theory(&self) -> FormTheory<'_, T, D> {
        FormTheory::new().with_coercivity(true)
    }
    #[inline(always)]
    fn integrand(&self, _: &FacetView<T, D>, _: Trace<T>, _: Trace<T>, _: T) -> T {
        T::lit(0.0)
    }
}
