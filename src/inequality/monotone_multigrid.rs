//! Truncated nonsmooth Newton multigrid: a descent method that does not depend on strict
//! complementarity.

use super::certificate::{contact_of, positive_diagonal};
use super::initial_guess::InitialGuess;
use super::preconditioned_error_bound::preconditioned_error_bound;
use super::recession::solve_with_kernel;
use super::scales::Scales;
use super::validation::{check_input, outcome_of_not_positive};
use super::violations::certify;
use super::{ActiveSet, InequalitySolver, Outcome, Solution};
use crate::algebra::Inequality;
use crate::instances::compiled;
use crate::linear::direct::FactorError;
use crate::linear::precondition::CoarseLevel;
use crate::linear::{
    BuiltInPreconditioners, CoarseSpaces, PreconditionedSystem, Preconditioner,
    PreconditionerFamily,
};
use crate::real::Real;

/// The factor of the tolerance after a solution whose bound on the algebraic error is too large.
const REDUCTION: f64 = 0.1;

/// Cycles that may pass without halving the change of a cycle before the certificate and the bound on the error decide
/// in place of the tolerance: changes below rounding do not fall.
pub(super) const STAGNATION_CYCLES: usize = 10;

/// The truncated nonsmooth Newton multigrid method (Graeser, Kornhuber, J. Comput. Math. 27 (2009)
/// 1-44; Graeser, Sack, Sander, Domain Decomposition Methods XVIII (2009) 129-136) for matrices
/// that are symmetric and positive definite.
///
/// One cycle consists of sweeps of projected Gauss-Seidel, a V-cycle for a correction of the inactive
/// unknowns, and an exact line search along the correction projected onto the bounds. In exact arithmetic the energy never
/// rises, and the method converges from any start because the sweeps alone do (Glowinski 1984). Coarse
/// functions are truncated at the active unknowns. Neither sweeps nor corrections depend on
/// strict complementarity, and from a close start the number of cycles hardly depends on the mesh.
///
/// The V-cycle is the preconditioner of [`BuiltInPreconditioners`] for the coarse spaces of the
/// [`InitialGuess`], or follows from the matrix by aggregation, which suits conforming P1. The method converges
/// slowly for other matrices without coarse spaces, and for over-penalty with bounds at vertices: where a large
/// penalty couples means of several unknowns, a sweep changes hardly any single unknown.
/// Matrices that are not symmetric, and those of one part of a mesh, are solved by [`ActiveSet`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MonotoneMultigrid {
    /// Largest number of cycles.
    pub max_cycles: usize,
    /// Number of consecutive cycles that may leave the change of a cycle above half of its least value; the method gives
    /// up at the next such cycle. Changes that ten cycles do not halve need more than three hundred cycles to the default tolerance.
    pub stagnation_cycles: usize,
    /// Sweeps of projected Gauss-Seidel before each linear correction.
    pub sweeps: usize,
    /// Tolerance on the energy norm of the changes of a cycle divided by the energy norm of the
    /// iterate; four times machine epsilon if that is larger.
    pub tolerance: f64,
}

impl Default for MonotoneMultigrid {
    fn default() -> Self {
        Self { max_cycles: 200, stagnation_cycles: 200, sweeps: 2, tolerance: 1e-10 }
    }
}

/// Setters, one for each field.
impl MonotoneMultigrid {
    /// Sets the largest number of cycles.
    #[must_use]
    pub fn max_cycles(mut self, max_cycles: usize) -> Self {
        self.max_cycles = max_cycles;
        self
    }
    /// Sets the number of cycles that may pass without halving the change of a cycle.
    #[must_use]
    pub fn stagnation_cycles(mut self, stagnation_cycles: usize) -> Self {
        self.stagnation_cycles = stagnation_cycles;
        self
    }
    /// Sets the number of sweeps before each linear correction.
    #[must_use]
    pub fn sweeps(mut self, sweeps: usize) -> Self {
        self.sweeps = sweeps;
        self
    }
    /// Sets the tolerance on the relative energy norm of the changes of a cycle.
    #[must_use]
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }
}

