//! The data from which a solver of an inequality starts.

use super::step_counter::StepCounter;
use crate::algebra::{Contact, DofLocation, rounded};
use crate::linear::CoarseSpaces;
use crate::parallel::vectors::collect;
use crate::real::Real;

/// Relative tolerance in the energy norm for iterative solvers of P1 if the solution is only the initial guess of
/// another solve: below the discretisation error of all meshes that fit into memory.
pub(crate) const P1_ENERGY_TOLERANCE: f64 = 1e-4;

/// Coarse spaces, starting values and accuracy of a solve. The starting active set is part of the
/// inequality: [`Start`](crate::algebra::Start).
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct InitialGuess<T> {
    /// The conforming P1 functions on the mesh and on coarser meshes.
    pub coarse_spaces: CoarseSpaces<T>,
    /// The starting value of every unknown; `None`, or a list of another length, for zeros.
    pub values: Option<Vec<T>>,
    /// Tolerance on the relative error in the energy norm (energy norm of the error divided by the
    /// energy norm of the iterate); `None` for the limit of the certificate. Direct solvers ignore
    /// it.
    pub energy_tolerance: Option<f64>,
    /// The counter of outer steps, which the solver updates.
    pub steps: StepCounter,
    /// Whether the solution has a history ([`Solution::history`](super::Solution::history)), for which a certificate is
    /// computed after every outer step.
    pub keeps_history: bool,
}

impl<T> Default for InitialGuess<T> {
    fn default() -> Self {
        Self {
            coarse_spaces: CoarseSpaces::Unknown,
            values: None,
            energy_tolerance: None,
            steps: StepCounter::default(),
            keeps_history: false,
        }
    }
}

/// Setters, one for each field.
impl<T> InitialGuess<T> {
    /// Sets the conforming P1 functions on the mesh and on coarser meshes.
    #[must_use]
    pub fn coarse_spaces(mut self, coarse_spaces: CoarseSpaces<T>) -> Self {
        self.coarse_spaces = coarse_spaces;
        self
    }
    /// Sets the starting value of every unknown.
    #[must_use]
    pub fn values(mut self, values: Vec<T>) -> Self {
        self.values = Some(values);
        self
    }
    /// Sets the tolerance on the relative error in the energy norm.
    #[must_use]
    pub fn energy_tolerance(mut self, tolerance: f64) -> Self {
        self.energy_tolerance = Some(tolerance);
        self
    }
    /// Sets the counter of outer steps.
    #[must_use]
    pub fn steps(mut self, steps: StepCounter) -> Self {
        self.steps = steps;
        self
    }
    /// Sets whether the solution has a history.
    #[must_use]
    pub fn keeps_history(mut self, keeps_history: bool) -> Self {
        self.keeps_history = keeps_history;
        self
    }
}

impl InitialGuess<f64> {
    /// The guess with values and coarse spaces rounded once.
    pub(super) fn in_precision<T: Real>(&self) -> InitialGuess<T> {
        InitialGuess {
            coarse_spaces: self.coarse_spaces.in_precision(),
            values: self.values.as_deref().map(rounded),
            energy_tolerance: self.energy_tolerance,
            steps: self.steps.clone(),
            keeps_history: self.keeps_history,
        }
    }
}

/// The contact states of unknowns from those of vertices: a bound is active at an unknown if it is active at more than
/// half of the vertices of its location.
pub(crate) fn contact_of_locations(locations: &[DofLocation], contact: &[Contact]) -> Vec<Contact> {
    collect(locations.len(), |i| {
        let vertices = locations[i].vertices();
        let has_most = |side: &Contact| {
            let on = vertices.iter().filter(|&&v| contact[v as usize] == *side).count();
            2 * on > vertices.len()
        };
        [Contact::Lower, Contact::Upper].into_iter().find(has_most).unwrap_or_default()
    })
}

/// The mean of the vertex values over each location.
pub(crate) fn means_over_locations<T: Real>(locations: &[DofLocation], values: &[T]) -> Vec<T> {
    collect(locations.len(), |i| {
        let vertices = locations[i].vertices();
        let sum = vertices.iter().fold(T::lit(0.0), |s, &v| s + values[v as usize]);
        sum / T::lit(vertices.len().max(1) as f64)
    })
}
