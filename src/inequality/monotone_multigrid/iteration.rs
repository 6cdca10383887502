//! Cycles until the solution is found or the method does not converge.

use super::cycle::MultigridIterate;
use super::settings::MonotoneMultigrid;
use crate::algebra::Inequality;
use crate::inequality::certificate::contact_of;
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::preconditioned_error_bound::preconditioned_error_bound;
use crate::inequality::violations::certify;
use crate::inequality::{Outcome, Solution};
use crate::linear::precondition::CoarseLevel;
use crate::linear::{
    BuiltInPreconditioners, CoarseSpaces, PreconditionedSystem, Preconditioner,
    PreconditionerFamily,
};
use crate::real::Real;

/// The factor by which the tolerance is reduced if the bound on the algebraic error is too large.
const REDUCTION: f64 = 0.1;

/// Number of cycles without halving the change of a cycle after which the certificate and the bound on the error are
/// examined although the change exceeds the tolerance: changes of the size of rounding do not decrease.
const STAGNATION_CYCLES: usize = 10;

impl<T: Real> MultigridIterate<'_, T> {
    /// Iterates until the change of a cycle is within the tolerance, and the certificate and the bound on the algebraic
    /// error are within their limits; there need not be a bound. Cycles that stagnate count as converged if there is a
    /// bound and both limits hold. Neither limit applies if the initial guess sets a tolerance.
    ///
    /// # Errors
    /// The outcome if the method does not converge.
    pub(super) fn run(
        &mut self,
        settings: &MonotoneMultigrid,
        guess: &InitialGuess<T>,
    ) -> Result<Outcome, Outcome> {
        let mut aggregated = CoarseSpaces::Unknown;
        let mut preconditioner =
            preconditioner(self.inequality, &guess.coarse_spaces, &mut aggregated)
                .ok_or(Outcome::Malformed)?;
        self.linear_solver = preconditioner.name();
        self.diagonal = self.inequality.matrix.diagonal();
        let least = guess.energy_tolerance.unwrap_or(0.0).max(4.0 * T::EPSILON);
        // `None` where a reduced tolerance would lie below rounding: only stagnating cycles are examined then
        let mut tolerance = Some(settings.tolerance.max(least));
        let limit =
            if guess.energy_tolerance.is_some() { f64::INFINITY } else { T::CERTIFICATE_LIMIT };
        let (mut least_change, mut stagnant_cycles) = (f64::INFINITY, 0);
        while self.cycles < settings.max_cycles {
            guess.steps.advance(1);
            let change = self.cycle(settings.sweeps, &mut *preconditioner)?;
            let has_halved = change > 0.0 && change <= 0.5 * least_change;
            stagnant_cycles = if has_halved { 0 } else { stagnant_cycles + 1 };
            least_change = if stagnant_cycles == 0 { change } else { least_change };
            // the certificate of a solution that is only the initial guess of another solve is not examined
            let stagnates = guess.energy_tolerance.is_none()
                && stagnant_cycles > 0
                && stagnant_cycles % STAGNATION_CYCLES == 0;
            let is_small =
                tolerance.is_some_and(|tolerance| change <= tolerance * self.energy_norm);
            if (is_small || stagnates) && certify(self.inequality, &self.values).largest() <= limit
            {
                if guess.energy_tolerance.is_some()
                    || self.has_small_bound(&mut *preconditioner)?.unwrap_or(is_small)
                {
                    return Ok(Outcome::Converged);
                }
                // if the cycles converge slowly, the error is much larger than the change of a cycle
                if is_small {
                    tolerance =
                        tolerance.map(|t| REDUCTION * t).filter(|&reduced| reduced >= least);
                }
            }
            if stagnant_cycles > settings.stagnation_cycles {
                return Err(Outcome::Stalled);
            }
        }
        Err(Outcome::IterationLimit)
    }

    /// Computes the bound on the algebraic error, with the preconditioner set up for all unknowns that are not fixed.
    /// Returns whether the bound is within its limit; `None` if there is no bound.
    ///
    /// # Errors
    /// [`Outcome::NotCoercive`] for an indefinite matrix, which the cycles do not detect if unknowns are in contact, or
    /// the reason why there are no factors.
    fn has_small_bound(
        &mut self,
        preconditioner: &mut dyn Preconditioner<T>,
    ) -> Result<Option<bool>, Outcome> {
        self.eliminated_in_preconditioner.clear();
        self.algebraic_bound =
            preconditioned_error_bound(self.inequality, &self.values, preconditioner)?;
        Ok(self.algebraic_bound.map(|bound| bound <= T::ALGEBRAIC_BOUND_LIMIT))
    }

    /// The solution, with the contact states of its values.
    pub(super) fn into_solution(self, outcome: Outcome) -> Solution<T> {
        let contact = contact_of(self.inequality, &self.values);
        Solution::new(self.values, contact, outcome)
            .iterations(self.cycles, self.cycles)
            .linear_solver(self.linear_solver)
            .algebraic_bound(self.algebraic_bound)
    }
}

/// The preconditioner for the coarse spaces `known` if they fit, else for spaces by aggregation, which are stored in
/// `aggregated`; `None` if there is neither.
fn preconditioner<'a, T: Real>(
    inequality: &'a Inequality<T>,
    known: &'a CoarseSpaces<T>,
    aggregated: &'a mut CoarseSpaces<T>,
) -> Option<Box<dyn Preconditioner<T> + 'a>> {
    let Inequality { matrix, bounds, .. } = inequality;
    let with_spaces = |spaces| {
        BuiltInPreconditioners.preconditioner(PreconditionedSystem::new(matrix, inequality, spaces))
    };
    if known.fits(inequality)
        && let Some(preconditioner) = with_spaces(known)
    {
        return Some(preconditioner);
    }
    let fixed: Vec<bool> = bounds.iter().map(|bound| bound.fixed_value().is_some()).collect();
    if let Some(level) = CoarseLevel::aggregated(matrix, &fixed) {
        *aggregated = CoarseSpaces::CoarseLevel(level);
    }
    with_spaces(aggregated)
}
