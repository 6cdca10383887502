//! The run of each method, from the iterate that the one before it left.

use std::borrow::Cow;

use crate::algebra::{Contact, Inequality, PenalisedMatrix, Start, any_part};
use crate::inequality::active_set::contact_state::prescribed_value;
use crate::inequality::active_set::direct_solver::DirectSolver;
use crate::inequality::active_set::iterate::Iterate;
use crate::inequality::active_set::iteration::Iteration;
use crate::inequality::active_set::linear_solver::End;
use crate::inequality::active_set::preconditioned_solver::PreconditionedSolver;
use crate::inequality::active_set::progress::SYSTEMS_WITHOUT_HALVING;
use crate::inequality::active_set::settings::ActiveSet;
use crate::inequality::history::Recorder;
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::interior_point;
use crate::inequality::monotone_multigrid::MonotoneMultigrid;
use crate::inequality::{Outcome, Solution, Stage, StageRun};
use crate::linear::krylov::symmetric_part;
use crate::linear::precondition::unknowns_per_cell;
use crate::linear::{CoarseSpaces, PreconditionedSystem, PreconditionerFamily};
use crate::real::Real;

/// Relative tolerance of accurate solutions by Krylov methods, divided by the limit of the certificate.
const TOLERANCE_TO_LIMIT: f64 = 0.1;

/// That tolerance for broken quadratics, whose L2 error falls by eight with each refinement, divided by the tolerance for
/// linear functions: biactive-half-2d, `sipg-p2:midpoints`, 128 (`algebraic_errors` in docs/solvers.md).
const QUADRATIC_TO_LINEAR: f64 = 0.1;

/// Least tolerance for broken quadratics, divided by machine epsilon, unless that for linear functions is smaller.
const LEAST_TOLERANCE: f64 = 100.0;

/// Largest number of local inequalities, near unknowns whose states change, that the iteration with a Krylov method
/// solves before the next method follows: lshape-2d, `wopsip`, 128 needs nine.
const MAX_LOCAL_SOLVES: usize = 10;

/// Dimension of the space of linear functions on a tetrahedron.
const MAX_LINEAR_BASIS: usize = 4;

/// Number of cycles of monotone multigrid without halving the change of a cycle after which the next method follows:
/// while the active set changes, cycles make little progress (lshape-2d, `wopsip:facet-means`, 128).
const CYCLES_WITHOUT_HALVING: usize = 60;

/// Whether monotone multigrid suits the inequality: the matrix is symmetric, coarse spaces are known, and each jump
/// of the penalty is that of a single unknown. If a large penalty acts on jumps of means of several vertex values,
/// Gauss-Seidel sweeps hardly change any single vertex value.
pub(super) fn suits_monotone_multigrid<T: Real>(
    inequality: &Inequality<T>,
    guess: &InitialGuess<T>,
) -> bool {
    let Inequality { distribution, symmetric, penalised, .. } = inequality;
    distribution.is_none()
        && *symmetric
        && !matches!(guess.coarse_spaces, CoarseSpaces::Unknown)
        && penalised.as_ref().is_none_or(PenalisedMatrix::has_jumps_of_single_unknowns)
}

/// The state that the methods of a solve hand on.
pub(super) struct Ladder<'s, 'a, T: Real> {
    settings: &'s ActiveSet,
    inequality: &'a Inequality<T>,
    guess: &'s InitialGuess<T>,
    recorder: &'s Recorder<'s>,
    iterate: Iterate<'a, T>,
    /// The solver with factors; `None` before it is needed.
    direct: Option<DirectSolver<'a, T>>,
    /// The methods that ran.
    stages: Vec<StageRun>,
    /// See [`Solution::linear_solver`].
    linear_solver: &'static str,
    /// See [`Solution::algebraic_bound`].
    algebraic_bound: Option<f64>,
}

