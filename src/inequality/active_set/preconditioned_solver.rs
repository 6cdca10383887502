//! Linear systems solved by a preconditioned Krylov method, without factors of the matrix.

use super::iterate::Iterate;
use super::linear_solver::{Accuracy, End, LinearSolver};
use crate::algebra::{Inequality, SparseMatrix, any_part, sum_over_parts};
use crate::inequality::Outcome;
use crate::inequality::algebraic_bound::{AdmissibleValues, algebraic_bound};
use crate::linear::Preconditioner;
use crate::linear::direct::FactorError;
use crate::linear::krylov::{
    EIGENVALUE_TO_RITZ_VALUE, KrylovMethod, KrylovRun, StopReason, StoppingRule, eigenvalue_run,
};
use crate::parallel::vectors::{collect, dot, for_each_chunk, zeros};
use crate::real::Real;

/// Estimated condition number of the preconditioned matrix (largest Ritz value divided by the smallest) above which the
/// preconditioner counts as unsuitable: the preconditioned norm of a residual is then no measure of the error.
const MAX_CONDITION: f64 = 1e4;

/// Largest number of iterations for one linear system.
const MAX_ITERATIONS: usize = 500;

/// Relative tolerance of the linear system for the jump multipliers.
const MULTIPLIER_TOLERANCE: f64 = 1e-6;

/// The factor by which the residual of an accurate solution may exceed the tolerance relative to the energy norm of the
/// solution, because the system was solved to the tolerance relative to that of the preceding iterate.
const TOLERANCE_MARGIN: f64 = 1.01;

/// The solver with a Krylov method and a preconditioner for the symmetric part of the matrix.
pub(crate) struct PreconditionedSolver<'a, T: Real> {
    inequality: &'a Inequality<T>,
    /// The symmetric part of the matrix.
    symmetric_part: &'a SparseMatrix<T>,
    preconditioner: Box<dyn Preconditioner<T> + 'a>,
    krylov: KrylovMethod<'a, T>,
    /// The fixed unknowns for which the preconditioner is set up.
    eliminated: Vec<bool>,
    /// See [`LinearSolver::tolerance`].
    tolerance: f64,
    /// Workspace: the residual that the Krylov method updates, zero on eliminated unknowns.
    residual: Vec<T>,
    /// Smallest Ritz value of all systems so far, at most one.
    smallest_ritz_value: f64,
    /// Preconditioned norm of the residual at the end of the last system.
    residual_norm: f64,
    /// Preconditioned norm of the residual at which the last system would have been solved with [`Accuracy::Full`].
    full_accuracy_norm: f64,
}

impl<'a, T: Real> PreconditionedSolver<'a, T> {
    /// The solver of an inequality with a preconditioner for the symmetric part of its matrix.
    pub fn new(
        inequality: &'a Inequality<T>,
        symmetric_part: &'a SparseMatrix<T>,
        preconditioner: Box<dyn Preconditioner<T> + 'a>,
        tolerance: f64,
    ) -> Self {
        Self {
            inequality,
            symmetric_part,
            preconditioner,
            krylov: KrylovMethod::new(inequality),
            eliminated: Vec::new(),
            tolerance,
            residual: zeros(inequality.size()),
            smallest_ritz_value: 1.0,
            residual_norm: f64::INFINITY,
            full_accuracy_norm: 0.0,
        }
    }

    /// Copies the residual of an iterate on inactive unknowns and sets it to zero on eliminated ones.
    fn restrict_residual(&mut self, iterate: &Iterate<'_, T>) {
        let Iterate { eliminated, residual, .. } = iterate;
        for_each_chunk(&mut self.residual, |range, r| {
            for (r, i) in r.iter_mut().zip(range) {
                *r = T::lit(if eliminated[i] { 0.0 } else { residual[i] });
            }
        });
    }

