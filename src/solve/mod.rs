//! Solvers of the algebraic inequality, and the certificate of what they return.

mod active_set;
mod aggregation;
mod auxiliary_space;
mod certificate;
mod condensed;
mod conjugate_gradients;
mod cycles;
mod dense;
mod descent;
mod elimination;
mod error_bound;
mod facet_pairs;
mod facet_split;
mod gmres;
mod hierarchy;
mod hybrid;
mod inexact;
mod interior;
mod iterate;
mod kernels;
mod krylov;
mod linear;
mod look;
mod mean_jump;
mod monotone_multigrid;
mod multigrid;
mod nearby;
mod nested_dissection;
mod pieces;
mod preconditioners;
mod restrict;
mod search;
mod shifted;
mod small;
mod sweeps;
mod transfer;
mod walls;

pub use active_set::{ActiveSet, LastResort};
pub use certificate::{Certificate, active, certify, certify_with_forces};
pub use elimination::EliminationOrder;
pub use hierarchy::{Coarser, VertexLevel};
pub use kernels::SparseKernels;
pub use linear::{FactorError, Factors, is_positive_definite};
pub use mean_jump::MeanJump;
pub use monotone_multigrid::MonotoneMultigrid;
pub use nearby::{Functions, Linear, Nearby};
pub use transfer::Transfer;

use crate::algebra::{Contact, Inequality};
use crate::real::Real;

/// How a solve ended. Only [`Outcome::Converged`] is a success; every other outcome comes with the
/// best iterate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Outcome {
    /// The complementarity conditions hold to the tolerance.
    Converged,
    /// The iteration limit was reached while the active set still moved.
    IterationLimit,
    /// The active set returned to an earlier one and could not be resolved.
    Cycling,
    /// Steps no longer change the iterate, yet the conditions do not hold.
    Stalled,
    /// The matrix is not positive definite on the free unknowns (penalty too small).
    NotCoercive,
    /// The matrix is singular on the free unknowns.
    Singular,
    /// A number that is not finite appeared.
    NotFinite,
    /// Two bounds of one unknown leave no value between them.
    Infeasible,
    /// Sizes of matrix, load and bounds do not match, or the matrix is not what its type promises.
    Malformed,
    /// The factors do not fit into memory.
    OutOfMemory,
}

impl Outcome {
    /// The name in reports, in kebab-case.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Converged => "converged",
            Outcome::IterationLimit => "iteration-limit",
            Outcome::Cycling => "cycling",
            Outcome::Stalled => "stalled",
            Outcome::NotCoercive => "not-coercive",
            Outcome::Singular => "singular",
            Outcome::NotFinite => "not-finite",
            Outcome::Infeasible => "infeasible",
            Outcome::Malformed => "malformed",
            Outcome::OutOfMemory => "out-of-memory",
        }
    }
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

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
    /// The forces of jumps where the matrix is kept [`Factored`](crate::algebra::Factored) and the
    /// solver knows them better than the values tell; else empty.
    pub forces: Vec<T>,
}

/// A solver of the algebraic inequality.
pub trait InequalitySolver<T: Real>: Sync {
    /// The name users type and reports state.
    fn name(&self) -> &'static str;
    /// Solves; never fails silently: see [`Outcome`].
    fn solve(&self, inequality: &Inequality<T>) -> Solution<T>;
    /// The same with knowledge of what is nearby; a solver that has no use for it ignores it.
    fn solve_near(&self, inequality: &Inequality<T>, nearby: &Nearby<T>) -> Solution<T> {
        let _ = nearby;
        self.solve(inequality)
    }
    /// Whether it has use for nested meshes where no bound asks for a start from them, for a system
    /// of this many unknowns.
    fn uses_nearby(&self, unknowns: usize) -> bool {
        let _ = unknowns;
        false
    }
}
