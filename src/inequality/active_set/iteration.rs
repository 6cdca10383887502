//! The active set iteration, for every linear solver.

use super::iterate::Iterate;
use super::linear_solver::{Accuracy, LinearFailure, LinearSolver};
use super::local_inequality::solve_locally;
use super::progress::{Obstruction, Patience, ProgressMonitor};
use super::settings::ActiveSet;
use crate::algebra::{Bound, Inequality, any_part};
use crate::inequality::violations::certify_with_rounding;
use crate::inequality::{Outcome, StepCounter};
use crate::linear::direct::FactorError;
use crate::real::Real;

/// The largest certificate that is attributed to rounding, divided by `rounding_band` times machine
/// epsilon.
const CERTIFICATE_FACTOR: f64 = 8.0;

/// Number of steps after which an iteration with few state changes continues from the solution near the
/// unknowns that change them; see [`solve_locally`]. WOPSIP with bounds at vertices on radial-3d at 32, whose
/// last changes move along the free boundary from cell to cell, takes three quarters of the steps.
const MANY_STEPS: usize = 8;

/// Changes of states are few up to this share of the unknowns.
const FEW_CHANGES: f64 = 1.0 / 4000.0;

/// How often an iteration continues with violations below its tolerance.
const CONTINUATIONS: usize = 8;

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
/// Each step solves the linear system of the present active set and predicts a new one
/// ([`Iterate::evaluate`]). It ends where the active set predicts itself, or all violations are
/// within the tolerance of the linear solver; the certificate, which does not depend on contact
/// states, then decides.
pub(crate) struct Iteration<'s, 'i, 'a, T> {
    pub settings: &'s ActiveSet,
    pub iterate: &'i mut Iterate<'a, T>,
    pub solver: &'i mut dyn LinearSolver<T>,
    pub patience: Patience,
    /// How often an iteration that does not progress may continue from the solution near the unknowns
    /// whose states change; see [`solve_locally`].
    pub local_solves: usize,
    /// Whether the certificate must be within its limit. A solution that only provides a start for
    /// another solve needs no small residual.
    pub is_certified: bool,
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

    /// The iteration. `Ok` if it converged.
    ///
    /// Unknowns that then violate bounds by less than the tolerance, but by what large penalties make count in energy,
    /// become active ([`Iterate::small_violations`]), and the iteration continues. Where it does not converge again,
    /// the first solution remains.
    fn iterate_to_end(&mut self) -> Result<(), End> {
        self.iterate_to_tolerance()?;
        let band = self.settings.rounding_band;
        for _ in 0..CONTINUATIONS {
            let violations = self.iterate.small_violations(band, &*self.solver);
            if violations.is_empty() {
                break;
            }
            let Iterate { values, jump_multipliers, states, .. } = &*self.iterate;
            let (values, jumps, states) =
                (values.clone(), jump_multipliers.clone(), states.clone());
            self.iterate.change_states(&violations);
            self.patience.halving = self.patience.halving.or(Some(self.settings.stagnation_steps));
            if self.iterate_to_tolerance().is_err() {
                self.iterate.replace(values, jumps, states);
                self.solver.set_eliminated(&self.iterate.eliminated)?;
                break;
            }
        }
        Ok(())
    }

    /// The iteration from the present states until all violations are within the tolerances of the solver and of
    /// [`Iterate::evaluate`].
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
        let patience = self.patience;
        let new_progress = || ProgressMonitor::new(patience, is_linear, distribution);
        let mut progress = new_progress();
        let mut has_new_states = true;
        // the unknowns whose states have changed since the number of changes halved
        let mut recent: Vec<u32> = Vec::new();
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
                if !self.is_certified || self.has_small_certificate() {
                    return Ok(());
                }
                if self.solver.determine_jump_multipliers(self.iterate)? {
                    if self.has_small_certificate() {
                        return Ok(());
                    }
                    self.iterate.jump_multipliers.clear();
                    self.iterate.residual_is_current = false;
                }
                // rounding may have made the recursive residual of a Krylov method too small
                if tolerance == 0.0 || !progress.may_repeat() {
                    return Err(self.end_by_rounding());
                }
            }
            let noted = progress.note(changes, &self.iterate.states, is_best, is_accurate);
            if progress.has_halved() {
                recent.clear();
            }
            recent.extend(changes.iter().map(|change| change.0));
            let is_slow = progress.steps() > MANY_STEPS
                && changes.len() as f64 <= FEW_CHANGES * self.iterate.values.len() as f64;
            if (noted.is_err() || is_slow) && self.settle(&recent) {
                progress = new_progress();
                recent.clear();
                has_new_states = true;
                continue;
            }
            noted.map_err(End::Obstruction)?;
            // states that keep changing at the limit of rounding, in a stage that no other one follows
            if !patience.limits_improvement()
                && progress.steps_without_improvement() > self.settings.improvement_steps
                && QualityOfBest::of(self.iterate, band).is_admissible_solution()
            {
                return Err(Outcome::Stalled.into());
            }
            self.iterate.change_states(changes);
        }
    }

    /// Solves the inequality near the unknowns `changed`, if that is allowed once more; returns whether it
    /// was solved.
    fn settle(&mut self, changed: &[u32]) -> bool {
        let is_solved =
            self.local_solves > 0 && solve_locally(self.iterate, self.settings, changed);
        self.local_solves -= usize::from(is_solved);
        is_solved
    }

    /// Solves the linear system of the present active set, which `has_new_states` if the solver has not
    /// been prepared for it. `Ok(false)` if the first matrix of a solve is singular and every bound has
    /// been made active instead.
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
            // bounds alone hold a part of the domain, and the active set has released all of them there;
            // or large penalties make the matrix of an arbitrary active set singular but for rounding
            Err(LinearFailure::Factors(FactorError::Singular))
                if self.patience.halving.is_some() && self.may_have_regular_successor() =>
            {
                Err(End::Obstruction(Obstruction::Stagnation))
            }
            Err(failure) => Err(failure.into()),
        }
    }

    /// Whether another active set may have a regular matrix where that of the present one is singular.
    fn may_have_regular_successor(&self) -> bool {
        let Inequality { kernel, penalised, is_definite, .. } = self.iterate.inequality;
        !kernel.is_empty() || (*is_definite && penalised.is_some())
    }

    /// The end of an iteration whose certificate stays too large. Factors with jump multipliers as
    /// unknowns have less rounding than a Krylov method with the assembled matrix.
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

/// The outcome of an iteration that ends with `outcome`, without a final active set or above rounding. If the
/// best iterate satisfies the complementarity conditions as well as rounding allows or, after
/// [`Outcome::Stalled`], within the limit of the certificate, it replaces the present one and the outcome is
/// [`Outcome::Converged`]; within rounding, but above that limit, it is [`Outcome::Stalled`]; else `outcome`.
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
    // factors aim at rounding; a settled active set that misses this aim only is a solution all the same
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
    /// Whether bounds hold to the rounding of values.
    is_admissible: bool,
    /// Whether the certificate is within rounding, which large penalties amplify.
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