    /// Updates `smallest_ritz_value` by a run of a Krylov method.
    ///
    /// # Errors
    /// The failure if the run did not converge, or if the condition number exceeds [`MAX_CONDITION`].
    fn check_run(&mut self, run: &KrylovRun) -> Result<(), End> {
        let (low, high) = run.ritz.unwrap_or((1.0, 1.0));
        self.smallest_ritz_value = self.smallest_ritz_value.min(low);
        match run.reason {
            StopReason::NotPositive if !self.inequality.symmetric => Err(self.loss_of_positivity()),
            _ if high > MAX_CONDITION * low => Err(End::Unsuitable),
            StopReason::NotPositive => Err(self.loss_of_positivity()),
            StopReason::Converged => Ok(()),
            StopReason::NotFinite => Err(End::Outcome(Outcome::NotFinite)),
            StopReason::IterationLimit => Err(End::Unsuitable),
        }
    }

    /// The failure after a run or the preconditioner found the symmetric part of the matrix not to be positive
    /// definite. The check before the solve has factored a matrix that is not distributed: rounding is the reason.
    fn loss_of_positivity(&self) -> End {
        match self.inequality.is_in_parts() {
            true => End::Outcome(Outcome::NotCoercive),
            false => End::Unsuitable,
        }
    }

    /// Projects the values onto their bounds and returns the bound on their error ([`algebraic_bound`]). `None` if the
    /// preconditioner cannot be set up for the unknowns on which the error may be nonzero, or rounding makes the square
    /// of the bound negative.
    ///
    /// *Proven:* `inv(S) <= B / lambda_min(B S)` for the preconditioner `B` on the same unknowns. *Estimated:*
    /// `lambda_min(B S)` by [`EIGENVALUE_TO_RITZ_VALUE`] times the smallest Ritz value. The Ritz values come from
    /// systems on the inactive unknowns, while the bound uses all unknowns that are neither fixed nor strongly active,
    /// a larger set with a smaller eigenvalue at most: that the factor covers this difference too is assumed.
    ///
    /// Changes the fixed unknowns of the preconditioner, which must be set again before the next linear system.
    ///
    /// # Errors
    /// [`Outcome::NotCoercive`] if the preconditioner finds a distributed matrix not to be positive definite.
    pub fn error_bound(&mut self, iterate: &mut Iterate<'_, T>) -> Result<Option<f64>, Outcome> {
        if iterate.project_onto_bounds() {
            iterate.compute_residual();
        }
        let Self { inequality, preconditioner, eliminated: present, .. } = self;
        let Iterate { values, residual, diagonal, energy_norm, .. } = &*iterate;
        let (inequality, energy_norm) = (*inequality, *energy_norm);
        let values = AdmissibleValues { inequality, values, residual, diagonal, energy_norm };
        let distribution = inequality.distribution();
        let sqrt_eigenvalue = (EIGENVALUE_TO_RITZ_VALUE * self.smallest_ritz_value).sqrt();
        let threshold = 4.0 * self.residual_norm / sqrt_eigenvalue;
        algebraic_bound(&values, threshold, |eliminated, unbalanced| {
            if any_part(distribution, eliminated != *present) {
                match preconditioner.set_fixed(eliminated) {
                    Ok(()) => present.copy_from_slice(eliminated),
                    Err(FactorError::NotPositive) if inequality.is_in_parts() => {
                        return Err(Outcome::NotCoercive);
                    }
                    Err(_) => return Ok(None),
                }
            }
            let mut preconditioned = zeros(unbalanced.len());
            preconditioner.apply(unbalanced, &mut preconditioned);
            let squared = sum_over_parts(distribution, dot(unbalanced, &mut preconditioned));
            Ok((squared >= 0.0).then(|| squared.sqrt() / sqrt_eigenvalue))
        })
    }