impl<'s, 'a, T: Real> Ladder<'s, 'a, T> {
    /// The state before the first method. A Krylov method starts from the values of the guess.
    pub fn new(
        settings: &'s ActiveSet,
        inequality: &'a Inequality<T>,
        (guess, recorder): (&'s InitialGuess<T>, &'s Recorder<'s>),
        uses_krylov: bool,
    ) -> Self {
        let values = match &guess.values {
            Some(values) if uses_krylov => values.as_slice(),
            _ => &[],
        };
        Self {
            settings,
            inequality,
            guess,
            recorder,
            iterate: Iterate::new(inequality, values),
            direct: None,
            stages: Vec::new(),
            linear_solver: "direct",
            algebraic_bound: None,
        }
    }

    /// Adds the work of a method since the iterate had done `before`, and `cycles`.
    fn record(&mut self, stage: Stage, before: [usize; 2], cycles: usize) {
        let Iterate { outer, linear, .. } = self.iterate;
        let (outer, linear) = (outer - before[0] + cycles, linear - before[1]);
        self.stages.push(StageRun { stage, outer, linear });
    }

    fn work(&self) -> [usize; 2] {
        [self.iterate.outer, self.iterate.linear]
    }

    /// The active set iteration with a preconditioned Krylov method.
    pub fn active_set_by_krylov(&mut self, family: &dyn PreconditionerFamily<T>) -> End {
        let before = self.work();
        let end = self.run_krylov(family).unwrap_or_else(|end| end);
        self.record(Stage::PreconditionedActiveSet, before, 0);
        end
    }

    fn run_krylov(&mut self, family: &dyn PreconditionerFamily<T>) -> Result<End, End> {
        let (inequality, guess) = (self.inequality, self.guess);
        let matrix = symmetric_part(inequality);
        let spaces = match inequality.is_in_parts() {
            // the preconditioner of a distributed matrix has its own coarse spaces
            true => Cow::Borrowed(&guess.coarse_spaces),
            false => guess.coarse_spaces.complete(&matrix, inequality).ok_or(End::Unsuitable)?,
        };
        let system = PreconditionedSystem::new(&matrix, inequality, &spaces);
        let preconditioner = family.preconditioner(system).ok_or(End::Unsuitable)?;
        self.linear_solver = preconditioner.name();
        let tolerance = self.krylov_tolerance();
        let mut solver = PreconditionedSolver::new(inequality, &matrix, preconditioner, tolerance);
        let limit = self.krylov_limit();
        let has_local_solves =
            !inequality.is_in_parts() && !suits_monotone_multigrid(inequality, guess);
        let mut iteration = Iteration {
            settings: self.settings,
            iterate: &mut self.iterate,
            solver: &mut solver,
            limit,
            local_solves: if has_local_solves { MAX_LOCAL_SOLVES } else { 0 },
            needs_certificate: guess.energy_tolerance.is_none(),
            recorder: self.recorder,
        };
        let end = iteration.run();
        if end != End::Outcome(Outcome::Converged) {
            return Ok(end);
        }
        if !inequality.symmetric {
            solver.estimate_smallest_eigenvalue(&mut self.iterate)?;
        }
        self.bound_error(&mut solver)
    }

    /// The number of systems, each solved by a Krylov method, within which the number of state changes must halve. None for
    /// one part of a mesh, which no other method follows, and from a cold start: the active set grows layer by layer, in
    /// many steps that are cheap. Three times as many where what follows is dear: factors of a matrix that is not
    /// symmetric, or the many cycles that broken quadratics take.
    fn krylov_limit(&self) -> Option<usize> {
        let Inequality { symmetric, start, distribution, .. } = self.inequality;
        let is_dear = !symmetric || self.has_more_unknowns_than_linears();
        let limit = SYSTEMS_WITHOUT_HALVING * if is_dear { 3 } else { 1 };
        (distribution.is_none() && *start != Start::Cold).then_some(limit)
    }

    /// Whether each cell owns more unknowns than linear functions on a tetrahedron have: broken quadratics in the plane
    /// and in space.
    fn has_more_unknowns_than_linears(&self) -> bool {
        unknowns_per_cell(&self.inequality.locations).is_some_and(|n| n > MAX_LINEAR_BASIS)
    }

    /// The relative tolerance of accurate solutions by Krylov methods; that of the initial guess if it is larger.
    fn krylov_tolerance(&self) -> f64 {
        let tolerance = TOLERANCE_TO_LIMIT * T::CERTIFICATE_LIMIT;
        let least = match self.has_more_unknowns_than_linears() {
            true => {
                (QUADRATIC_TO_LINEAR * tolerance).max(LEAST_TOLERANCE * T::EPSILON).min(tolerance)
            }
            false => tolerance,
        };
        self.guess.energy_tolerance.unwrap_or(0.0).max(least)
    }

    /// Projects the values of a converged iterate onto their bounds and computes the bound on their error. If the
    /// certificate of the projected values is too large, the values before the projection are restored, without a bound.
    ///
    /// # Errors
    /// [`End::Unsuitable`] if the bound is above its limit and the initial guess sets no tolerance.
    fn bound_error(&mut self, solver: &mut PreconditionedSolver<'_, T>) -> Result<End, End> {
        let (inequality, energy_tolerance) = (self.inequality, self.guess.energy_tolerance);
        let values = self.iterate.values.clone();
        let jump_multipliers = self.iterate.jump_multipliers.clone();
        let bound = solver.error_bound(&mut self.iterate).map_err(End::Outcome)?;
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
        } else {
            self.algebraic_bound = bound;
        }
        let is_large = |bound: f64| bound.is_nan() || bound > T::ALGEBRAIC_BOUND_LIMIT;
        match self.algebraic_bound.is_some_and(is_large) && energy_tolerance.is_none() {
            true => Err(End::Unsuitable),
            false => Ok(End::Outcome(Outcome::Converged)),
        }
    }

