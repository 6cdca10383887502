//! The active set iteration, for every linear solver.

use super::cell_inequality::changes_of_cells;
use super::evaluation::Evaluation;
use super::iterate::Iterate;
use super::linear_solver::{Accuracy, End, LinearSolver};
use super::local_inequality::solve_locally;
use super::progress::ProgressMonitor;
use super::settings::ActiveSet;
use crate::algebra::{Bound, any_part};
use crate::inequality::Outcome;
use crate::inequality::history::Recorder;
use crate::real::Real;

/// Number of steps, since the start or the last local inequality, after which few state changes call [`solve_locally`].
/// The last of them move along the free boundary from cell to cell (radial-3d, `wopsip`, 32).
const MANY_STEPS: usize = 8;

/// Largest number of state changes, divided by the number of unknowns, that counts as few.
const FEW_CHANGES_SHARE: f64 = 1.0 / 4000.0;

/// The active set iteration from the contact states of an iterate.
///
/// Each step solves the linear system of the present active set and predicts a new one ([`Iterate::evaluate`]). The
/// iteration converges if the active set predicts itself, or all violations are within the tolerance of the linear
/// solver, and if the certificate, which does not depend on contact states, is small.
pub(crate) struct Iteration<'s, 'i, 'a, T: Real> {
    pub settings: &'s ActiveSet,
    pub iterate: &'i mut Iterate<'a, T>,
    pub solver: &'i mut dyn LinearSolver<T>,
    /// Number of systems within which the number of state changes must halve; `None` for no limit.
    pub limit: Option<usize>,
    /// Number of inequalities near unknowns whose states change that may still be solved; see [`solve_locally`].
    pub local_solves: usize,
    /// Whether the certificate must be small. The residual of a solution that is only the initial guess of another
    /// solve need not be small.
    pub needs_certificate: bool,
    /// Counts steps and linear systems, and may keep a history.
    pub recorder: &'s Recorder<'s>,
}

