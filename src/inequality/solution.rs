//! The result of a solver.

use super::Outcome;
use crate::algebra::Contact;

/// The result of a solver of an inequality.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solution<T> {
    /// The unknowns: the solution if converged, else the best iterate.
    pub values: Vec<T>,
    /// The active bound of each unknown.
    pub contact: Vec<Contact>,
    /// How the solve ended.
    pub outcome: Outcome,
    /// Number of outer iterations: linear systems with a new active set, or cycles.
    pub outer: usize,
    /// Number of iterations of the linear solver, zero for a direct one.
    pub linear: usize,
    /// The linear solver: `direct`, or the name of a preconditioner.
    pub linear_solver: &'static str,
    /// Bound on the energy norm of the error over that of the solution, where the solver computes one.
    pub algebraic_bound: Option<f64>,
    /// The jump multipliers `p = S (M u - g)` where the matrix is a
    /// [`PenalisedMatrix`](crate::algebra::PenalisedMatrix) and the solver determines them more exactly
    /// than the values do; else empty.
    pub jump_multipliers: Vec<T>,
}

impl<T> Solution<T> {
    /// A result without iterations, by a direct linear solver.
    #[must_use]
    pub fn new(values: Vec<T>, contact: Vec<Contact>, outcome: Outcome) -> Self {
        Self {
            values,
            contact,
            outcome,
            outer: 0,
            linear: 0,
            linear_solver: "direct",
            algebraic_bound: None,
            jump_multipliers: Vec::new(),
        }
    }
    /// Sets the numbers of outer iterations and of iterations of the linear solver.
    #[must_use]
    pub fn iterations(mut self, outer: usize, linear: usize) -> Self {
        (self.outer, self.linear) = (outer, linear);
        self
    }
    /// Sets the name of the linear solver.
    #[must_use]
    pub fn linear_solver(mut self, name: &'static str) -> Self {
        self.linear_solver = name;
        self
    }
    /// Sets the relative bound on the energy norm of the error.
    #[must_use]
    pub fn algebraic_bound(mut self, bound: Option<f64>) -> Self {
        self.algebraic_bound = bound;
        self
    }
    /// Sets the jump multipliers.
    #[must_use]
    pub fn jump_multipliers(mut self, jump_multipliers: Vec<T>) -> Self {
        self.jump_multipliers = jump_multipliers;
        self
    }
}
