//! The active set iteration, for every linear solver.

use super::iterate::Iterate;
use super::linear_solver::{Accuracy, LinearFailure, LinearSolver};
use super::local_inequality::solve_locally;
use super::progress::{Obstruction, ProgressLimits, ProgressMonitor};
use super::settings::ActiveSet;
use crate::algebra::{Bound, Inequality, any_part};
use crate::inequality::violations::certify_with_rounding;
use crate::inequality::{Outcome, StepCounter};
use crate::linear::direct::FactorError;
use crate::real::Real;

/// The largest certificate that is attributed to rounding, divided by `rounding_band` times machine
/// epsilon.
const CERTIFICATE_FACTOR: f64 = 8.0;

/// Number of steps after which an iteration with few state changes calls [`solve_locally`]. WOPSIP with bounds at
/// vertices on radial-3d at 32, whose last state changes move along the free boundary from cell to cell, then takes
/// three quarters of the steps.
const MANY_STEPS: usize = 8;

/// Largest number of state changes, divided by the number of unknowns, that counts as few.
const FEW_CHANGES_SHARE: f64 = 1.0 / 4000.0;

/// Largest number of times that an iteration continues with the violations of [`Iterate::small_violations`].
const MAX_CONTINUATIONS: usize = 8;

/// How an iteration ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// With this outcome.
    Outcome(Outcome),
    /// The iteration does not progress.
    Obstruction(Obstruction),
    /// The linear solver does not fit the matrix.
    Unsuitable,
}

impl From<Outcome> for End {
    fn from(outcome: Outcome) -> Self {
        Self::Outcome(outcome)
    }
}

impl From<LinearFailure> for End {
    fn from(failure: LinearFailure) -> Self {
        match failure {
            LinearFailure::Factors(error) => Self::Outcome(error.into()),
            LinearFailure::Outcome(outcome) => Self::Outcome(outcome),
            LinearFailure::Unsuitable => Self::Unsuitable,
        }
    }
}

/// The active set iteration from the contact states of an iterate.
///
/// Each step solves the linear system of the present active set and predicts a new one ([`Iterate::evaluate`]). The
/// iteration converges if the active set predicts itself, or all violations are within the tolerance of the linear
/// solver, and if the certificate, which does not depend on contact states, is small.
pub(crate) struct Iteration<'s, 'i, 'a, T: Real> {
    pub settings: &'s ActiveSet,
    pub iterate: &'i mut Iterate<'a, T>,
    pub solver: &'i mut dyn LinearSolver<T>,
    pub progress_limits: ProgressLimits,
    /// Number of inequalities near unknowns whose states change that may still be solved; see [`solve_locally`].
    pub local_solves: usize,
    /// Whether the certificate must be small. The residual of a solution that is only the initial guess of another
    /// solve need not be small.
    pub needs_certificate: bool,
    /// Counts the steps.
    pub steps: &'s StepCounter,
}

