//! The driver of the active set method with inexact linear solutions, without factors of the matrix.

use super::inexact_iterate::{InexactIterate, MAX_ITERATIONS};
use super::kkt_evaluation::KktEvaluation;
use super::progress::ProgressMonitor;
use super::{ActiveSet, Globalisation};
use crate::algebra::{Bound, Contact, Inequality, Start};
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::validation::check_definite;
use crate::inequality::{Outcome, Solution};
use crate::linear::CoarseSpaces;
use crate::linear::direct::FactorError;
use crate::linear::krylov::StoppingRule;
use crate::linear::krylov::{KrylovMethod, symmetric_part};
use crate::linear::precondition::AnyPreconditioner;
use crate::real::Real;

/// The number of inexact steps that cost as much as one step with factors.
const DIRECT_STEP_COST: usize = 4;

/// A run of the inexact active set method.
pub(crate) struct InexactDriver<'a, T> {
    settings: &'a ActiveSet,
    guess: &'a InitialGuess<T>,
    iterate: InexactIterate<'a, T>,
    /// Whether the number of state changes did not halve for too long, so that the run ended.
    has_stagnated: bool,
}

/// What remains of a run without result, after which another method follows.
#[derive(Default)]
pub(crate) struct Failure {
    /// Number of linear systems with a new active set.
    pub outer: usize,
    /// Number of iterations of the linear solver.
    pub linear: usize,
    /// The last contact states if the active set stagnated; `None` if the run ended for another reason.
    pub last_active_set: Option<Vec<Contact>>,
}

/// Why the iteration ends early: an outcome of the run, or `None` if the method does not apply and
/// another one follows.
type StopReason = Option<Outcome>;

impl<'a, T: Real> InexactDriver<'a, T> {
    /// A run from the contact states of the inequality's start and the values of the guess.
    pub fn new(
        settings: &'a ActiveSet,
        inequality: &'a Inequality<T>,
        guess: &'a InitialGuess<T>,
    ) -> Self {
        let iterate = InexactIterate::new(inequality, guess);
        Self { settings, guess, iterate, has_stagnated: false }
    }

    /// Chooses the preconditioner, finds the active set, and bounds the error of the solution.
    ///
    /// # Errors
    /// [`Failure`] if no preconditioner fits, or the iteration ends without an outcome.
    pub fn run(mut self) -> Result<Solution<T>, Failure> {
        let inequality = self.iterate.inequality;
        let is_symmetric = inequality.symmetric;
        let matrix = symmetric_part(inequality);
        let known = &self.guess.coarse_spaces;
        let Some(spaces) = AnyPreconditioner::coarse_spaces(&matrix, inequality, known) else {
            return Err(self.into_failure());
        };
        let preconditioner =
            AnyPreconditioner::new(&matrix, &inequality.supports, &spaces, is_symmetric);
        let Some(mut preconditioner) = preconditioner else {
            return Err(self.into_failure());
        };
        let found = self.find_active_set(&mut preconditioner);
        let mut end = found.map_or_else(|end| end, |()| Some(Outcome::Converged));
        if end == Some(Outcome::Converged) && !is_symmetric {
            end = self.iterate.estimate_smallest_eigenvalue(&matrix, &mut preconditioner);
        }
        if end == Some(Outcome::NotCoercive) && !is_symmetric {
            // Rounding may be the reason, so that a Cholesky factorisation decides. LU factors of this
            // matrix would not detect an indefinite symmetric part.
            end = check_definite(inequality).err();
        }
        match end {
            Some(outcome) => Ok(self.into_solution(outcome, &mut preconditioner)),
            None => Err(self.into_failure()),
        }
    }