impl<T: Real> Iteration<'_, '_, '_, T> {
    /// Iterates until the solution is found or the iteration does not progress.
    pub fn run(&mut self) -> End {
        match self.iterate_to_tolerance() {
            Ok(()) => End::Outcome(Outcome::Converged),
            Err(end) => end,
        }
    }

    /// Iterates from the present states until the active set predicts itself or all violations are within the tolerance
    /// of the linear solver, and the certificate is small.
    fn iterate_to_tolerance(&mut self) -> Result<(), End> {
        let tolerance = self.solver.tolerance();
        if tolerance > 0.0 {
            // the tolerance is relative to the energy norm
            self.iterate.compute_residual();
            self.iterate.evaluate(&*self.solver);
        }
        let inequality = self.iterate.inequality;
        let distribution = inequality.distribution();
        let has_bounds = inequality.bounds.iter().any(Bound::is_inequality);
        let is_linear = !any_part(distribution, has_bounds);
        let limit = self.limit;
        let new_progress = || ProgressMonitor::new(limit, is_linear, distribution);
        let mut progress = new_progress();
        let mut has_new_states = true;
        // the unknowns whose states have changed since the number of changes last halved
        let mut recently_changed: Vec<u32> = Vec::new();
        loop {
            self.solve_system(has_new_states, progress.accuracy())?;
            let evaluation = self.evaluate()?;
            let is_accurate = self.solver.is_accurate(evaluation.energy_norm);
            let changes = &evaluation.state_changes;
            has_new_states = evaluation.n_changes > 0;
            if is_accurate && (!has_new_states || evaluation.holds_to(tolerance)) {
                if !self.needs_certificate || self.has_small_certificate() {
                    return Ok(());
                }
                if self.determine_jump_multipliers()? {
                    if self.has_small_certificate() {
                        return Ok(());
                    }
                    self.iterate.jump_multipliers.clear();
                    self.iterate.residual_is_current = false;
                }
                // the residual that a Krylov method updates may be too small by rounding: it is computed anew
                if tolerance == 0.0 || !progress.may_solve_again() {
                    return Err(self.end_by_rounding());
                }
            }
            let progresses = progress.record_solution(changes, &self.iterate.states, is_accurate);
            if progress.has_halved() {
                recently_changed.clear();
            }
            recently_changed.extend(changes.iter().map(|change| change.0));
            let is_slow = progress.steps() > MANY_STEPS
                && changes.len() as f64 <= FEW_CHANGES_SHARE * self.iterate.values.len() as f64;
            if (!progresses || is_slow) && self.try_local_solve(&recently_changed) {
                progress = new_progress();
                recently_changed.clear();
                has_new_states = true;
                continue;
            }
            if !progresses {
                return Err(End::Stagnation);
            }
            self.iterate.change_states(changes);
        }
    }

    /// Evaluates the iterate after a linear system, with the state changes of cells where they are predicted as a whole
    /// ([`changes_of_cells`]), and keeps the iterate if it is the best one.
    fn evaluate(&mut self) -> Result<Evaluation, End> {
        let mut evaluation = self.iterate.evaluate(&*self.solver);
        if !evaluation.is_finite() {
            return Err(Outcome::NotFinite.into());
        }
        if let Some(changes) = changes_of_cells(self.iterate, &evaluation, &*self.solver) {
            evaluation.state_changes = changes;
        }
        self.iterate.keep_if_best(evaluation.merit);
        self.recorder.end_step(|| self.iterate.certificate());
        Ok(evaluation)
    }

    /// [`LinearSolver::determine_jump_multipliers`], which solves a linear system.
    fn determine_jump_multipliers(&mut self) -> Result<bool, End> {
        let are_determined = self.solver.determine_jump_multipliers(self.iterate)?;
        if are_determined {
            self.recorder.count_system();
            self.recorder.end_step(|| self.iterate.certificate());
        }
        Ok(are_determined)
    }

    /// Solves the inequality near the unknowns `changed` if [`Iteration::local_solves`] is not zero; returns whether a
    /// solution was found. A local inequality without solution is the last one of the iteration.
    fn try_local_solve(&mut self, changed: &[u32]) -> bool {
        if self.local_solves == 0 {
            return false;
        }
        let Some(outcome) = solve_locally(self.iterate, self.settings, changed) else {
            return false;
        };
        let is_solved = outcome == Outcome::Converged;
        self.local_solves = if is_solved { self.local_solves - 1 } else { 0 };
        is_solved
    }

    /// Solves the linear system of the present active set; `has_new_states` if the linear solver is not yet prepared
    /// for this active set.
    fn solve_system(&mut self, has_new_states: bool, accuracy: Accuracy) -> Result<(), End> {
        if has_new_states {
            if self.iterate.outer >= self.settings.max_outer {
                return Err(Outcome::IterationLimit.into());
            }
            self.iterate.outer += 1;
            self.recorder.begin_step();
            self.solver.set_eliminated(&self.iterate.eliminated)?;
        } else {
            self.recorder.count_system();
        }
        self.solver.correct(self.iterate, accuracy)
    }

    /// The end of an iteration whose certificate remains too large because of rounding. [`End::Unsuitable`] after a
    /// Krylov method for a penalised matrix: factors with jump multipliers as unknowns have smaller rounding errors
    /// than the assembled matrix.
    fn end_by_rounding(&self) -> End {
        let is_assembled = self.iterate.jump_multipliers.is_empty();
        match self.iterate.inequality.penalised {
            Some(_) if is_assembled => End::Unsuitable,
            _ => Outcome::Stalled.into(),
        }
    }

    /// Whether the certificate of the iterate is within its limit.
    fn has_small_certificate(&self) -> bool {
        self.iterate.certificate() <= T::CERTIFICATE_LIMIT
    }
}