    /// Estimates the smallest eigenvalue of the preconditioned symmetric part of a matrix that is not
    /// symmetric, by the Ritz values of conjugate gradients for that part on the inactive unknowns;
    /// stores the smallest Ritz value in `smallest_ritz_value` if it is smaller than the stored one.
    ///
    /// The Ritz values of GMRES, which solves the systems with the matrix itself, do not estimate this
    /// eigenvalue: its Krylov space belongs to the whole matrix, so that they lie above the eigenvalue
    /// but need not come close to it.
    ///
    /// # Errors
    /// [`End::Unsuitable`] if the condition number is too large or the run does not converge, an outcome if
    /// the symmetric part is not positive definite.
    pub fn estimate_smallest_eigenvalue(
        &mut self,
        iterate: &mut Iterate<'_, T>,
    ) -> Result<(), End> {
        let run = eigenvalue_run(
            self.symmetric_part,
            self.inequality.distribution(),
            &mut *self.preconditioner,
            &iterate.eliminated,
            |i| iterate.diagonal[i],
            MAX_ITERATIONS,
        );
        iterate.linear += run.iterations;
        self.check_run(&run)
    }
}

impl<T: Real> LinearSolver<T> for PreconditionedSolver<'_, T> {
    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn set_eliminated(&mut self, eliminated: &[bool]) -> Result<(), End> {
        self.eliminated.clear();
        self.eliminated.extend_from_slice(eliminated);
        self.preconditioner.set_fixed(eliminated).map_err(|error| match error {
            FactorError::OutOfMemory => End::Outcome(Outcome::OutOfMemory),
            FactorError::NotPositive if !self.inequality.symmetric => self.loss_of_positivity(),
            // the stage with factors finds the reason
            _ => End::Unsuitable,
        })
    }

    fn correct(&mut self, iterate: &mut Iterate<'_, T>, accuracy: Accuracy) -> Result<(), End> {
        if !iterate.residual_is_current {
            iterate.compute_residual();
        }
        let stop = StoppingRule {
            absolute_tolerance: self.tolerance * iterate.energy_norm,
            relative_tolerance: match accuracy {
                Accuracy::Full => 0.0,
                Accuracy::Reduced => self.preconditioner.forcing_term(),
            },
            max_iterations: MAX_ITERATIONS,
        };
        self.restrict_residual(iterate);
        let Iterate { values, eliminated, .. } = iterate;
        let system = (&mut values[..], &mut self.residual[..]);
        let run = self.krylov.solve(eliminated, &mut *self.preconditioner, system, stop);
        iterate.linear += run.iterations;
        self.residual_norm = run.residual_norm;
        self.full_accuracy_norm = stop.absolute_tolerance;
        self.check_run(&run)?;
        iterate.compute_residual();
        Ok(())
    }

    /// The jump multipliers are `S (M u - g) + S M e`, where `e` solves the system with the residual of `u`. They are
    /// those of the values `u + e` without the rounding of this sum, which large weights `S` would amplify.
    fn determine_jump_multipliers(&mut self, iterate: &mut Iterate<'_, T>) -> Result<bool, End> {
        let Some(penalised) = &self.inequality.penalised else { return Ok(false) };
        iterate.compute_residual();
        self.restrict_residual(iterate);
        let stop = StoppingRule {
            absolute_tolerance: 0.0,
            relative_tolerance: MULTIPLIER_TOLERANCE,
            max_iterations: MAX_ITERATIONS,
        };
        let mut correction = zeros(iterate.values.len());
        let system = (&mut correction[..], &mut self.residual[..]);
        let run = self.krylov.solve(&iterate.eliminated, &mut *self.preconditioner, system, stop);
        iterate.linear += run.iterations;
        self.check_run(&run)?;
        let multipliers_of_values = penalised.jump_multipliers(|i| iterate.values[i].to_f64());
        let multiplier = |jump: usize| {
            let jump_of_correction = penalised.jump(jump, |i| correction[i].to_f64());
            let change = penalised.weights[jump].to_f64() * jump_of_correction;
            T::lit(multipliers_of_values[jump] + change)
        };
        iterate.jump_multipliers = collect(penalised.n_jumps(), multiplier);
        iterate.compute_residual_with_jump_multipliers();
        Ok(true)
    }

    fn is_accurate(&self, energy_norm: f64) -> bool {
        self.residual_norm
            <= self.full_accuracy_norm.min(TOLERANCE_MARGIN * self.tolerance * energy_norm)
    }
}