impl<T: Real> InequalitySolver<T> for MonotoneMultigrid {
    fn name(&self) -> &'static str {
        "monotone-multigrid"
    }

    fn solve(&self, inequality: &Inequality<T>) -> Solution<T> {
        self.solve_from(inequality, &InitialGuess::default())
    }

    fn solve_from(&self, inequality: &Inequality<T>, guess: &InitialGuess<T>) -> Solution<T> {
        compiled!(
            T: fn(&MonotoneMultigrid, &Inequality<T>, &InitialGuess<T>) -> Solution<T>
                = |method, inequality, guess| solve_with_kernel(inequality, |inequality| {
                    guess.steps.set(0);
                    method.descend(inequality, guess)
                })
        )(self, inequality, guess)
    }

    fn uses_coarse_spaces(&self, _unknowns: usize) -> bool {
        true
    }
}

impl MonotoneMultigrid {
    /// The solution by cycles, which the counter of the guess adds to the steps of preceding stages.
    pub(super) fn descend<T: Real>(
        &self,
        inequality: &Inequality<T>,
        guess: &InitialGuess<T>,
    ) -> Solution<T> {
        if !inequality.symmetric || inequality.distribution.is_some() {
            return ActiveSet::default().solve_from(inequality, guess);
        }
        if let Err(outcome) = check_input(inequality) {
            return Solution::without_iterate(inequality, outcome);
        }
        let mut iterate = MultigridIterate::new(inequality, guess);
        let outcome = iterate.run(self, guess).unwrap_or_else(|outcome| outcome);
        iterate.into_solution(outcome)
    }
}

/// The preconditioner for the coarse spaces `known` if one fits, else for spaces by aggregation, which are stored
/// in `aggregated`.
fn preconditioner<'a, T: Real>(
    inequality: &'a Inequality<T>,
    known: &'a CoarseSpaces<T>,
    aggregated: &'a mut CoarseSpaces<T>,
) -> Option<Box<dyn Preconditioner<T> + 'a>> {
    let Inequality { matrix, bounds, .. } = inequality;
    let of = |spaces| {
        BuiltInPreconditioners.preconditioner(PreconditionedSystem::new(matrix, inequality, spaces))
    };
    if known.fits(inequality)
        && let Some(preconditioner) = of(known)
    {
        return Some(preconditioner);
    }
    let fixed: Vec<bool> = bounds.iter().map(|bound| bound.fixed_value().is_some()).collect();
    if let Some(level) = CoarseLevel::aggregated(matrix, &fixed) {
        *aggregated = CoarseSpaces::CoarseLevel(level);
    }
    of(aggregated)
}

/// Admissible values, and the vectors of a cycle.
struct MultigridIterate<'a, T> {
    inequality: &'a Inequality<T>,
    values: Vec<T>,
    /// `b - A u`; zero on eliminated unknowns.
    residual: Vec<T>,
    /// The linear correction of the values.
    correction: Vec<T>,
    /// Whether an unknown is fixed or active and takes no part in the linear correction.
    eliminated: Vec<bool>,
    /// The eliminated unknowns for which the preconditioner is set up; empty before it is.
    fixed: Vec<bool>,
    /// The name of the preconditioner, in reports.
    linear_solver: &'static str,
    /// The diagonal of the matrix.
    diagonal: Vec<T>,
    /// `b - A u` on all unknowns.
    whole_residual: Vec<f64>,
    /// The energy norm of the values before the last correction; see [`Scales::energy_norm`].
    energy_norm: f64,
    cycles: usize,
    /// Whether the matrix is known to be positive definite, also by factors after a direction that is not positive.
    is_definite: bool,
    /// See [`Solution::algebraic_bound`].
    algebraic_bound: Option<f64>,
}

impl<'a, T: Real> MultigridIterate<'a, T> {
    /// The values of the guess, or zero, projected onto the bounds.
    fn new(inequality: &'a Inequality<T>, guess: &InitialGuess<T>) -> Self {
        let n = inequality.bounds.len();
        let guess = guess.values.as_deref().filter(|values| values.len() == n);
        let start = |i: usize| guess.map_or(T::lit(0.0), |values| values[i]);
        let bounds = inequality.bounds.iter().enumerate();
        let values = bounds.map(|(i, bound)| bound.nearest(start(i))).collect();
        let zeros = vec![T::lit(0.0); n];
        Self {
            inequality,
            values,
            residual: zeros.clone(),
            correction: zeros,
            eliminated: vec![false; n],
            fixed: Vec::new(),
            linear_solver: "multigrid",
            diagonal: Vec::new(),
            whole_residual: vec![0.0; n],
            energy_norm: 0.0,
            cycles: 0,
            is_definite: inequality.is_definite,
            algebraic_bound: None,
        }
    }