impl<T: Real> Iteration<'_, '_, '_, T> {
    /// Iterates until the solution is found or the iteration does not progress.
    pub fn run(&mut self) -> End {
        match self.iterate_to_end() {
            Ok(()) => End::Outcome(Outcome::Converged),
            Err(end) => end,
        }
    }

    /// Iterates to the tolerance, then continues with the unknowns of [`Iterate::small_violations`] active: they
    /// violate a bound by less than the tolerance, but large penalties give such violations a large energy. The
    /// solution before a continuation that does not converge is restored. `Ok` if the iteration converged.
    fn iterate_to_end(&mut self) -> Result<(), End> {
        self.iterate_to_tolerance()?;
        let band = self.settings.rounding_band;
        for _ in 0..MAX_CONTINUATIONS {
            let violations = self.iterate.small_violations(band, &*self.solver);
            if violations.is_empty() {
                break;
            }
            let Iterate { values, jump_multipliers, states, .. } = &*self.iterate;
            let (values, jumps, states) =
                (values.clone(), jump_multipliers.clone(), states.clone());
            self.iterate.change_states(&violations);
            let halving = &mut self.progress_limits.halving;
            *halving = halving.or(Some(self.settings.stagnation_steps));
            if self.iterate_to_tolerance().is_err() {
                self.iterate.replace(values, jumps, states);
                self.solver.set_eliminated(&self.iterate.eliminated)?;
                break;
            }
        }
        Ok(())
    }

    /// Iterates from the present states until the active set predicts itself or all violations are within the tolerance
    /// of the linear solver, and the certificate is small.
    fn iterate_to_tolerance(&mut self) -> Result<(), End> {
        let tolerance = self.solver.tolerance();
        let band = self.settings.rounding_band;
        if tolerance > 0.0 {
            // the tolerance is relative to the energy norm
            self.iterate.compute_residual();
            self.iterate.evaluate(band, &*self.solver);
        }
        let inequality = self.iterate.inequality;
        let distribution = inequality.distribution();
        let has_bounds = inequality.bounds.iter().any(Bound::is_inequality);
        let is_linear = !any_part(distribution, has_bounds);
        let progress_limits = self.progress_limits;
        let new_progress = || ProgressMonitor::new(progress_limits, is_linear, distribution);
        let mut progress = new_progress();
        let mut has_new_states = true;
        // the unknowns whose states have changed since the number of changes last halved
        let mut recently_changed: Vec<u32> = Vec::new();
        loop {
            if !self.solve_system(has_new_states, progress.accuracy())? {
                progress = new_progress();
                has_new_states = true;
                continue;
            }
            let evaluation = self.iterate.evaluate(band, &*self.solver);
            if !evaluation.is_finite() {
                return Err(Outcome::NotFinite.into());
            }
            let is_best = self.iterate.keep_if_best(evaluation.merit);
            let is_accurate = self.solver.is_accurate(evaluation.energy_norm);
            let changes = &evaluation.state_changes;
            has_new_states = evaluation.n_changes > 0;
            if is_accurate && (!has_new_states || evaluation.holds_to(tolerance)) {
                if !self.needs_certificate || self.has_small_certificate() {
                    return Ok(());
                }
                if self.solver.determine_jump_multipliers(self.iterate)? {
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
            let recorded =
                progress.record_solution(changes, &self.iterate.states, is_best, is_accurate);
            if progress.has_halved() {
                recently_changed.clear();
            }
            recently_changed.extend(changes.iter().map(|change| change.0));
            let is_slow = progress.steps() > MANY_STEPS
                && changes.len() as f64 <= FEW_CHANGES_SHARE * self.iterate.values.len() as f64;
            if (recorded.is_err() || is_slow) && self.try_local_solve(&recently_changed) {
                progress = new_progress();
                recently_changed.clear();
                has_new_states = true;
                continue;
            }
            recorded.map_err(End::Obstruction)?;
            // in the last stage, states may change without end at the limit of rounding
            if !progress_limits.limits_improvement()
                && progress.steps_without_improvement() > self.settings.improvement_steps
                && QualityOfBest::of(self.iterate, band).is_admissible_solution()
            {
                return Err(Outcome::Stalled.into());
            }
            self.iterate.change_states(changes);
        }
    }

    /// Solves the inequality near the unknowns `changed` if [`Iteration::local_solves`] is not zero; returns whether a
    /// solution was found.
    fn try_local_solve(&mut self, changed: &[u32]) -> bool {
        let is_solved =
            self.local_solves > 0 && solve_locally(self.iterate, self.settings, changed);
        self.local_solves -= usize::from(is_solved);
        is_solved
    }

    /// Solves the linear system of the present active set; `has_new_states` if the linear solver is not yet prepared
    /// for this active set. `Ok(false)` if the first matrix of a solve is singular and every bound has been made active
    /// instead.
    fn solve_system(&mut self, has_new_states: bool, accuracy: Accuracy) -> Result<bool, End> {
        if has_new_states {
            if self.iterate.outer >= self.settings.max_outer {
                return Err(Outcome::IterationLimit.into());
            }
            self.iterate.outer += 1;
            self.steps.advance(1);
        }
        let is_prepared = match has_new_states {
            true => self.solver.set_eliminated(&self.iterate.eliminated),
            false => Ok(()),
        };
        let mut corrected = is_prepared.and_then(|()| self.solver.correct(self.iterate, accuracy));
        if let Err(LinearFailure::Factors(FactorError::Singular)) = corrected
            && is_prepared.is_ok()
        {
            // an earlier matrix, singular but for rounding, may have left values so large that
            // corrections by this one have no correct digit
            self.iterate.reset_values();
            corrected = self.solver.correct(self.iterate, accuracy);
        }
        let is_definite = self.iterate.inequality.is_definite;
        if is_definite && corrected == Err(LinearFailure::Factors(FactorError::NotPositive)) {
            // a definite matrix has a negative pivot by rounding only
            corrected = Err(LinearFailure::Factors(FactorError::Singular));
        }
        match corrected {
            Ok(()) => Ok(true),
            Err(LinearFailure::Factors(FactorError::Singular)) if self.iterate.outer == 1 => {
                if self.settings.check_definite && !is_definite {
                    Err(Outcome::NotCoercive.into())
                } else if self.iterate.activate_all() {
                    Ok(false)
                } else {
                    Err(Outcome::Singular.into())
                }
            }
            // bounds alone hold a part of the domain, and no unknown is active there; or large penalties make the
            // matrix of an arbitrary active set singular but for rounding
            Err(LinearFailure::Factors(FactorError::Singular))
                if self.progress_limits.halving.is_some() && self.may_have_regular_successor() =>
            {
                Err(End::Obstruction(Obstruction::Stagnation))
            }
            Err(failure) => Err(failure.into()),
        }
    }

    /// Whether the matrix of another active set may be regular although that of the present one is singular.
    fn may_have_regular_successor(&self) -> bool {
        let Inequality { kernel, penalised, is_definite, .. } = self.iterate.inequality;
        !kernel.is_empty() || (*is_definite && penalised.is_some())
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

    /// Whether the certificate of the iterate is as small as rounding and the tolerance of the linear
    /// solver allow.
    fn has_small_certificate(&self) -> bool {
        let Iterate { inequality, values, jump_multipliers, .. } = &*self.iterate;
        let (certificate, amplification) =
            certify_with_rounding(inequality, values, jump_multipliers);
        if self.solver.tolerance() > 0.0 {
            return certificate.largest() <= T::CERTIFICATE_LIMIT;
        }
        let rounding = CERTIFICATE_FACTOR * self.settings.rounding_band * T::EPSILON;
        // large penalties amplify rounding; the limit of the certificate is respected nevertheless
        let largest = (rounding * amplification.max(1.0)).min(T::CERTIFICATE_LIMIT);
        certificate.feasibility <= rounding && certificate.largest() <= largest
    }
}

/// The outcome of a solve that ended with `outcome`. After an iteration limit, a cycle or a stall it follows from the
/// certificate of the best iterate:
///
/// * [`Outcome::Converged`], and the best iterate replaces the present one, if the certificate is within its limit and,
///   unless `outcome` is [`Outcome::Stalled`], within rounding;
/// * [`Outcome::Stalled`] if the certificate is within rounding, but above its limit;
/// * else `outcome`, also if there is no best iterate.
pub(crate) fn outcome_of_best<T: Real>(
    iterate: &mut Iterate<'_, T>,
    rounding_band: f64,
    outcome: Outcome,
) -> Outcome {
    let is_without_solution =
        matches!(outcome, Outcome::IterationLimit | Outcome::Cycling | Outcome::Stalled);
    if !is_without_solution || !iterate.has_best() {
        return outcome;
    }
    let quality = QualityOfBest::of(iterate, rounding_band);
    // factors stall if the certificate is above rounding; within its limit it is that of a solution nevertheless
    if quality.is_solution() || (quality.is_within_limit && outcome == Outcome::Stalled) {
        iterate.restore_best();
        Outcome::Converged
    } else if quality.is_within_rounding {
        Outcome::Stalled
    } else {
        outcome
    }
}

/// How well the best iterate satisfies the complementarity conditions.
struct QualityOfBest {
    /// Whether violations of bounds are within the rounding of values.
    is_admissible: bool,
    /// Whether the certificate is within rounding, amplified by large penalties.
    is_within_rounding: bool,
    /// Whether the certificate is within its limit.
    is_within_limit: bool,
}

impl QualityOfBest {
    fn of<T: Real>(iterate: &Iterate<'_, T>, rounding_band: f64) -> Self {
        let (certificate, amplification) = iterate.best_certificate();
        let rounding = CERTIFICATE_FACTOR * rounding_band * T::EPSILON;
        Self {
            is_admissible: certificate.feasibility <= rounding,
            is_within_rounding: certificate.largest() <= rounding * amplification.max(1.0),
            is_within_limit: certificate.largest() <= T::CERTIFICATE_LIMIT,
        }
    }
    fn is_solution(&self) -> bool {
        self.is_within_rounding && self.is_within_limit
    }
    fn is_admissible_solution(&self) -> bool {
        self.is_admissible && self.is_solution()
    }
}
