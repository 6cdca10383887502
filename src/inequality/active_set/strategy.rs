//! The stages of the active set method, in their order, with all thresholds.
//!
//! 1. *Active set, preconditioned.* Runs if coarse spaces are known and the problem has at least [`CROSSOVER`]
//!    unknowns, or if the settings require it. The next stage follows if the active set stagnates or cycles, or if the
//!    preconditioner does not fit.
//! 2. *Monotone multigrid.* Runs if the active set of the first stage stagnated or cycled, the matrix is symmetric,
//!    coarse spaces are known, and no penalty acts on jumps of means of several unknowns. The next stage follows if the
//!    cycles stagnate or reach their limit.
//! 3. *Active set, direct.* Runs if no solution is known. The next stage follows if the active set stagnates or cycles.
//! 4. *Interior point.* Runs if the active set of the third stage stagnated or cycled, and the limit `max_outer` of
//!    linear systems leaves room for all steps, or in place of the third stage if the settings require it. It never
//!    ends the solve, but provides the next starting active set.
//!
//! The third and the fourth stage alternate: the interior point method identifies the active set early, and in its
//! second run at its final accuracy. The active set iteration after the second run has no limit but `max_outer`; nor
//! has one that continues after a stagnation because `max_outer` leaves no room for the interior point method. Such an
//! iteration also ends after `improvement_steps` systems without a better iterate, if the best iterate satisfies its
//! bounds to rounding and the other conditions within the limit of the certificate and to the rounding that a large
//! penalty amplifies. The best iterate may consist of the values of the interior point method.
//!
//! For an inequality that is distributed over the parts of a mesh only the first stage runs.
//!
//! Thresholds within a stage are defined with the stage: the numbers of steps without progress in [`ActiveSet`],
//! `PATIENCE` in `solve/stage_runs`, `MAX_STEPS` in `interior_point`. `solve/stage_runs` runs a
//! stage.

use super::iteration::End;
use super::progress::{Obstruction, ProgressLimits};
use super::settings::{ActiveSet, Globalisation};
use super::solve::state::Solve;
use crate::algebra::{Inequality, PenalisedMatrix, Start};
use crate::inequality::Stage;
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::interior_point::MAX_STEPS;
use crate::linear::precondition::unknowns_per_cell;
use crate::linear::{CoarseSpaces, LinearMethod};
use crate::real::Real;

/// Number of unknowns from which the first stage runs by default if coarse spaces are known.
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

/// That tolerance for broken quadratics, divided by the tolerance for linear functions: the L2 error of quadratics
/// falls by eight with each refinement. On biactive-half-2d, where gap and multiplier vanish together in half of the
/// domain, the algebraic error of `sipg-p2:midpoints` at 128 falls from 1e-3 of the L2 error to 3e-6
/// (`algebraic_errors` in docs/solvers.md). Solves of `sipg-p2` on radial-2d and signorini-2d at 128 take 1.1 times as
/// long.
const QUADRATIC_TO_LINEAR: f64 = 0.1;

/// Least tolerance for broken quadratics, divided by machine epsilon, unless that for linear functions is smaller.
const LEAST_TOLERANCE: f64 = 100.0;

/// Largest number of local inequalities, near unknowns whose states change, that the first stage solves before a later
/// stage follows. One suffices for WOPSIP with bounds at vertices in space.
const MAX_LOCAL_SOLVES: usize = 3;

