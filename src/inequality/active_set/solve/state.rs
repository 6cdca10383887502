//! The state of a solve between two stages.

use crate::algebra::Inequality;
use crate::inequality::active_set::direct_solver::DirectSolver;
use crate::inequality::active_set::iterate::Iterate;
use crate::inequality::active_set::iteration::{End, outcome_of_best};
use crate::inequality::active_set::settings::ActiveSet;
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::interior_point::RestartPoint;
use crate::inequality::{Outcome, Solution, Stage, StageRun};
use crate::linear::PreconditionerFamily;
use crate::real::Real;

/// A solve by stages.
pub(in crate::inequality::active_set) struct Solve<'s, 'a, T: Real> {
    pub settings: &'s ActiveSet,
    pub inequality: &'a Inequality<T>,
    pub guess: &'s InitialGuess<T>,
    pub family: &'s dyn PreconditionerFamily<T>,
    pub iterate: Iterate<'a, T>,
    /// Cycles of monotone multigrid so far. They do not count towards [`ActiveSet::max_outer`].
    pub cycles: usize,
    /// The solver with factors; `None` before the first stage that needs it.
    pub direct: Option<DirectSolver<'a, T>>,
    /// The stages that ran.
    pub stages: Vec<StageRun>,
    /// How the last active set iteration ended that did not end the solve; `None` before it.
    pub end: Option<End>,
    /// Whether another run of the interior point method may find a better active set: true before the first run, then
    /// [`InteriorPoint::may_improve`](crate::inequality::interior_point::InteriorPoint::may_improve) of the last one.
    pub interior_point_may_improve: bool,
    /// Whether there may be slacks that only the second run of the interior point method resolves.
    pub has_small_slacks: bool,
    /// The point at which the first run of the interior point method ended, if the second run may start from it.
    pub restart_point: Option<RestartPoint>,
}

/// The result of the stage that ends a solve, in addition to the iterate.
pub(super) struct StageResult {
    pub outcome: Outcome,
    /// See [`Solution::linear_solver`].
    pub linear_solver: &'static str,
    /// See [`Solution::algebraic_bound`].
    pub algebraic_bound: Option<f64>,
}

impl StageResult {
    /// An outcome of a stage with factors, without an algebraic bound.
    pub fn new(outcome: Outcome) -> Self {
        Self { outcome, linear_solver: "direct", algebraic_bound: None }
    }
}

impl<'s, 'a, T: Real> Solve<'s, 'a, T> {
    /// The state before the first stage, with the admissible values nearest to `values`.
    pub fn new(
        settings: &'s ActiveSet,
        inequality: &'a Inequality<T>,
        guess: &'s InitialGuess<T>,
        family: &'s dyn PreconditionerFamily<T>,
        values: &[T],
    ) -> Self {
        Self {
            settings,
            inequality,
            guess,
            family,
            iterate: Iterate::new(inequality, values),
            cycles: 0,
            direct: None,
            stages: Vec::new(),
            end: None,
            interior_point_may_improve: true,
            has_small_slacks: false,
            restart_point: None,
        }
    }

    /// The number of finished runs of a stage.
    pub fn runs_of(&self, stage: Stage) -> usize {
        self.stages.iter().filter(|run| run.stage == stage).count()
    }

    /// The outcome if no stage ended the solve.
    pub fn outcome_without_solution(&self) -> Outcome {
        match self.end {
            // there are no factors of a distributed matrix
            Some(End::Unsuitable) if self.inequality.distribution.is_some() => Outcome::Stalled,
            _ => Outcome::Cycling,
        }
    }

    /// The solution: the iterate if it converged, else the best one.
    pub(super) fn into_solution(mut self, result: StageResult) -> Solution<T> {
        let StageResult { mut outcome, linear_solver, algebraic_bound } = result;
        // distributed values whose bound on the error is too large are no solution, however small their certificate
        if self.inequality.distribution.is_none() || self.end != Some(End::Unsuitable) {
            outcome = outcome_of_best(&mut self.iterate, self.settings.rounding_band, outcome);
        }
        let (outer, linear) = (self.iterate.outer + self.cycles, self.iterate.linear);
        self.iterate
            .into_solution(outcome)
            .iterations(outer, linear)
            .linear_solver(linear_solver)
            .algebraic_bound(algebraic_bound)
            .stages(self.stages)
    }
}