    /// Monotone multigrid from the best iterate. Its solution replaces the iterate if it converges.
    pub fn monotone_multigrid(&mut self) -> End {
        let before = self.work();
        let guess = InitialGuess {
            values: Some(self.iterate.best_values().0.to_vec()),
            ..self.guess.clone()
        };
        let method = MonotoneMultigrid::default().stagnation_cycles(CYCLES_WITHOUT_HALVING);
        let solution = method.run_cycles(self.inequality, &guess, self.recorder);
        let Solution { values, mut contact, outcome, outer, linear, .. } = solution;
        self.iterate.linear += linear;
        self.record(Stage::MonotoneMultigrid, before, outer);
        if outcome != Outcome::Converged {
            return End::Stagnation;
        }
        // certificate and bound were computed for these values: an unknown that is not exactly at its bound becomes
        // inactive, because `replace` would otherwise change its value
        for (i, state) in contact.iter_mut().enumerate() {
            if prescribed_value(&self.inequality.bounds[i], *state) != Some(values[i]) {
                *state = Contact::Inactive;
            }
        }
        self.iterate.replace(values, Vec::new(), contact);
        self.linear_solver = solution.linear_solver;
        self.algebraic_bound = solution.algebraic_bound;
        End::Outcome(outcome)
    }

    /// The active set iteration with factors.
    pub fn active_set_by_factors(&mut self) -> End {
        let before = self.work();
        self.forget_krylov_iterates();
        self.linear_solver = "direct";
        let new = || DirectSolver::new(self.inequality);
        let solver = self.direct.get_or_insert_with(new);
        let mut iteration = Iteration {
            settings: self.settings,
            iterate: &mut self.iterate,
            solver,
            limit: Some(SYSTEMS_WITHOUT_HALVING),
            local_solves: 0,
            needs_certificate: true,
            recorder: self.recorder,
        };
        let end = iteration.run();
        self.algebraic_bound = match end {
            End::Outcome(Outcome::Converged) => solver.error_bound(&mut self.iterate),
            _ => None,
        };
        self.record(Stage::DirectActiveSet, before, 0);
        end
    }

    /// Before the first method with factors: iterates of a Krylov method have no jump multipliers.
    fn forget_krylov_iterates(&mut self) {
        if self.direct.is_none() && self.inequality.penalised.is_some() {
            self.iterate.forget_best();
        }
    }

    /// One run of the interior point method. Its contact states, if it has an iterate, replace those of the present
    /// iterate. If it converged, its values are the best so far: no active set need be better where the states of many
    /// unknowns hardly matter.
    pub fn interior_point(&mut self) {
        let before = self.work();
        self.forget_krylov_iterates();
        let new = || DirectSolver::new(self.inequality);
        let solver = self.direct.get_or_insert_with(new);
        let left = self.settings.max_outer.saturating_sub(self.iterate.outer);
        let max_systems = left.min(interior_point::MAX_SYSTEMS);
        let (inequality, recorder) = (self.inequality, self.recorder);
        let solution = interior_point::run(inequality, solver.system(), max_systems, recorder);
        self.iterate.outer += solution.outer;
        if solution.outcome.has_iterate() {
            let Solution { values, contact, jump_multipliers, outcome, .. } = solution;
            self.iterate.replace(values, jump_multipliers, contact);
            if outcome == Outcome::Converged {
                self.iterate.set_best(solver);
            }
        }
        self.record(Stage::InteriorPoint, before, 0);
    }

    /// The solution: the iterate if it converged, else the best one.
    pub fn into_solution(mut self, end: End) -> Solution<T> {
        let inequality = self.inequality;
        let mut outcome = match end {
            End::Outcome(outcome) => self.iterate.outcome_of_best(outcome),
            End::Stagnation => self.iterate.outcome_of_best(Outcome::Cycling),
            End::Singular => self.iterate.outcome_of_best(Outcome::Singular),
            // no method follows over parts: the bound on the error is too large, or the Krylov method does not fit
            End::Unsuitable => Outcome::Stalled,
        };
        // a matrix that is not symmetric, although it is declared so, explains a failure
        if outcome != Outcome::Converged
            && inequality.symmetric
            && !inequality.is_in_parts()
            && !inequality.matrix.is_symmetric()
        {
            outcome = Outcome::Malformed;
        }
        let outer = self.stages.iter().map(|run| run.outer).sum();
        let linear = self.iterate.linear;
        self.iterate
            .into_solution(outcome)
            .iterations(outer, linear)
            .linear_solver(self.linear_solver)
            .algebraic_bound(self.algebraic_bound)
            .stages(self.stages)
    }
}