    /// The active set iteration. `Ok` if it converged.
    ///
    /// # Errors
    /// The reason why it ended without convergence.
    fn find_active_set(
        &mut self,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Result<(), StopReason> {
        let Self { settings, guess, .. } = *self;
        let tolerance = guess.energy_tolerance.unwrap_or(0.0).max(0.1 * T::CERTIFICATE_LIMIT);
        // The residual is no measure of the error in the energy norm. A solve with a given tolerance on
        // that error only provides a start for another solve, which needs no small residual.
        let residual_limit =
            if guess.energy_tolerance.is_some() { f64::INFINITY } else { T::CERTIFICATE_LIMIT };
        let mut krylov = KrylovMethod::new(self.iterate.inequality);
        self.iterate.energy_norm = self.iterate.evaluate_kkt(settings.rounding_band).energy_norm;
        let is_linear = !self.iterate.inequality.bounds.iter().any(Bound::is_inequality);
        let mut progress = ProgressMonitor::new(is_linear);
        loop {
            if progress.active_set_changed {
                self.begin_step(preconditioner)?;
            }
            let stop = StoppingRule {
                norm: tolerance * self.iterate.energy_norm,
                reduction: if progress.is_accurate() {
                    0.0
                } else {
                    preconditioner.inexact_reduction()
                },
                max_iterations: MAX_ITERATIONS,
            };
            let evaluation = self.solve_and_evaluate(&mut krylov, preconditioner, stop)?;
            let energy_norm = evaluation.energy_norm;
            let is_accurate =
                self.iterate.residual_norm <= stop.norm.min(1.01 * tolerance * energy_norm);
            let changes = &evaluation.state_changes;
            if is_accurate && (changes.is_empty() || evaluation.holds_to(tolerance)) {
                if evaluation.inactive_residual <= residual_limit * energy_norm {
                    return Ok(());
                }
                self.repeat_after_rounding(&mut progress)?;
            }
            self.check_stagnation(&mut progress, changes.len())?;
            let has_returned = self.iterate.record(changes);
            if !progress.improves(&evaluation, has_returned, settings.improvement_steps) {
                return Err(None);
            }
            self.iterate.change_states(changes);
        }
    }

    /// Counts a step and restricts the preconditioner to the inactive unknowns.
    ///
    /// # Errors
    /// The limit of steps is reached, or the preconditioner has no factors.
    fn begin_step(
        &mut self,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Result<(), StopReason> {
        if self.iterate.outer >= self.settings.max_outer {
            return Err(Some(Outcome::IterationLimit));
        }
        self.iterate.outer += 1;
        let is_symmetric = self.iterate.inequality.symmetric;
        preconditioner.set_fixed(&self.iterate.eliminated).map_err(|error| match error {
            FactorError::OutOfMemory => Some(Outcome::OutOfMemory),
            FactorError::NotPositive if !is_symmetric => Some(Outcome::NotCoercive),
            // factors of the whole matrix give the reason
            _ => None,
        })
    }

    /// Solves the linear system of a step, evaluates the KKT conditions, and stores energy norm and
    /// residual norm in the iterate.
    ///
    /// # Errors
    /// The linear solver did not converge, or a number is not finite.
    fn solve_and_evaluate(
        &mut self,
        krylov: &mut KrylovMethod<'_, T>,
        preconditioner: &mut AnyPreconditioner<'_, T>,
        stop: StoppingRule,
    ) -> Result<KktEvaluation, StopReason> {
        let run = self.iterate.solve_linear(krylov, preconditioner, stop);
        match self.iterate.outcome_of(&run) {
            Some(Outcome::Converged) => {}
            end => return Err(end),
        }
        let evaluation = self.iterate.evaluate_kkt(self.settings.rounding_band);
        if !(evaluation.energy_norm.is_finite() && evaluation.max_norm.is_finite()) {
            return Err(Some(Outcome::NotFinite));
        }
        self.iterate.energy_norm = evaluation.energy_norm;
        self.iterate.residual_norm = run.norm;
        Ok(evaluation)
    }

    /// Permits another solution where rounding has made the recursive residual of the Krylov method
    /// smaller than the true one.
    ///
    /// # Errors
    /// Too many solutions were repeated: for penalised matrices `None`, since the direct method that
    /// follows has less rounding with jump multipliers as unknowns; else [`Outcome::Stalled`].
    fn repeat_after_rounding(&self, progress: &mut ProgressMonitor) -> Result<(), StopReason> {
        if progress.may_repeat() {
            return Ok(());
        }
        let is_penalised = self.iterate.inequality.penalised.is_some();
        Err(if is_penalised { None } else { Some(Outcome::Stalled) })
    }

    /// Ends the run (`Err(None)`) if the number of state changes has not halved for too long. From
    /// a cold start it need not halve: the active set then grows layer by layer, in many steps that
    /// are cheap.
    fn check_stagnation(
        &mut self,
        progress: &mut ProgressMonitor,
        changes: usize,
    ) -> Result<(), StopReason> {
        if self.settings.globalisation == Globalisation::OnStagnation
            && self.iterate.inequality.start != Start::Cold
            && progress.stagnates(changes, self.stagnation_steps())
        {
            self.has_stagnated = true;
            return Err(None);
        }
        Ok(())
    }

    /// The number of inexact steps within which the number of state changes must halve:
    /// `stagnation_steps` of [`ActiveSet`], times [`DIRECT_STEP_COST`] unless the method that
    /// follows is cheap: multigrid, or static condensation, which halves the number of unknowns.
    fn stagnation_steps(&self) -> usize {
        let is_nested = matches!(self.guess.coarse_spaces, CoarseSpaces::CoarseLevel(_));
        let is_cheap = is_nested || self.iterate.inequality.penalised.is_some();
        self.settings.stagnation_steps * if is_cheap { 1 } else { DIRECT_STEP_COST }
    }

    /// The solution, with a bound on its error in the energy norm if it converged; the values are then
    /// projected onto their bounds.
    fn into_solution(
        mut self,
        outcome: Outcome,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Solution<T> {
        let is_converged = outcome == Outcome::Converged;
        let bound = is_converged.then(|| self.iterate.error_bound(preconditioner)).flatten();
        let InexactIterate { values, states, outer, linear, .. } = self.iterate;
        Solution::new(values, states, outcome)
            .iterations(outer, linear)
            .linear_solver(preconditioner.name())
            .algebraic_bound(bound)
    }

    /// The record of a run without result.
    fn into_failure(self) -> Failure {
        let InexactIterate { states, outer, linear, .. } = self.iterate;
        Failure { outer, linear, last_active_set: self.has_stagnated.then_some(states) }
    }
}