    /// Cycles until the changes are within the tolerance, and the certificate and the bound on the algebraic error are
    /// within their limits. A missing bound does not prevent convergence. Cycles that stagnate converge too, if the
    /// bound is known and both limits hold. Neither limit applies if the guess sets a tolerance.
    ///
    /// # Errors
    /// The outcome if the method does not converge.
    fn run(
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
            self.cycles += 1;
            guess.steps.advance(1);
            // a bound is that of the values for which it was computed
            self.algebraic_bound = None;
            let mut by_sweeps = 0.0;
            for _ in 0..settings.sweeps {
                by_sweeps += self.gauss_seidel_sweep()?;
            }
            let by_correction = self.correct(&mut *preconditioner)?;
            let energy_norm = self.energy_norm;
            if !(energy_norm.is_finite() && by_sweeps.is_finite()) {
                return Err(Outcome::NotFinite);
            }
            let change = (by_sweeps + by_correction).sqrt();
            let has_halved = change > 0.0 && change <= 0.5 * least_change;
            stagnant_cycles = if has_halved { 0 } else { stagnant_cycles + 1 };
            least_change = if stagnant_cycles == 0 { change } else { least_change };
            // the certificate of a start for another solve is not examined
            let stagnates = guess.energy_tolerance.is_none()
                && stagnant_cycles > 0
                && stagnant_cycles % STAGNATION_CYCLES == 0;
            let is_small = tolerance.is_some_and(|tolerance| change <= tolerance * energy_norm);
            if (is_small || stagnates) && certify(self.inequality, &self.values).largest() <= limit
            {
                if guess.energy_tolerance.is_some()
                    || self.has_small_bound(&mut *preconditioner)?.unwrap_or(is_small)
                {
                    return Ok(Outcome::Converged);
                }
                // of cycles that converge slowly the error is much larger than a change
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

    /// Computes the bound on the algebraic error. Returns whether the bound is within its limit; `None` if there is no
    /// bound.
    ///
    /// # Errors
    /// [`Outcome::NotCoercive`], which unknowns in contact hide from the cycles, or the reason why there are no factors.
    fn has_small_bound(
        &mut self,
        preconditioner: &mut dyn Preconditioner<T>,
    ) -> Result<Option<bool>, Outcome> {
        self.fixed.clear();
        self.algebraic_bound =
            preconditioned_error_bound(self.inequality, &self.values, preconditioner)?;
        Ok(self.algebraic_bound.map(|bound| bound <= T::ALGEBRAIC_BOUND_LIMIT))
    }

    /// One sweep of projected Gauss-Seidel. Returns the sum of `d_i (change of u_i)^2`, an estimate
    /// of the square of the energy norm of the change.
    ///
    /// # Errors
    /// [`Outcome::NotCoercive`] for a diagonal entry that is not positive.
    fn gauss_seidel_sweep(&mut self) -> Result<f64, Outcome> {
        let Inequality { matrix, load, bounds, .. } = self.inequality;
        let mut sum = 0.0;
        for (i, (bound, &d)) in bounds.iter().zip(&self.diagonal).enumerate() {
            if bound.fixed_value().is_some() {
                continue;
            }
            if d <= T::lit(0.0) {
                return Err(Outcome::NotCoercive);
            }
            let residual = load[i] - matrix.row_dot(i, &self.values);
            let next = bound.nearest(self.values[i] + residual / d);
            let change = (next - self.values[i]).to_f64();
            sum += d.to_f64() * change * change;
            self.values[i] = next;
        }
        Ok(sum)
    }

    /// One linear correction of the inactive unknowns with exact line search. Returns the square of
    /// the energy norm of the change; zero if nothing changes, because the coarsest matrix is
    /// singular or the projected correction is no direction of descent.
    ///
    /// # Errors
    /// The outcome if the matrix is not positive definite or has no factors for another reason.
    fn correct(&mut self, preconditioner: &mut dyn Preconditioner<T>) -> Result<f64, Outcome> {
        let Inequality { matrix, bounds, .. } = self.inequality;
        self.eliminate_active();
        if self.eliminated != self.fixed {
            self.fixed.clear();
            match preconditioner.set_fixed(&self.eliminated) {
                Ok(()) => self.fixed.extend_from_slice(&self.eliminated),
                // only the bounds prevent a rigid motion; the sweeps converge without the correction
                Err(FactorError::Singular) if bounds.iter().any(|bound| bound.is_inequality()) => {
                    return Ok(0.0);
                }
                // a definite matrix has a negative pivot by rounding only
                Err(FactorError::NotPositive) => {
                    return self.check_definite().and(Err(Outcome::Stalled));
                }
                Err(error) => return Err(error.into()),
            }
        }
        preconditioner.apply(&self.residual, &mut self.correction);
        for (i, correction) in self.correction.iter_mut().enumerate() {
            *correction = if self.eliminated[i] {
                T::lit(0.0)
            } else {
                bounds[i].nearest(self.values[i] + *correction) - self.values[i]
            };
        }
        let (mut slope, mut curvature) = (0.0, 0.0);
        let inactive = |(i, _): &(usize, &T)| !self.eliminated[*i];
        for (i, correction) in self.correction.iter().enumerate().filter(inactive) {
            slope += self.residual[i].to_f64() * correction.to_f64();
            curvature += correction.to_f64() * matrix.row_dot_f64(i, &self.correction);
        }
        if slope <= 0.0 {
            return Ok(0.0);
        }
        if curvature <= 0.0 {
            return self.check_definite().and(Ok(0.0));
        }
        let length = T::lit((slope / curvature).min(self.ratio_test()));
        let corrections = self.correction.iter().zip(bounds);
        for (value, (correction, bound)) in self.values.iter_mut().zip(corrections) {
            *value = bound.nearest(*value + length * *correction);
        }
        Ok(curvature * length.to_f64().powi(2))
    }

    /// Decides by factors whether a direction that is not positive is one by rounding.
    ///
    /// # Errors
    /// The outcome if it is not, or if there are no factors.
    fn check_definite(&mut self) -> Result<(), Outcome> {
        if !self.is_definite {
            outcome_of_not_positive(self.inequality).map_or(Ok(()), Err)?;
            self.is_definite = true;
        }
        Ok(())
    }

    /// Marks fixed and active unknowns as eliminated and computes the energy norm of the values and the
    /// residual: zero on eliminated unknowns, `b - A u` on inactive ones.
    fn eliminate_active(&mut self) {
        let inequality = self.inequality;
        inequality.residual_f64(&self.values, &mut self.whole_residual);
        let diagonal = |i: usize| match self.diagonal[i].to_f64() {
            d if d > 0.0 => d,
            _ => positive_diagonal(inequality, i),
        };
        let residual = &self.whole_residual;
        self.energy_norm =
            Scales::of(inequality, &self.values, residual, &[], &diagonal, 1.0).energy_norm;
        for (i, bound) in inequality.bounds.iter().enumerate() {
            let x = self.values[i];
            self.eliminated[i] = bound.fixed_value().is_some()
                || bound.lower().is_some_and(|l| x <= l)
                || bound.upper().is_some_and(|u| x >= u);
            let residual = if self.eliminated[i] { 0.0 } else { self.whole_residual[i] };
            self.residual[i] = T::lit(residual);
        }
    }

    /// The ratio test: the largest multiple of the projected correction that the bounds admit, at
    /// least one; infinite if no bound limits it.
    fn ratio_test(&self) -> f64 {
        let mut longest = f64::INFINITY;
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let (x, step) = (self.values[i].to_f64(), self.correction[i].to_f64());
            match (bound.lower(), bound.upper()) {
                (Some(l), _) if step < 0.0 => longest = longest.min((l.to_f64() - x) / step),
                (_, Some(u)) if step > 0.0 => longest = longest.min((u.to_f64() - x) / step),
                _ => {}
            }
        }
        longest.max(1.0)
    }

    /// The solution, with the contact states of its values.
    fn into_solution(self, outcome: Outcome) -> Solution<T> {
        let contact = contact_of(self.inequality, &self.values);
        Solution::new(self.values, contact, outcome)
            .iterations(self.cycles, self.cycles)
            .linear_solver(self.linear_solver)
            .algebraic_bound(self.algebraic_bound)
    }
}

#[cfg(test)]
mod tests {
    use super::super::preconditioned_error_bound::tests::string;
    use super::*;
    use crate::algebra::{Bound, SparseMatrix};

