//! The run of each stage.

use std::borrow::Cow;

use super::state::{Found, Solve};
use crate::algebra::{Contact, any_part};
use crate::inequality::active_set::contact_state::{admissible_state, prescribed_value};
use crate::inequality::active_set::direct_solver::DirectSolver;
use crate::inequality::active_set::iterate::Iterate;
use crate::inequality::active_set::iteration::{End, Iteration};
use crate::inequality::active_set::preconditioned_solver::PreconditionedSolver;
use crate::inequality::certificate;
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::interior_point::{Identification, InteriorPoint};
use crate::inequality::monotone_multigrid::{MonotoneMultigrid, STAGNATION_CYCLES};
use crate::inequality::{Outcome, Solution, Stage, StageRun};
use crate::linear::PreconditionedSystem;
use crate::linear::krylov::symmetric_part;
use crate::real::Real;

impl<T: Real> Solve<'_, '_, T> {
    /// Runs a stage. Returns what it found if the solve ends with it; else stores how it ended.
    pub(super) fn run(&mut self, stage: Stage) -> Option<Found> {
        let (outer, linear) = (self.iterate.outer + self.cycles, self.iterate.linear);
        let (mut found, mut has_interior_values) = (None, false);
        match stage {
            Stage::PreconditionedActiveSet => match self.run_preconditioned() {
                Ok(result) => found = Some(result),
                Err(end) => self.end = Some(end),
            },
            Stage::MonotoneMultigrid => found = self.run_monotone_multigrid(),
            Stage::DirectActiveSet => match self.run_direct() {
                End::Outcome(outcome) => {
                    let algebraic_bound = match (&self.direct, outcome) {
                        (Some(solver), Outcome::Converged) => solver.error_bound(&mut self.iterate),
                        _ => None,
                    };
                    found = Some(Found { algebraic_bound, ..Found::new(outcome) });
                }
                end => self.end = Some(end),
            },
            Stage::InteriorPoint => has_interior_values = self.run_interior_point(),
        }
        let outer = self.iterate.outer + self.cycles - outer;
        let linear = self.iterate.linear - linear;
        self.stages.push(StageRun { stage, outer, linear });
        // another run would start from the best iterate, which must then not lie close to its bounds
        if has_interior_values && !self.may_run_interior_point() {
            self.keep_if_best();
        }
        found
    }

    /// The active set iteration with a preconditioned Krylov method.
    ///
    /// # Errors
    /// [`End`] if another stage must follow.
    fn run_preconditioned(&mut self) -> Result<Found, End> {
        let (inequality, guess) = (self.inequality, self.guess);
        let matrix = symmetric_part(inequality);
        let spaces = match inequality.distribution {
            // the preconditioner of a distributed matrix knows its own
            Some(_) => Cow::Borrowed(&guess.coarse_spaces),
            None => guess.coarse_spaces.complete(&matrix, inequality).ok_or(End::Unsuitable)?,
        };
        let system = PreconditionedSystem::new(&matrix, inequality, &spaces);
        let preconditioner = self.family.preconditioner(system).ok_or(End::Unsuitable)?;
        let linear_solver = preconditioner.name();
        let tolerance = self.krylov_tolerance();
        let mut solver = PreconditionedSolver::new(inequality, &matrix, preconditioner, tolerance);
        let patience = self.patience(Stage::PreconditionedActiveSet);
        let local_solves = self.local_solves();
        let mut iteration = Iteration {
            settings: self.settings,
            iterate: &mut self.iterate,
            solver: &mut solver,
            patience,
            local_solves,
            is_certified: guess.energy_tolerance.is_none(),
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
        Ok(Found { outcome, linear_solver, algebraic_bound })
    }

    /// The bound on the error of a converged iterate, which a Krylov method has found. The bound is that of the values
    /// projected onto their bounds; where the certificate of these is too large, the values before the projection
    /// remain, without a bound.
    ///
    /// # Errors
    /// [`End::Unsuitable`] if the bound is above its limit.
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
        // large penalties see each step from a value to its bound
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

    /// Monotone multigrid from the best iterate. The iterate is replaced if it converges. An indefinite matrix ends
    /// the solve: with factors for inactive unknowns alone, contact may hide it.
    fn run_monotone_multigrid(&mut self) -> Option<Found> {
        let values = Some(self.iterate.best_values().0.to_vec());
        let InitialGuess { coarse_spaces, energy_tolerance, steps, .. } = self.guess;
        let guess = InitialGuess {
            coarse_spaces: coarse_spaces.clone(),
            values,
            energy_tolerance: *energy_tolerance,
            steps: steps.clone(),
        };
        let solution = MonotoneMultigrid::default()
            .stagnation_cycles(STAGNATION_CYCLES)
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
            return Some(Found { outcome, linear_solver, algebraic_bound: None });
        }
        (outcome == Outcome::Converged).then(|| {
            // certificate and bound are those of the values, so that no active unknown may move to its bound
            for (i, state) in contact.iter_mut().enumerate() {
                if prescribed_value(&self.inequality.bounds[i], *state) != Some(values[i]) {
                    *state = Contact::Inactive;
                }
            }
            self.iterate.replace(values, Vec::new(), contact);
            Found { outcome, linear_solver, algebraic_bound }
        })
    }

    /// The active set iteration with factors.
    fn run_direct(&mut self) -> End {
        let patience = self.patience(Stage::DirectActiveSet);
        if self.direct.is_none() {
            // iterates of a Krylov method have no jump multipliers
            self.iterate.forget_best();
        }
        let refinements = self.settings.refinements;
        let new = || DirectSolver::new(self.inequality, refinements);
        let solver = self.direct.get_or_insert_with(new);
        let iterate = &mut self.iterate;
        let is_certified = true;
        let steps = &self.guess.steps;
        let mut iteration = Iteration {
            settings: self.settings,
            iterate,
            solver,
            patience,
            local_solves: 0,
            is_certified,
            steps,
        };
        iteration.run()
    }

    /// Replaces the iterate by the result of the interior point method, which starts from the best iterate, or goes on
    /// where its first run left small slacks. Returns whether the method found an active set; if not, only the number of
    /// linear systems changes.
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

    /// Keeps the iterate if it is the best one. Under a huge penalty the values of the interior point method may be
    /// more accurate than all that follow from active sets: a slack of the size of rounding decides a state. The merit
    /// does not see whether jumps and their multipliers agree, but the certificate does.
    fn keep_if_best(&mut self) {
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
