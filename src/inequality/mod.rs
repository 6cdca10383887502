//! Solvers of the algebraic inequality, and the certificate of what they return.

mod active_set;
mod algebraic_bound;
mod certificate;
mod initial_guess;
mod interior_point;
mod monotone_multigrid;
mod outcome;
mod projected_newton;
mod solution;

pub use active_set::{ActiveSet, LastResort};
pub use certificate::{Certificate, active, certify, certify_with_jump_multipliers};
pub use initial_guess::InitialGuess;
pub use monotone_multigrid::MonotoneMultigrid;
pub use outcome::Outcome;
pub use solution::Solution;

use crate::algebra::Inequality;
use crate::real::Real;

/// A solver of the algebraic inequality.
pub trait InequalitySolver<T: Real>: Sync {
    /// The name users type and reports state.
    fn name(&self) -> &'static str;
    /// Solves; never fails silently: see [`Outcome`].
    fn solve(&self, inequality: &Inequality<T>) -> Solution<T>;
    /// The same with knowledge of what is nearby; a solver that has no use for it ignores it.
    fn solve_from(&self, inequality: &Inequality<T>, nearby: &InitialGuess<T>) -> Solution<T> {
        let _ = nearby;
        self.solve(inequality)
    }
    /// Whether it has use for nested meshes where no bound asks for a start from them, for a system
    /// of this many unknowns.
    fn uses_coarse_spaces(&self, unknowns: usize) -> bool {
        let _ = unknowns;
        false
    }
}
