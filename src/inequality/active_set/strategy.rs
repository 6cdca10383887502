//! The stages of the active set method, in their order, with all thresholds.
//!
//! | stage | runs if | ends without a solution if |
//! |---|---|---|
//! | active set, preconditioned | coarse spaces are known and the problem has at least [`CROSSOVER`] unknowns, or the settings ask for it | the active set stagnates or cycles, or the preconditioner does not fit |
//! | monotone multigrid | the preceding stage stagnated, the matrix is symmetric and coarse spaces are known; not for penalties on jumps of means of several unknowns | its cycles stagnate, or reach their limit |
//! | active set, direct | no solution is known | the active set stagnates or cycles |
//! | interior point | the preceding stage ended so, and the limit of linear systems leaves room | never: it provides the next starting active set |
//!
//! The direct active set and the interior point method alternate: the interior point method identifies
//! the active set early, and a second time at its final accuracy. The active set iteration that follows
//! the second one has no limit but `max_outer`; nor has one that follows a stagnation where `max_outer` leaves no room
//! for the interior point method.
//!
//! Of an inequality that is distributed over the parts of a mesh the first stage alone runs.

use std::borrow::Cow;

use super::contact_state::{admissible_state, prescribed_value};
use super::direct_solver::DirectSolver;
use super::iterate::Iterate;
use super::iteration::{End, Iteration, outcome_of_best};
use super::preconditioned_solver::PreconditionedSolver;
use super::progress::{Obstruction, Patience};
use super::settings::{ActiveSet, Globalisation};
use crate::algebra::{Contact, Inequality, PenalisedMatrix, Start, any_part};
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::interior_point::{CentralPoint, Identification, InteriorPoint, MAX_STEPS};
use crate::inequality::monotone_multigrid::{MonotoneMultigrid, STAGNATION_CYCLES};
use crate::inequality::validation::{check_definite, check_input};
use crate::inequality::{Outcome, Solution, Stage, StageRun};
use crate::linear::krylov::symmetric_part;
use crate::linear::precondition::unknowns_per_cell;
use crate::linear::{CoarseSpaces, LinearMethod, PreconditionedSystem, PreconditionerFamily};
use crate::real::Real;

/// Number of unknowns from which the first stage runs by default, given nested meshes.
///
/// Solves of radial-2d with factors take 1.2 to 2.6 times as long as with Krylov methods at 300 to 6 000
/// unknowns of P1, Crouzeix-Raviart, SIPG and WOPSIP, and 1.8 to 4.4 times at 12 000 to 98 000
/// (`compare --scene radial-2d --scheme p1,cr,sipg,wopsip --levels 16,32,64,128 --threads 1 --repeat 3`,
/// with `--linear direct` and `iterative`). Below the threshold both take less than 0.03 s, and factors
/// are accurate to rounding.
pub(crate) const CROSSOVER: usize = 10_000;

/// The cost of a step with factors divided by that of a step with a preconditioned Krylov method: 2.4 to
/// 4.4 in the runs of [`CROSSOVER`] from 12 000 unknowns on, 5.6 for SIPG in space at 12 000.
const DIRECT_STEP_COST: usize = 4;

/// Relative tolerance of accurate solutions by Krylov methods, divided by the limit of the certificate.
const TOLERANCE_TO_LIMIT: f64 = 0.1;

/// Largest number of inequalities near unknowns that change their states that are solved in place of a
/// later stage. One suffices for WOPSIP with bounds at vertices in space.
const LOCAL_SOLVES: usize = 3;

/// Number of basis functions of linear functions on a tetrahedron.
const MAX_LINEAR_BASIS: usize = 4;

/// The stages in their order.
const STRATEGY: [Stage; 7] = [
    Stage::PreconditionedActiveSet,
    Stage::MonotoneMultigrid,
    Stage::DirectActiveSet,
    Stage::InteriorPoint,
    Stage::DirectActiveSet,
    Stage::InteriorPoint,
    Stage::DirectActiveSet,
];

