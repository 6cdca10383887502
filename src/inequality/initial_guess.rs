//! The data from which a solver of an inequality starts.

use super::history::StepCounter;
use crate::algebra::rounded;
use crate::linear::CoarseSpaces;
use crate::real::Real;

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
