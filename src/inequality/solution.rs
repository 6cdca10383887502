//! What a solver returns.

use super::Outcome;
use crate::algebra::Contact;

/// What a solver returns.
#[derive(Clone, Debug)]
pub struct Solution<T> {
    /// The unknowns: the solution, or the best iterate.
    pub values: Vec<T>,
    /// Which bound each unknown rests on.
    pub contact: Vec<Contact>,
    /// How it ended.
    pub outcome: Outcome,
    /// Outer iterations: active sets tried.
    pub outer: usize,
    /// Inner iterations of linear solvers, zero for direct ones.
    pub linear: usize,
    /// The linear solver used: `direct`, or the name of a preconditioner.
    pub linear_solver: &'static str,
    /// Bound on the energy norm of the error over that of the solution, where the solver knows one.
    pub algebraic_bound: Option<f64>,
    /// The jump multipliers of a [`PenalisedMatrix`](crate::algebra::PenalisedMatrix), if the solver has
    /// them as unknowns; else empty.
    pub jump_multipliers: Vec<T>,
}
