//! What is known of the solution of a problem.

use std::fmt;
use std::sync::Arc;

use super::datum::{Datum, Field, VectorField};
use crate::real::Point;

/// The exact solution, for error norms, and for Dirichlet and Neumann data where the problem has
/// none.
#[derive(Clone)]
#[non_exhaustive]
pub struct Exact<const D: usize> {
    /// The solution.
    pub value: Datum<D>,
    /// The gradient of the solution.
    pub gradient: VectorField<D>,
    /// Density of the multiplier: with obstacles `lambda = -div(alpha grad u) + c u - f` per unit
    /// volume, negative where the upper obstacle is active; with the Signorini condition
    /// `sigma = alpha du/dn` per unit area of the contact boundary, undefined elsewhere. None where the
    /// multiplier is a measure without density, or unknown.
    pub multiplier: Option<Field<D>>,
    /// The contact set; none where data and solution do not determine it.
    pub contact: Option<ContactSet<D>>,
}

/// The set where the exact solution equals a bound: with obstacles a subset of the domain, with the
/// Signorini condition a subset of the contact boundary.
#[derive(Clone)]
#[non_exhaustive]
pub struct ContactSet<const D: usize> {
    /// Positive inside the contact set, negative outside, zero on its free boundary.
    pub indicator: Field<D>,
    /// Points of the free boundary: all of them in one dimension and for a Signorini condition in
    /// two, otherwise a sample whose distances are far below mesh sizes. Empty where the free
    /// boundary is empty.
    pub free_boundary: Vec<Point<D>>,
}

impl<const D: usize> Exact<D> {
    /// A solution and its gradient, without multiplier and contact set.
    pub fn new(
        value: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
        gradient: impl Fn(&Point<D>) -> Point<D> + Send + Sync + 'static,
    ) -> Self {
        Self {
            value: Datum::Function(Arc::new(value)),
            gradient: Arc::new(gradient),
            multiplier: None,
            contact: None,
        }
    }
    /// Sets the density of the multiplier.
    #[must_use]
    pub fn with_multiplier(
        mut self,
        lambda: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.multiplier = Some(Arc::new(lambda));
        self
    }
    /// Sets the contact set: a function positive inside and negative outside, and points of the
    /// free boundary.
    #[must_use]
    pub fn with_contact(
        mut self,
        indicator: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
        free_boundary: Vec<Point<D>>,
    ) -> Self {
        self.contact = Some(ContactSet { indicator: Arc::new(indicator), free_boundary });
        self
    }
}

impl<const D: usize> fmt::Debug for Exact<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Exact")
            .field("multiplier", &self.multiplier.is_some())
            .field("contact", &self.contact)
            .finish_non_exhaustive()
    }
}

impl<const D: usize> fmt::Debug for ContactSet<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ContactSet")
            .field("free_boundary_points", &self.free_boundary.len())
            .finish_non_exhaustive()
    }
}

/// The minimum of the energy `J(v) = a(v, v)/2 - l(v)` of a problem without a known solution.
///
/// The energies of the catalogue were extrapolated from conforming linear elements on uniform meshes
/// with up to 256 (or 512) subdivisions, by an independent program.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReferenceEnergy {
    /// The energy.
    pub value: f64,
    /// Bound on the error of the energy.
    pub uncertainty: f64,
}