/// A solve by the stages.
struct Solve<'s, 'a, T: Real> {
    settings: &'s ActiveSet,
    inequality: &'a Inequality<T>,
    guess: &'s InitialGuess<T>,
    family: &'s dyn PreconditionerFamily<T>,
    iterate: Iterate<'a, T>,
    /// Cycles of monotone multigrid so far. They are no linear systems, whose number is limited.
    cycles: usize,
    /// The solver with factors; `None` before the first stage that needs it.
    direct: Option<DirectSolver<'a, T>>,
    /// The stages that ran.
    stages: Vec<StageRun>,
    /// How the last stage ended; `None` before the first one.
    end: Option<End>,
    /// Whether another run of the interior point method may find a better active set: before the first
    /// run, and after one that identified the active set before the limit of rounding.
    interior_point_may_improve: bool,
    /// Whether there may be slacks that only the second run of the interior point method resolves.
    has_small_slacks: bool,
    /// Where the first run of the interior point method ended, if the second one may go on from there.
    central_point: Option<CentralPoint>,
}

/// What the last stage of a solve found, in addition to the iterate.
struct Found {
    outcome: Outcome,
    /// See [`Solution::linear_solver`].
    linear_solver: &'static str,
    /// See [`Solution::algebraic_bound`].
    algebraic_bound: Option<f64>,
}

impl Found {
    /// An outcome of factors.
    fn new(outcome: Outcome) -> Self {
        Self { outcome, linear_solver: "direct", algebraic_bound: None }
    }
}

/// Solves an inequality by the stages of [`STRATEGY`].
pub(crate) fn solve<T: Real>(
    settings: &ActiveSet,
    inequality: &Inequality<T>,
    guess: &InitialGuess<T>,
    family: &dyn PreconditionerFamily<T>,
) -> Solution<T> {
    guess.steps.set(0);
    let is_preconditioned = is_preconditioned(settings, inequality, guess);
    let values = match &guess.values {
        Some(values) if is_preconditioned => values.as_slice(),
        _ => &[],
    };
    if let Err(outcome) = check(settings, inequality, is_preconditioned) {
        return Solution::without_iterate(inequality, outcome);
    }
    let mut solve = Solve {
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
        central_point: None,
    };
    let mut found = None;
    for stage in STRATEGY {
        let applies = match stage {
            Stage::PreconditionedActiveSet => is_preconditioned,
            Stage::MonotoneMultigrid => solve.may_run_monotone_multigrid(),
            Stage::DirectActiveSet => solve.may_run_direct(),
            Stage::InteriorPoint => solve.may_run_interior_point(),
        };
        if applies && found.is_none() {
            found = solve.run(stage);
        }
    }
    if found.is_none() && solve.may_continue_direct() {
        found = solve.run(Stage::DirectActiveSet);
    }
    let mut found = found.unwrap_or_else(|| Found::new(solve.outcome_without_solution()));
    if found.outcome != Outcome::Converged
        && inequality.symmetric
        && inequality.distribution.is_none()
        && !inequality.matrix.is_symmetric()
    {
        found.outcome = Outcome::Malformed;
    }
    solve.into_solution(found)
}

/// Whether the first stage solves linear systems by a preconditioned Krylov method.
fn is_preconditioned<T: Real>(
    settings: &ActiveSet,
    inequality: &Inequality<T>,
    guess: &InitialGuess<T>,
) -> bool {
    match settings.linear {
        _ if inequality.distribution.is_some() => true,
        LinearMethod::Direct => false,
        LinearMethod::Iterative => true,
        LinearMethod::BySize => {
            inequality.size() >= CROSSOVER && !matches!(guess.coarse_spaces, CoarseSpaces::Unknown)
        }
    }
}

