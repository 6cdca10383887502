//! Cycles until the solution is found or the method does not converge.

use super::cycle::MultigridIterate;
use super::settings::MonotoneMultigrid;
use crate::algebra::{Inequality, OnePart};
use crate::inequality::algebraic_bound::{AdmissibleValues, algebraic_bound};
use crate::inequality::certificate::positive_diagonal;
use crate::inequality::certificate::scales::Scales;
use crate::inequality::certificate::violations::certify;
use crate::inequality::history::Recorder;
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::{Outcome, Solution};
use crate::linear::krylov::{EIGENVALUE_TO_RITZ_VALUE, StopReason, eigenvalue_run};
use crate::linear::precondition::CoarseLevel;
use crate::linear::{
    BuiltInPreconditioners, CoarseSpaces, PreconditionedSystem, Preconditioner,
    PreconditionerFamily,
};
use crate::parallel::vectors::{collect, dot, zeros};
use crate::real::Real;

/// Tolerance on the energy norm of the change of a cycle divided by the energy norm of the iterate; the tolerance of the
/// initial guess or four times machine epsilon if one of these is larger.
const TOLERANCE: f64 = 1e-10;

/// The factor by which the tolerance is reduced if the bound on the algebraic error is too large.
const REDUCTION: f64 = 0.1;

/// Number of cycles without halving the change of a cycle after which the certificate and the bound on the error are
/// examined although the change exceeds the tolerance: changes of the size of rounding do not decrease.
const STAGNATION_CYCLES: usize = 10;

/// Largest number of iterations of conjugate gradients for the smallest eigenvalue.
const MAX_ITERATIONS: usize = 500;

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
        recorder: &Recorder<'_>,
    ) -> Result<Outcome, Outcome> {
        let mut aggregated = CoarseSpaces::Unknown;
        let mut preconditioner =
            preconditioner(self.inequality, &guess.coarse_spaces, &mut aggregated)
                .ok_or(Outcome::Malformed)?;
        self.linear_solver = preconditioner.name();
        self.diagonal = self.inequality.matrix.diagonal();
        let least = guess.energy_tolerance.unwrap_or(0.0).max(4.0 * T::EPSILON);
        // `None` where a reduced tolerance would lie below rounding: only stagnating cycles are examined then
        let mut tolerance = Some(TOLERANCE.max(least));
        let limit =
            if guess.energy_tolerance.is_some() { f64::INFINITY } else { T::CERTIFICATE_LIMIT };
        let (mut least_change, mut stagnant_cycles) = (f64::INFINITY, 0);
        while self.cycles < settings.max_cycles {
            recorder.begin_step();
            let change = self.cycle(&mut *preconditioner)?;
            recorder.end_step(|| certify(self.inequality, &self.values).largest());
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
                    || self.has_small_bound(&mut *preconditioner).unwrap_or(is_small)
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

    /// Computes the bound on the algebraic error. Returns whether it is within its limit; `None` if there is no bound.
    fn has_small_bound(&mut self, preconditioner: &mut dyn Preconditioner<T>) -> Option<bool> {
        self.eliminated_in_preconditioner.clear();
        self.algebraic_bound = self.error_bound(preconditioner);
        self.algebraic_bound.map(|bound| bound <= T::ALGEBRAIC_BOUND_LIMIT)
    }

    /// The bound on the error of the values ([`algebraic_bound`]), without any assumption on active unknowns: with the
    /// preconditioner `B` on the unknowns that are not fixed `inv(A) <= B / lambda_min(B A)`, and the eigenvalue is
    /// estimated on the same unknowns, by [`EIGENVALUE_TO_RITZ_VALUE`] times the smallest Ritz value.
    ///
    /// `None` if the matrix is singular on these unknowns (bounds alone may hold the domain), if conjugate gradients do
    /// not converge, or if rounding makes `r . B r` negative.
    fn error_bound(&self, preconditioner: &mut dyn Preconditioner<T>) -> Option<f64> {
        let (inequality, values) = (self.inequality, &self.values[..]);
        let bounds = &inequality.bounds;
        let fixed: Vec<bool> = bounds.iter().map(|bound| bound.fixed_value().is_some()).collect();
        preconditioner.set_fixed(&fixed).ok()?;
        let diagonal = collect(values.len(), |i| positive_diagonal(inequality, i));
        let of = |i: usize| diagonal[i];
        let matrix = &inequality.matrix;
        let run = eigenvalue_run(matrix, &OnePart, preconditioner, &fixed, of, MAX_ITERATIONS);
        let (smallest, _) = run.ritz.filter(|ritz| ritz.0 > 0.0)?;
        if run.reason != StopReason::Converged {
            return None;
        }
        let mut residual = vec![0.0; values.len()];
        inequality.residual_f64(values, &mut residual);
        let energy_norm =
            Scales::of(inequality, (values, &residual, &[]), &of, T::PRECISION).energy_norm;
        let (residual, diagonal) = (&residual[..], &diagonal[..]);
        let values = AdmissibleValues { inequality, values, residual, diagonal, energy_norm };
        algebraic_bound(&values, f64::INFINITY, |_, unbalanced| {
            let mut preconditioned = zeros(unbalanced.len());
            preconditioner.apply(unbalanced, &mut preconditioned);
            let squared = dot(unbalanced, &mut preconditioned);
            let eigenvalue = EIGENVALUE_TO_RITZ_VALUE * smallest;
            Ok((squared >= 0.0).then(|| (squared / eigenvalue).sqrt()))
        })
        .unwrap_or(None)
    }

    /// The solution.
    pub(super) fn into_solution(self, outcome: Outcome) -> Solution<T> {
        Solution::of_values(self.inequality, self.values, Vec::new(), outcome)
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