    #[test]
    fn a_coarser_level_of_another_size_is_not_used() {
        let string = string(2000);
        let expected = MonotoneMultigrid::default().solve(&string);
        for other in [1500, 2500] {
            let matrix = SparseMatrix::second_differences(other);
            let level = CoarseLevel::aggregated(&matrix, &vec![false; other]).unwrap();
            let coarse_spaces = CoarseSpaces::CoarseLevel(level);
            let guess = InitialGuess { coarse_spaces, ..InitialGuess::default() };
            let found = MonotoneMultigrid::default().solve_from(&string, &guess);
            assert_eq!((found.outcome, found.values), (expected.outcome, expected.values.clone()));
        }
    }

    /// Both unknowns are in contact: no correction sees that (1, 1) is a direction of descent.
    #[test]
    fn contact_does_not_hide_an_indefinite_matrix() {
        let matrix = SparseMatrix {
            row_starts: vec![0, 2, 4],
            columns: vec![0, 1, 0, 1],
            values: vec![1.0, -2.0, -2.0, 1.0],
        };
        let bounds = vec![Bound::Lower(0.0); 2];
        let inequality = Inequality::new(matrix, true, vec![-1.0; 2], bounds);
        let solution = MonotoneMultigrid::default().solve(&inequality);
        assert_eq!(solution.outcome, Outcome::NotCoercive);
    }