/// Dimension of the space of linear functions on a tetrahedron.
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
    /// Whether a stage runs, given the stages before it.
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

    /// Whether monotone multigrid runs: after an active set that stagnates or cycles, if monotone multigrid suits the
    /// inequality and the settings have [`Globalisation::OnStagnation`].
    fn may_run_monotone_multigrid(&self) -> bool {
        matches!(self.end, Some(End::Obstruction(_)))
            && self.settings.globalisation == Globalisation::OnStagnation
            && self.suits_monotone_multigrid()
    }

    /// Whether monotone multigrid suits the inequality: the matrix is symmetric, coarse spaces are known, and each jump
    /// of the penalty is that of a single unknown. If a large penalty acts on jumps of means of several vertex values,
    /// Gauss-Seidel sweeps hardly change any single vertex value.
    fn suits_monotone_multigrid(&self) -> bool {
        let Inequality { distribution, symmetric, penalised, .. } = self.inequality;
        distribution.is_none()
            && *symmetric
            && !matches!(self.guess.coarse_spaces, CoarseSpaces::Unknown)
            && penalised.as_ref().is_none_or(PenalisedMatrix::has_jumps_of_single_unknowns)
    }

    /// Whether each cell owns more unknowns than linear functions on a tetrahedron have: broken quadratics in the plane
    /// and in space.
    fn has_more_unknowns_than_linears(&self) -> bool {
        unknowns_per_cell(&self.inequality.supports).is_some_and(|n| n > MAX_LINEAR_BASIS)
    }

    /// Whether an active set iteration with factors runs: once after each run of the interior point method and, unless
    /// the interior point method comes first, once before.
    fn may_run_direct(&self) -> bool {
        let interior_point_runs = self.runs_of(Stage::InteriorPoint);
        let direct_runs = self.runs_of(Stage::DirectActiveSet);
        match self.settings.globalisation {
            _ if self.inequality.distribution.is_some() => false,
            Globalisation::InteriorPointFirst => interior_point_runs > direct_runs,
            _ => interior_point_runs == direct_runs,
        }
    }

    /// Whether an active set iteration with factors continues after its stagnation: its number of steps was limited so
    /// that the interior point method could follow, but the limit of linear systems leaves no room for that method.
    pub(super) fn may_continue_direct(&self) -> bool {
        self.end == Some(End::Obstruction(Obstruction::Stagnation))
            && self.settings.globalisation != Globalisation::Never
            && self.inequality.distribution.is_none()
            && self.runs_of(Stage::DirectActiveSet) > 0
            && !self.may_run_interior_point()
            && self.iterate.outer < self.settings.max_outer
    }

    /// Whether the interior point method runs: without regard to the limit of linear systems if it comes first, else
    /// only if it may improve the active set and the limit leaves room for all its steps.
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

    /// The relative tolerance of accurate solutions by Krylov methods; that of the initial guess if it is larger.
    pub(super) fn krylov_tolerance(&self) -> f64 {
        let tolerance = TOLERANCE_TO_LIMIT * T::CERTIFICATE_LIMIT;
        let least = match self.has_more_unknowns_than_linears() {
            true => {
                (QUADRATIC_TO_LINEAR * tolerance).max(LEAST_TOLERANCE * T::EPSILON).min(tolerance)
            }
            false => tolerance,
        };
        self.guess.energy_tolerance.unwrap_or(0.0).max(least)
    }

    /// The largest number of local inequalities, near unknowns whose states change, that the first stage solves: zero
    /// if monotone multigrid may follow.
    pub(super) fn local_solves(&self) -> usize {
        let is_local = self.settings.globalisation == Globalisation::OnStagnation
            && self.inequality.distribution.is_none()
            && !self.suits_monotone_multigrid();
        if is_local { MAX_LOCAL_SOLVES } else { 0 }
    }

    /// The numbers of steps within which an active set iteration must progress.
    ///
    /// * Preconditioned, from a cold start: the number of state changes need not halve, because the active set grows
    ///   layer by layer, in many steps that are cheap.
    /// * Preconditioned, from another start: more steps without progress are admitted than with factors, unless the
    ///   stage that follows is cheap too: monotone multigrid, or static condensation, which halves the number of
    ///   unknowns. Broken quadratics need many steps, which nevertheless take less time than cycles of monotone
    ///   multigrid.
    /// * With factors, after a stagnation of the preconditioned stage: one step, then the interior point method; but
    ///   the number of steps of the settings if monotone multigrid, which follows a short stagnation, ran in between.
    /// * With factors, after an interior point method: two steps, because no progress in two steps shows that the
    ///   active set was identified too early. If that method did not resolve small slacks, the number of steps of the
    ///   settings: few states are wrong, and each step corrects some.
    pub(super) fn progress_limits(&self, stage: Stage) -> ProgressLimits {
        let ActiveSet { stagnation_steps, improvement_steps, globalisation, .. } = *self.settings;
        if stage == Stage::PreconditionedActiveSet {
            let is_cheap = self.inequality.penalised.is_some()
                || (self.suits_monotone_multigrid() && !self.has_more_unknowns_than_linears());
            let steps = stagnation_steps * if is_cheap { 1 } else { DIRECT_STEP_COST } + 1;
            let is_limited = globalisation == Globalisation::OnStagnation
                && self.inequality.distribution.is_none()
                && self.inequality.start != Start::Cold;
            return ProgressLimits {
                halving: is_limited.then_some(steps),
                improvement: improvement_steps,
            };
        }
        if !self.may_run_interior_point() {
            return ProgressLimits::UNLIMITED;
        }
        let halving = match (self.runs_of(Stage::InteriorPoint), self.end) {
            (0, Some(End::Obstruction(Obstruction::Stagnation))) if self.cycles == 0 => 0,
            (0, _) => stagnation_steps,
            _ if self.has_small_slacks => stagnation_steps,
            _ => 1,
        };
        ProgressLimits { halving: Some(halving), improvement: improvement_steps }
    }
}