/// Checks the input, and definiteness unless it is known: where a setting requires it, and for a symmetric
/// matrix from a start in contact, where indefinite directions of active unknowns would remain unseen.
/// From a cold start the active set iteration with factors factors a symmetric matrix on all free unknowns
/// first, which is such a check itself; a Krylov method and the interior point method, where it comes first, do not.
///
/// # Errors
/// The outcome that the solver returns.
fn check<T: Real>(
    settings: &ActiveSet,
    inequality: &Inequality<T>,
    is_preconditioned: bool,
) -> Result<(), Outcome> {
    agree(inequality, check_input(inequality))?;
    if inequality.distribution.is_some() {
        // there are no factors of a distributed matrix; Krylov methods notice directions that are not positive
        return Ok(());
    }
    let is_cold = inequality.start == Start::Cold;
    let is_required = match inequality.symmetric {
        true => {
            let is_factored =
                !is_preconditioned && settings.globalisation != Globalisation::InteriorPointFirst;
            !is_cold || (settings.check_definite && !is_factored)
        }
        false => settings.check_definite,
    };
    if is_required && !inequality.is_definite { check_definite(inequality) } else { Ok(()) }
}

/// The result of a check in all parts: that of this part, or the outcome of another part if this one has none.
fn agree<T: Real>(inequality: &Inequality<T>, checked: Result<(), Outcome>) -> Result<(), Outcome> {
    const OUTCOMES: [Outcome; 4] =
        [Outcome::OutOfRange, Outcome::Infeasible, Outcome::NotFinite, Outcome::Malformed];
    let Some(distribution) = inequality.distribution() else { return checked };
    let code = |outcome: Outcome| OUTCOMES.iter().position(|&other| other == outcome);
    let mut largest = [checked.err().map_or(0, |outcome| code(outcome).unwrap_or(0) + 1) as f64];
    distribution.largest(&mut largest);
    match largest[0] as usize {
        0 if largest[0] == 0.0 => Ok(()),
        0 => Err(Outcome::NotFinite),
        code => Err(OUTCOMES[code - 1]),
    }
}

