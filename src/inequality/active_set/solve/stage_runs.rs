//! The run of each stage.

use std::borrow::Cow;

use super::state::{Solve, StageResult};
use crate::algebra::{Contact, any_part};
use crate::inequality::active_set::contact_state::{admissible_state, prescribed_value};
use crate::inequality::active_set::direct_solver::DirectSolver;
use crate::inequality::active_set::iterate::Iterate;
use crate::inequality::active_set::iteration::{End, Iteration};
use crate::inequality::active_set::preconditioned_solver::PreconditionedSolver;
use crate::inequality::certificate;
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::interior_point::{Identification, InteriorPoint};
use crate::inequality::monotone_multigrid::MonotoneMultigrid;
use crate::inequality::{Outcome, Solution, Stage, StageRun};
use crate::linear::PreconditionedSystem;
use crate::linear::krylov::symmetric_part;
use crate::real::Real;

/// Number of cycles of monotone multigrid without halving the change of a cycle after which the next stage follows.
/// While the active set changes, cycles make little progress: lshape-2d with `wopsip:facet-means` at 128 needs 26
/// cycles, of which 12 in a row do not halve the change; factors take ten times as long there.
const PATIENCE: usize = 60;

impl<T: Real> Solve<'_, '_, T> {
    /// Runs a stage. Returns its result if the solve ends with it; else `None`, and `end` is how an active set
    /// iteration ended.
    pub(super) fn run(&mut self, stage: Stage) -> Option<StageResult> {
        let (outer, linear) = (self.iterate.outer + self.cycles, self.iterate.linear);
        let (mut result, mut has_interior_values) = (None, false);
        match stage {
            Stage::PreconditionedActiveSet => match self.run_preconditioned() {
                Ok(found) => result = Some(found),
                Err(end) => self.end = Some(end),
            },
            Stage::MonotoneMultigrid => result = self.run_monotone_multigrid(),
            Stage::DirectActiveSet => match self.run_direct() {
                End::Outcome(outcome) => {
                    let algebraic_bound = match (&self.direct, outcome) {
                        (Some(solver), Outcome::Converged) => solver.error_bound(&mut self.iterate),
                        _ => None,
                    };
                    result = Some(StageResult { algebraic_bound, ..StageResult::new(outcome) });
                }
                end => self.end = Some(end),
            },
            Stage::InteriorPoint => has_interior_values = self.run_interior_point(),
        }
        let outer = self.iterate.outer + self.cycles - outer;
        let linear = self.iterate.linear - linear;
        self.stages.push(StageRun { stage, outer, linear });
        // another run of the interior point method would start from the best iterate, which must not consist of values
        // of this run, close to their bounds
        if has_interior_values && !self.may_run_interior_point() {
            self.keep_interior_values_if_best();
        }
        result
    }

    /// The active set iteration with a preconditioned Krylov method.
    ///
    /// # Errors
    /// [`End`] if another stage must follow.
    fn run_preconditioned(&mut self) -> Result<StageResult, End> {
        let (inequality, guess) = (self.inequality, self.guess);
        let matrix = symmetric_part(inequality);
        let spaces = match inequality.distribution {
            // the preconditioner of a distributed matrix has its own coarse spaces
            Some(_) => Cow::Borrowed(&guess.coarse_spaces),
            None => guess.coarse_spaces.complete(&matrix, inequality).ok_or(End::Unsuitable)?,
        };
        let system = PreconditionedSystem::new(&matrix, inequality, &spaces);
        let preconditioner = self.family.preconditioner(system).ok_or(End::Unsuitable)?;
        let linear_solver = preconditioner.name();
        let tolerance = self.krylov_tolerance();
        let mut solver = PreconditionedSolver::new(inequality, &matrix, preconditioner, tolerance);
        let progress_limits = self.progress_limits(Stage::PreconditionedActiveSet);
        let local_solves = self.local_solves();
        let mut iteration = Iteration {
            settings: self.settings,
            iterate: &mut self.iterate,
            solver: &mut solver,
            progress_limits,
            local_solves,
            needs_certificate: guess.energy_tolerance.is_none(),
            steps: &guess.steps,
        };
        let mut outcome = match iteration.run() {
            End::Outcome(outcome) => outcome,
            end => return Err(end),
        };
        if outcome == Outcome::Converged && !inequality.symmetric {
            outcome =
                match solver.estimate_smallest_eigenvalue(&mut self.iterate).map_err(End::from) {
                    Ok(()) => outcome,
                    Err(End::Outcome(failure)) => failure,
                    Err(end) => return Err(end),
                };
        }
        let mut algebraic_bound = None;
        if outcome == Outcome::Converged {
            (outcome, algebraic_bound) = self.bound_error(&mut solver)?;
        }
        Ok(StageResult { outcome, linear_solver, algebraic_bound })
    }

