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
    /// Cycles of monotone multigrid so far. They are no linear systems, whose number is limited.
    pub cycles: usize,
    /// The solver with factors; `None` before the first stage that needs it.
    pub direct: Option<DirectSolver<'a, T>>,
    /// The stages that ran.
    pub stages: Vec<StageRun>,
    /// How the last stage ended; `None` before the first one.
    pub end: Option<End>,
    /// Whether another run of the interior point method may find a better active set: before the first
    /// run, and after one that identified the active set before the limit of rounding.
    pub interior_point_may_improve: bool,
    /// Whether there may be slacks that only the second run of the interior point method resolves.
    pub has_small_slacks: bool,
    /// Where the first run of the interior point method ended, if the second one may go on from there.
    pub restart_point: Option<RestartPoint>,
}

/// What the last stage of a solve found, in addition to the iterate.
pub(super) struct Found {
    pub outcome: Outcome,
    /// See [`Solution::linear_solver`].
    pub linear_solver: &'static str,
    /// See [`Solution::algebraic_bound`].
    pub algebraic_bound: Option<f64>,
}

impl Found {
    /// An outcome of factors.
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

    /// The outcome where no stage found a solution.
    pub fn outcome_without_solution(&self) -> Outcome {
        match self.end {
            // there are no factors of a distributed matrix
            Some(End::Unsuitable) if self.inequality.distribution.is_some() => Outcome::Stalled,
            _ => Outcome::Cycling,
        }
    }

    /// The solution: the iterate if it converged, else the best one.
    pub(super) fn into_solution(mut self, found: Found) -> Solution<T> {
        let Found { mut outcome, linear_solver, algebraic_bound } = found;
        // a bound that is too large says more of distributed values than their certificate
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