impl<'a, T: Real> Solve<'_, 'a, T> {
    /// Whether monotone multigrid takes over: from a stagnating active set, if it suits the inequality and the
    /// settings leave the choice.
    fn may_run_monotone_multigrid(&self) -> bool {
        matches!(self.end, Some(End::Obstruction(_)))
            && self.settings.globalisation == Globalisation::OnStagnation
            && self.suits_monotone_multigrid()
    }

    /// Whether monotone multigrid suits the inequality: its matrix is symmetric, coarse spaces are known, and
    /// sweeps by unknowns see what a penalty couples, because each jump of the penalty is that of one unknown. Where a
    /// jump is that of a mean of vertex values, sweeps change hardly any single vertex value.
    fn suits_monotone_multigrid(&self) -> bool {
        let Inequality { distribution, symmetric, penalised, .. } = self.inequality;
        distribution.is_none()
            && *symmetric
            && !matches!(self.guess.coarse_spaces, CoarseSpaces::Unknown)
            && penalised.as_ref().is_none_or(PenalisedMatrix::has_jumps_of_single_unknowns)
    }

    /// Whether cells own more unknowns than linear functions on a tetrahedron have: broken quadratics in the plane and
    /// in space.
    fn has_more_unknowns_than_linears(&self) -> bool {
        unknowns_per_cell(&self.inequality.supports).is_some_and(|n| n > MAX_LINEAR_BASIS)
    }

    /// Whether an active set iteration with factors comes next: not where the interior point method
    /// comes first, and after an interior point method only where one ran.
    fn may_run_direct(&self) -> bool {
        let interior_point_runs = self.runs_of(Stage::InteriorPoint);
        let direct_runs = self.runs_of(Stage::DirectActiveSet);
        match self.settings.globalisation {
            _ if self.inequality.distribution.is_some() => false,
            Globalisation::InteriorPointFirst => interior_point_runs > direct_runs,
            _ => interior_point_runs == direct_runs,
        }
    }

    /// Whether an active set iteration with factors goes on from its stagnation: its number of steps was limited in
    /// favour of an interior point method for which the limit of linear systems leaves no room.
    fn may_continue_direct(&self) -> bool {
        self.end == Some(End::Obstruction(Obstruction::Stagnation))
            && self.settings.globalisation != Globalisation::Never
            && self.inequality.distribution.is_none()
            && self.runs_of(Stage::DirectActiveSet) > 0
            && !self.may_run_interior_point()
            && self.iterate.outer < self.settings.max_outer
    }

    /// The outcome where no stage found a solution.
    fn outcome_without_solution(&self) -> Outcome {
        match self.end {
            // there are no factors of a distributed matrix
            Some(End::Unsuitable) if self.inequality.distribution.is_some() => Outcome::Stalled,
            _ => Outcome::Cycling,
        }
    }

    /// The number of finished runs of a stage.
    fn runs_of(&self, stage: Stage) -> usize {
        self.stages.iter().filter(|run| run.stage == stage).count()
    }

    /// Whether the interior point method comes next: where it comes first whatever the limit of systems,
    /// else only if the limit leaves room for all its steps.
    fn may_run_interior_point(&self) -> bool {
        match self.settings.globalisation {
            _ if self.inequality.distribution.is_some() => false,
            Globalisation::Never => false,
            Globalisation::InteriorPointFirst if self.runs_of(Stage::InteriorPoint) == 0 => true,
            _ => {
                self.interior_point_may_improve
                    && self.iterate.outer + MAX_STEPS <= self.settings.max_outer
            }
        }
    }

    /// Runs a stage. Returns what it found if the solve ends with it; else stores how it ended.
    fn run(&mut self, stage: Stage) -> Option<Found> {
        let (outer, linear) = (self.iterate.outer + self.cycles, self.iterate.linear);
        let mut found = None;
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
            Stage::InteriorPoint => self.run_interior_point(),
        }
        let outer = self.iterate.outer + self.cycles - outer;
        let linear = self.iterate.linear - linear;
        self.stages.push(StageRun { stage, outer, linear });
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
        let least = TOLERANCE_TO_LIMIT * T::CERTIFICATE_LIMIT;
        let tolerance = guess.energy_tolerance.unwrap_or(0.0).max(least);
        let mut solver = PreconditionedSolver::new(inequality, &matrix, preconditioner, tolerance);
        let patience = self.patience(Stage::PreconditionedActiveSet);
        let is_local = self.settings.globalisation == Globalisation::OnStagnation
            && inequality.distribution.is_none()
            && !self.suits_monotone_multigrid();
        let mut iteration = Iteration {
            settings: self.settings,
            iterate: &mut self.iterate,
            solver: &mut solver,
            patience,
            local_solves: if is_local { LOCAL_SOLVES } else { 0 },
            is_certified: guess.energy_tolerance.is_none(),
            steps: &guess.steps,
        };
        let mut outcome = match iteration.run() {
            End::Outcome(outcome) => outcome,
            end => return Err(end),
        };
        let mut algebraic_bound = None;
        if outcome == Outcome::Converged && !inequality.symmetric {
            outcome =
                match solver.estimate_smallest_eigenvalue(&mut self.iterate).map_err(End::from) {
                    Ok(()) => outcome,
                    Err(End::Outcome(failure)) => failure,
                    Err(end) => return Err(end),
                };
        }
        if outcome == Outcome::Converged {
            let values = self.iterate.values.clone();
            let jump_multipliers = self.iterate.jump_multipliers.clone();
            match solver.error_bound(&mut self.iterate) {
                Ok(bound) => algebraic_bound = bound,
                Err(failure) => outcome = failure,
            }
            // the bound is that of values on their bounds, and large penalties see each step there
            let limit = match guess.energy_tolerance {
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
            if guess.energy_tolerance.is_none()
                && algebraic_bound.is_some_and(|b| b.is_nan() || b > T::ALGEBRAIC_BOUND_LIMIT)
            {
                return Err(End::Unsuitable);
            }
        }
        Ok(Found { outcome, linear_solver, algebraic_bound })
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
            .descend(self.inequality, &guess);
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

    /// Replaces the iterate by the result of the interior point method, which starts from the best
    /// iterate, or goes on where its first run left small slacks. If it finds no active set, only the number of
    /// linear systems changes.
    fn run_interior_point(&mut self) {
        let identification = match self.runs_of(Stage::InteriorPoint) {
            0 => Identification::Early,
            _ => Identification::Final,
        };
        let refinements = self.settings.refinements;
        let new = || DirectSolver::new(self.inequality, refinements);
        let condensation = self.direct.get_or_insert_with(new).condensation();
        let start = self.iterate.best_values();
        let mut method = match self.central_point.take() {
            Some(point) => InteriorPoint::resumed(self.inequality, condensation, point),
            None => InteriorPoint::new(self.inequality, condensation, start, identification),
        };
        let contact = method.run();
        let (values, jump_multipliers, steps) =
            (method.values(), method.jump_multipliers(), method.steps);
        self.interior_point_may_improve = method.may_improve();
        self.has_small_slacks = method.leaves_small_slacks();
        self.iterate.outer += steps;
        self.guess.steps.advance(steps);
        if let Some(contact) = contact {
            let states = contact.iter().zip(&self.inequality.bounds);
            let states = states.map(|(&contact, bound)| admissible_state(bound, contact)).collect();
            self.iterate.replace(values, jump_multipliers, states);
        }
        self.central_point = method.into_central_point();
    }

    /// The numbers of steps within which a stage must progress.
    ///
    /// From a cold start the number of state changes of a preconditioned stage need not halve: the
    /// active set then grows layer by layer, in many steps that are cheap. From another start more of
    /// its steps may pass than with factors, unless the stage that follows is cheap too: monotone
    /// multigrid, or static condensation, which halves the number of unknowns. Active sets of broken quadratics
    /// settle late, and take less time than cycles of monotone multigrid all the same. An active set that
    /// stagnated there leads to the interior point method after one step with factors, unless monotone multigrid, which
    /// follows a short stagnation, ran in between. After an
    /// interior point method two steps suffice to tell that the active set was identified too early; where that did
    /// not resolve small slacks, few states are wrong, and each step corrects some.
    fn patience(&self, stage: Stage) -> Patience {
        let ActiveSet { stagnation_steps, improvement_steps, globalisation, .. } = *self.settings;
        if stage == Stage::PreconditionedActiveSet {
            let is_cheap = self.inequality.penalised.is_some()
                || (self.suits_monotone_multigrid() && !self.has_more_unknowns_than_linears());
            let steps = stagnation_steps * if is_cheap { 1 } else { DIRECT_STEP_COST } + 1;
            let is_limited = globalisation == Globalisation::OnStagnation
                && self.inequality.distribution.is_none()
                && self.inequality.start != Start::Cold;
            return Patience {
                halving: is_limited.then_some(steps),
                improvement: improvement_steps,
            };
        }
        if !self.may_run_interior_point() {
            return Patience { halving: None, improvement: usize::MAX };
        }
        let halving = match (self.runs_of(Stage::InteriorPoint), self.end) {
            (0, Some(End::Obstruction(Obstruction::Stagnation))) if self.cycles == 0 => 0,
            (0, _) => stagnation_steps,
            _ if self.has_small_slacks => stagnation_steps,
            _ => 1,
        };
        Patience { halving: Some(halving), improvement: improvement_steps }
    }

    /// The solution: the iterate if it converged, else the best one.
    fn into_solution(mut self, found: Found) -> Solution<T> {
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