    /// Projects the values of a converged iterate onto their bounds and computes the bound on their error. Returns the
    /// outcome and the bound. If the certificate of the projected values is too large, the values before the projection
    /// are restored, without a bound.
    ///
    /// # Errors
    /// [`End::Unsuitable`] if the bound is above its limit and the initial guess sets no tolerance.
    fn bound_error(
        &mut self,
        solver: &mut PreconditionedSolver<'_, T>,
    ) -> Result<(Outcome, Option<f64>), End> {
        let (inequality, energy_tolerance) = (self.inequality, self.guess.energy_tolerance);
        let values = self.iterate.values.clone();
        let jump_multipliers = self.iterate.jump_multipliers.clone();
        let (outcome, mut algebraic_bound) = match solver.error_bound(&mut self.iterate) {
            Ok(bound) => (Outcome::Converged, bound),
            Err(failure) => (failure, None),
        };
        // the projection changes jumps, and large penalties amplify such changes
        let limit = match energy_tolerance {
            None => T::CERTIFICATE_LIMIT,
            Some(tolerance) if inequality.penalised.is_some() => tolerance,
            Some(_) => f64::INFINITY,
        };
        let is_changed = any_part(inequality.distribution(), self.iterate.values != values);
        if is_changed && self.iterate.certificate() > limit {
            let states = self.iterate.states.clone();
            self.iterate.replace(values, jump_multipliers, states);
            algebraic_bound = None;
        }
        if energy_tolerance.is_none()
            && algebraic_bound.is_some_and(|b| b.is_nan() || b > T::ALGEBRAIC_BOUND_LIMIT)
        {
            return Err(End::Unsuitable);
        }
        Ok((outcome, algebraic_bound))
    }

    /// Monotone multigrid from the best iterate. Its solution replaces the iterate if it converges. `None` if the next
    /// stage must follow. An indefinite matrix ends the solve, because later factors on inactive unknowns alone need
    /// not detect it.
    fn run_monotone_multigrid(&mut self) -> Option<StageResult> {
        let values = Some(self.iterate.best_values().0.to_vec());
        let InitialGuess { coarse_spaces, energy_tolerance, steps, .. } = self.guess;
        let guess = InitialGuess {
            coarse_spaces: coarse_spaces.clone(),
            values,
            energy_tolerance: *energy_tolerance,
            steps: steps.clone(),
        };
        let solution = MonotoneMultigrid::default()
            .stagnation_cycles(PATIENCE)
            .run_cycles(self.inequality, &guess);
        let Solution {
            values,
            mut contact,
            outcome,
            linear_solver,
            outer,
            linear,
            algebraic_bound,
            ..
        } = solution;
        self.cycles += outer;
        self.iterate.linear += linear;
        if outcome == Outcome::NotCoercive {
            return Some(StageResult { outcome, linear_solver, algebraic_bound: None });
        }
        (outcome == Outcome::Converged).then(|| {
            // certificate and bound were computed for these values: an unknown that is not exactly at its bound becomes
            // inactive, because `replace` would otherwise change its value
            for (i, state) in contact.iter_mut().enumerate() {
                if prescribed_value(&self.inequality.bounds[i], *state) != Some(values[i]) {
                    *state = Contact::Inactive;
                }
            }
            self.iterate.replace(values, Vec::new(), contact);
            StageResult { outcome, linear_solver, algebraic_bound }
        })
    }

    /// The active set iteration with factors.
    fn run_direct(&mut self) -> End {
        let progress_limits = self.progress_limits(Stage::DirectActiveSet);
        if self.direct.is_none() {
            // iterates of a Krylov method have no jump multipliers
            self.iterate.forget_best();
        }
        let refinements = self.settings.refinements;
        let new = || DirectSolver::new(self.inequality, refinements);
        let solver = self.direct.get_or_insert_with(new);
        let iterate = &mut self.iterate;
        let needs_certificate = true;
        let steps = &self.guess.steps;
        let mut iteration = Iteration {
            settings: self.settings,
            iterate,
            solver,
            progress_limits,
            local_solves: 0,
            needs_certificate,
            steps,
        };
        iteration.run()
    }

    /// Replaces the iterate by the result of the interior point method, which starts from the best iterate, or from the
    /// point at which its first run ended if that run did not resolve small slacks. Returns whether the method found an
    /// active set; if not, the iterate changes in the number of linear systems only.
    fn run_interior_point(&mut self) -> bool {
        let identification = match self.runs_of(Stage::InteriorPoint) {
            0 => Identification::Early,
            _ => Identification::Final,
        };
        let refinements = self.settings.refinements;
        let new = || DirectSolver::new(self.inequality, refinements);
        let condensation = self.direct.get_or_insert_with(new).condensation();
        let start = self.iterate.best_values();
        let mut method = match self.restart_point.take() {
            Some(point) => InteriorPoint::resumed(self.inequality, condensation, point),
            None => InteriorPoint::new(self.inequality, condensation, start, identification),
        };
        let contact = method.run();
        let (values, jump_multipliers, steps) =
            (method.values(), method.jump_multipliers(), method.steps);
        self.interior_point_may_improve = method.may_improve();
        self.has_small_slacks = method.leaves_small_slacks();
        self.restart_point = method.into_restart_point();
        self.iterate.outer += steps;
        self.guess.steps.advance(steps);
        let Some(contact) = contact else { return false };
        let states = contact.iter().zip(&self.inequality.bounds);
        let states = states.map(|(&contact, bound)| admissible_state(bound, contact)).collect();
        self.iterate.replace(values, jump_multipliers, states);
        true
    }

    /// Keeps the values of the interior point method as the best iterate if their certificate is not larger and their
    /// merit is smaller. With a huge penalty these values may be more accurate than those of every active set, because
    /// the state of an unknown whose slack is of the size of rounding is arbitrary. The certificate is compared
    /// because, unlike the merit, it contains the jump residuals.
    fn keep_interior_values_if_best(&mut self) {
        let Some(solver) = &self.direct else { return };
        if self.iterate.certificate() > self.iterate.best_certificate().0.largest() {
            return;
        }
        let Iterate { values, jump_multipliers, residual, .. } = &mut self.iterate;
        certificate::residual(self.inequality, values, jump_multipliers, residual);
        let evaluation = self.iterate.evaluate(self.settings.rounding_band, solver);
        self.iterate.keep_if_best(evaluation.merit);
    }
}