    /// Second differences on `n` points without fixed ends, beside the rows `others` of two further unknowns.
    fn beside_free_string(n: usize, others: [[f64; 2]; 2]) -> Inequality<f64> {
        let mut matrix = SparseMatrix::second_differences(n);
        for end in [0, n - 1] {
            let k = (matrix.row_starts[end] as usize..matrix.row_starts[end + 1] as usize)
                .find(|&k| matrix.columns[k] as usize == end);
            matrix.values[k.unwrap()] = 1.0;
        }
        for row in others {
            matrix.columns.extend([n as u32, n as u32 + 1]);
            matrix.values.extend(row);
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        Inequality::new(matrix, true, vec![-1.0; n + 2], vec![Bound::Lower(0.0); n + 2])
    }

    /// The matrix is singular on the string, which has no bound on the error, and contact hides the others.
    #[test]
    fn a_string_that_bounds_alone_hold_does_not_hide_an_indefinite_matrix() {
        let solve = |others| MonotoneMultigrid::default().solve(&beside_free_string(1000, others));
        assert_eq!(solve([[1.0, 2.0], [2.0, 1.0]]).outcome, Outcome::NotCoercive);
        assert_eq!(solve([[2.0, 1.0], [1.0, 2.0]]).outcome, Outcome::Converged);
    }

    /// A limit of zero admits cycles until the first one that does not halve the change.
    #[test]
    fn the_limit_of_stagnating_cycles_counts_cycles_that_stagnate() {
        let string = string(2000);
        let of = |limit| MonotoneMultigrid::default().stagnation_cycles(limit).solve(&string);
        let whole = of(200);
        assert_eq!(whole.outcome, Outcome::Converged);
        let short = of(0);
        assert!(short.outer > 1 && short.outer < whole.outer, "{} {}", short.outer, whole.outer);
        assert_eq!(short.outcome, Outcome::Stalled);
    }

    #[test]
    fn the_counter_includes_the_steps_before_the_first_cycle() {
        let guess = InitialGuess::default();
        guess.steps.set(7);
        let solution = MonotoneMultigrid::default().descend(&string(200), &guess);
        assert!(solution.outer > 0);
        assert_eq!(guess.steps.get(), 7 + solution.outer);
    }
}
