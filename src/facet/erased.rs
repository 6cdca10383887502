//! A facet form without its type, for all that does not run once a cell.

use super::{FacetForm, FacetView, Trace};
use crate::real::Real;

/// The object-safe face of [`FacetForm`].
pub(crate) trait AnyForm<T: Real, const D: usize>: Send + Sync {
    fn uses_flux(&self) -> bool;
    fn is_lifted(&self) -> bool;
    fn moments(&self, degree: usize) -> usize;
    fn share(&self, facet: &FacetView<T, D>) -> T;
    fn penalty(&self, facet: &FacetView<T, D>) -> T;
    fn moment_weight(&self, degree: usize) -> T;
    fn least_penalty(&self, facet: &FacetView<T, D>) -> Option<T>;
    fn integrand(&self, v: Trace<T>, u: Trace<T>, penalty: T) -> T;
}

impl<T: Real, const D: usize, F: FacetForm<T, D>> AnyForm<T, D> for F {
    fn uses_flux(&self) -> bool {
        F::USES_FLUX
    }
    fn is_lifted(&self) -> bool {
        F::LIFTED
    }
    fn moments(&self, degree: usize) -> usize {
        F::moments(degree)
    }
    fn share(&self, facet: &FacetView<T, D>) -> T {
        FacetForm::share(self, facet)
    }
    fn penalty(&self, facet: &FacetView<T, D>) -> T {
        FacetForm::penalty(self, facet)
    }
    fn moment_weight(&self, degree: usize) -> T {
        T::lit(FacetForm::moment_weight(self, degree))
    }
    fn least_penalty(&self, facet: &FacetView<T, D>) -> Option<T> {
        FacetForm::least_penalty(self, facet)
    }
    fn integrand(&self, v: Trace<T>, u: Trace<T>, penalty: T) -> T {
        FacetForm::integrand(self, v, u, penalty)
    }
}
