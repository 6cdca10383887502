//! The stages of the active set method, in their order, with all thresholds.
//!
//! | stage | runs if | ends without a solution if |
//! |---|---|---|
//! | active set, preconditioned | coarse spaces are known and the problem has at least [`CROSSOVER`] unknowns, or the settings ask for it | the active set stagnates or cycles, or the preconditioner does not fit |
//! | monotone multigrid | the preceding stage stagnated, the matrix is symmetric and coarse spaces are known; not for penalties on jumps of means of several unknowns | its cycles stagnate, or reach their limit |
//! | active set, direct | no solution is known | the active set stagnates or cycles |
//! | interior point | the preceding stage ended so, and the limit of linear systems leaves room | never: it provides the next starting active set |
//!
//! The direct active set and the interior point method alternate: the interior point method identifies the active set
//! early, and a second time at its final accuracy. The active set iteration that follows the second one has no limit
//! but `max_outer`; nor has one that follows a stagnation where `max_outer` leaves no room for the interior point
//! method. Such an iteration also ends where `improvement_steps` systems have found no better iterate than one that
//! satisfies its bounds to rounding, and the other conditions to the rounding that a large penalty amplifies and within
//! the limit of the certificate; the values of the interior point method may be that one.
//!
//! Of an inequality that is distributed over the parts of a mesh the first stage alone runs.
//!
//! Thresholds of a stage itself stand where it is defined: the numbers of steps without progress in [`ActiveSet`],
//! `STAGNATION_CYCLES` in `monotone_multigrid/iteration`, `MAX_STEPS` in `interior_point`. `solve/stage_runs` runs a
//! stage.

use super::iteration::End;
use super::progress::{Obstruction, Patience};
use super::settings::{ActiveSet, Globalisation};
use super::solve::state::Solve;
use crate::algebra::{Inequality, PenalisedMatrix, Start};
use crate::inequality::Stage;
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::interior_point::MAX_STEPS;
use crate::linear::precondition::unknowns_per_cell;
use crate::linear::{CoarseSpaces, LinearMethod};
use crate::real::Real;

/// Number of unknowns from which the first stage runs by default, given nested meshes.
///
/// Solves of radial-2d with factors take 1.2 to 2.6 times as long as with Krylov methods at 300 to 6 000
/// unknowns of P1, Crouzeix-Raviart, SIPG and WOPSIP, and 1.8 to 4.4 times at 12 000 to 98 000
/// (`compare --scene radial-2d --scheme p1,cr,sipg,wopsip --levels 16,32,64,128 --threads 1 --repeat 3`,
/// with `--linear direct` and `iterative`). Below the threshold both take less than 0.03 s, and factors
/// are accurate to rounding.
pub(super) const CROSSOVER: usize = 10_000;

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
pub(super) const STRATEGY: [Stage; 7] = [
    Stage::PreconditionedActiveSet,
    Stage::MonotoneMultigrid,
    Stage::DirectActiveSet,
    Stage::InteriorPoint,
    Stage::DirectActiveSet,
    Stage::InteriorPoint,
    Stage::DirectActiveSet,
];

/// Whether the first stage solves linear systems by a preconditioned Krylov method.
pub(super) fn is_preconditioned<T: Real>(
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

impl<T: Real> Solve<'_, '_, T> {
    /// Whether a stage comes next.
    pub(super) fn applies(&self, stage: Stage) -> bool {
        match stage {
            Stage::PreconditionedActiveSet => {
                is_preconditioned(self.settings, self.inequality, self.guess)
            }
            Stage::MonotoneMultigrid => self.may_run_monotone_multigrid(),
            Stage::DirectActiveSet => self.may_run_direct(),
            Stage::InteriorPoint => self.may_run_interior_point(),
        }
    }

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
    pub(super) fn may_continue_direct(&self) -> bool {
        self.end == Some(End::Obstruction(Obstruction::Stagnation))
            && self.settings.globalisation != Globalisation::Never
            && self.inequality.distribution.is_none()
            && self.runs_of(Stage::DirectActiveSet) > 0
            && !self.may_run_interior_point()
            && self.iterate.outer < self.settings.max_outer
    }

    /// Whether the interior point method comes next: where it comes first whatever the limit of systems,
    /// else only if the limit leaves room for all its steps.
    pub(super) fn may_run_interior_point(&self) -> bool {
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

    /// The relative tolerance of accurate solutions by Krylov methods: that of the guess if it is larger.
    pub(super) fn krylov_tolerance(&self) -> f64 {
        let least = TOLERANCE_TO_LIMIT * T::CERTIFICATE_LIMIT;
        self.guess.energy_tolerance.unwrap_or(0.0).max(least)
    }

    /// How many inequalities near unknowns that change their states the first stage may solve: none where monotone
    /// multigrid may follow.
    pub(super) fn local_solves(&self) -> usize {
        let is_local = self.settings.globalisation == Globalisation::OnStagnation
            && self.inequality.distribution.is_none()
            && !self.suits_monotone_multigrid();
        if is_local { LOCAL_SOLVES } else { 0 }
    }

    /// The numbers of steps within which a stage must progress.
    ///
    /// From a cold start the number of state changes of a preconditioned stage need not halve: the active set then
    /// grows layer by layer, in many steps that are cheap. From another start more of its steps may pass than with
    /// factors, unless the stage that follows is cheap too: monotone multigrid, or static condensation, which halves
    /// the number of unknowns. Active sets of broken quadratics settle late, and take less time than cycles of monotone
    /// multigrid all the same. An active set that stagnated there leads to the interior point method after one step
    /// with factors, unless monotone multigrid, which follows a short stagnation, ran in between. After an interior
    /// point method two steps suffice to tell that the active set was identified too early; where that did not resolve
    /// small slacks, few states are wrong, and each step corrects some.
    pub(super) fn patience(&self, stage: Stage) -> Patience {
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
            return Patience::UNLIMITED;
        }
        let halving = match (self.runs_of(Stage::InteriorPoint), self.end) {
            (0, Some(End::Obstruction(Obstruction::Stagnation))) if self.cycles == 0 => 0,
            (0, _) => stagnation_steps,
            _ if self.has_small_slacks => stagnation_steps,
            _ => 1,
        };
        Patience { halving: Some(halving), improvement: improvement_steps }
    }
}
