//! Solvers of the algebraic variational inequality, and the certificate of their results.
//!
//! Find `u` within the bounds with `(A u - b) . (v - u) >= 0` for all `v` within the bounds ([`Inequality`]). A solver
//! takes it with an [`InitialGuess`] and returns a [`Solution`], whose [`Outcome`] states whether the solver converged.
//! The [`Certificate`] measures the violations of any `u`, whichever solver computed it.
//!
//! Words: a *fixed* unknown has a Dirichlet value (or two bounds that coincide); an *active* one
//! has the value of a bound; an *inactive* one is solved for; a *free* one is not fixed. The
//! *residual* is `b - A u`; the *multiplier* of an active unknown is the entry of `A u - b`,
//! negated at an upper bound, and has the right sign if it is not negative. *Jump multipliers* are
//! the unknowns `p = S (M u - g)` of a [`PenalisedMatrix`](crate::algebra::PenalisedMatrix).
//!
//! | file | content |
//! |---|---|
//! | `validation` | checks of the input and of definiteness |
//! | `active_set/` | [`ActiveSet`]: the primal-dual active set method, with the order of all methods in `active_set/ladder` |
//! | `interior_point/` | [`InteriorPoint`]: Mehrotra's method, which provides a start where the active set stagnates |
//! | `monotone_multigrid/` | [`MonotoneMultigrid`]: truncated nonsmooth Newton multigrid |
//! | `proximal_point/` | [`ProximalPoint`]: proximal Galerkin with one Newton system a step, for comparison |
//! | `certificate/` | [`Certificate`], [`certify`]; the scales of violations |
//! | `contact_forces` | the forces of active bounds, from which everything that shows a force takes them |
//! | `algebraic_bound` | a bound on the algebraic error of admissible values |
//! | `pieces` | inequalities with kinks, solved on one side of each at a time |
//! | `recession` | whether a solution exists and is unique where only bounds hold a body |
//! | `initial_guess` | [`InitialGuess`]: coarse spaces, starting values and tolerance of a solve |
//! | `single_precision` | [`SinglePrecision`]: a solver in `f32` for inequalities in `f64` |
//! | `history` | [`HistoryPoint`], [`StepCounter`]: the certificate after each outer step, the number of the present one |
//! | `by_name` | [`solver_by_name`] |
//! | `solution`, `outcome`, `stage` | [`Solution`], [`Outcome`], [`Stage`], [`StageRun`]: the result of a solver |
//!
//! Every solver first asks `recession` whether bounds alone hold a body: then the load decides whether a solution exists,
//! bounds that it does not press are left out at first, and the solver may run again. [`ActiveSet`] runs other methods
//! where its active set stagnates: `active_set/ladder` is that order; [`Solution::stages`] contains the methods that ran.
//! The certificate decides [`Outcome::Converged`] or [`Outcome::Stalled`] when the active set is final.

mod active_set;
mod algebraic_bound;
mod by_name;
mod certificate;
mod contact_forces;
mod history;
mod initial_guess;
mod interior_point;
mod monotone_multigrid;
mod outcome;
mod pieces;
mod proximal_point;
mod recession;
mod single_precision;
mod solution;
mod stage;
mod validation;

pub use active_set::{ActiveSet, Preconditioned};
pub use by_name::{SOLVERS, solver_by_name};
pub(crate) use certificate::count_active;
pub use certificate::{Certificate, certify, contact_of};
pub(crate) use certificate::{certify_solution, positive_diagonal, residual, stiffness_diagonal};
pub(crate) use contact_forces::ContactForces;
pub use history::{HistoryPoint, StepCounter};
pub use initial_guess::InitialGuess;
pub use interior_point::InteriorPoint;
pub use monotone_multigrid::MonotoneMultigrid;
pub use outcome::Outcome;
pub use proximal_point::ProximalPoint;
pub(crate) use recession::explanation;
pub use single_precision::{SinglePrecision, in_precision};
pub use solution::Solution;
pub use stage::{Stage, StageRun};

use crate::algebra::Inequality;
use crate::real::{Precision, Real};

/// A solver of the algebraic variational inequality.
pub trait InequalitySolver<T: Real>: Sync {
    /// The name in reports and options; the solvers of a study must have different ones.
    fn name(&self) -> &'static str;
    /// The precision in which the solver computes, whatever the scalar of the inequality.
    fn precision(&self) -> Precision {
        T::PRECISION
    }
    /// Solves the inequality; a failure is an [`Outcome`].
    fn solve(&self, inequality: &Inequality<T>) -> Solution<T>;
    /// Solves the inequality with coarse spaces, starting values and a tolerance. The default ignores
    /// them.
    fn solve_from(&self, inequality: &Inequality<T>, guess: &InitialGuess<T>) -> Solution<T> {
        let _ = guess;
        self.solve(inequality)
    }
    /// Whether the solver uses the coarse spaces of nested meshes for this number of unknowns, so that
    /// they are computed even if no bound requires a starting active set.
    fn uses_coarse_spaces(&self, unknowns: usize) -> bool {
        let _ = unknowns;
        false
    }
}
