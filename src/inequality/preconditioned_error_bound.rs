//! A bound on the energy norm of the algebraic error by a preconditioner, without factors.

use super::Outcome;
use super::certificate::positive_diagonal;
use super::energy_error_bound::unbalanced_residual;
use super::scales::Scales;
use super::validation::{diagnose_loss_of_positivity, has_negative_direction};
use crate::algebra::Inequality;
use crate::linear::Preconditioner;
use crate::linear::direct::FactorError;
use crate::linear::krylov::{EIGENVALUE_TO_RITZ_VALUE, Product, StopReason, eigenvalue_run};
use crate::parallel::vectors::{dot, zeros};
use crate::real::Real;

/// Largest number of iterations of conjugate gradients for the smallest eigenvalue.
const MAX_ITERATIONS: usize = 500;

/// A bound on the energy norm of the difference between values and the solution of an inequality with a symmetric
/// positive definite matrix, divided by the energy norm of the values. The values must be within their bounds.
///
/// With the residual `r` of [`energy_error_bound`](super::energy_error_bound()) and the preconditioner `B` on the
/// unknowns that are not fixed, `||e||_A^2 <= r . inv(A) r <= r . B r / lambda_min(B A)`. Nothing is assumed of the
/// active set; the eigenvalue is estimated on the same unknowns, by [`EIGENVALUE_TO_RITZ_VALUE`] times the
/// smallest Ritz value.
///
/// `None` if the matrix is singular on these unknowns (bounds alone may hold the domain), if conjugate gradients do not
/// converge, or if rounding makes `r . B r` negative. On return the preconditioner is set up for the unknowns that are
/// not fixed.
///
/// # Errors
/// [`Outcome::NotCoercive`] if the matrix is indefinite, which factors show if there is no estimate of the eigenvalue
/// and the matrix is not known to be definite. After a direction that is not positive, the reason if there are no
/// factors.
pub(super) fn preconditioned_error_bound<T: Real>(
    inequality: &Inequality<T>,
    values: &[T],
    preconditioner: &mut dyn Preconditioner<T>,
) -> Result<Option<f64>, Outcome> {
    let bounds = &inequality.bounds;
    let fixed: Vec<bool> = bounds.iter().map(|bound| bound.fixed_value().is_some()).collect();
    let after_loss_of_positivity = || diagnose_loss_of_positivity(inequality).map_or(Ok(None), Err);
    let without_eigenvalue = || match has_negative_direction(inequality) {
        true => Err(Outcome::NotCoercive),
        false => Ok(None),
    };
    match preconditioner.set_fixed(&fixed) {
        Ok(()) => {}
        Err(FactorError::NotPositive) => return after_loss_of_positivity(),
        Err(_) => return without_eigenvalue(),
    }
    let diagonal = |i: usize| positive_diagonal(inequality, i);
    let matrix = Product::of(inequality);
    let run = eigenvalue_run(matrix, None, preconditioner, &fixed, diagonal, MAX_ITERATIONS);
    let smallest = match run.ritz {
        Some((smallest, _)) if run.reason == StopReason::Converged && smallest > 0.0 => smallest,
        _ if run.reason == StopReason::NotPositive => return after_loss_of_positivity(),
        _ => return without_eigenvalue(),
    };
    let mut residual = vec![0.0; values.len()];
    inequality.residual_f64(values, &mut residual);
    let energy_norm = Scales::of(inequality, values, &residual, &[], &diagonal, 1.0).energy_norm;
    let unknowns = bounds.iter().zip(values).zip(&residual);
    let unbalanced: Vec<T> = unknowns
        .map(|((bound, &value), &r)| T::lit(unbalanced_residual(bound, value, r)))
        .collect();
    let mut preconditioned = zeros(unbalanced.len());
    preconditioner.apply(&unbalanced, &mut preconditioned);
    let squared = dot(&unbalanced, &mut preconditioned) / (EIGENVALUE_TO_RITZ_VALUE * smallest);
    Ok((squared >= 0.0).then(|| squared.sqrt() / energy_norm))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::algebra::{Bound, SparseMatrix};
    use crate::inequality::{ActiveSet, InequalitySolver, energy_error_bound};
    use crate::linear::{
        BuiltInPreconditioners, CoarseLevel, CoarseSpaces, PreconditionedSystem,
        PreconditionerFamily,
    };

    /// Second differences on `n` points, fixed at both ends, under the load -1/n^2 above -1/30: the contact set is in
    /// the middle.
    pub fn string(n: usize) -> Inequality<f64> {
        let mut bounds = vec![Bound::Lower(-1.0 / 30.0); n];
        (bounds[0], bounds[n - 1]) = (Bound::Fixed(0.0), Bound::Fixed(0.0));
        let matrix = SparseMatrix::second_differences(n);
        Inequality::new(matrix, true, vec![-1.0 / (n * n) as f64; n], bounds)
    }

    #[test]
    fn the_bound_by_a_preconditioner_is_above_that_by_factors() {
        let string = string(2000);
        let solution = ActiveSet::default().solve(&string);
        let fixed: Vec<bool> = string.bounds.iter().map(|b| b.fixed_value().is_some()).collect();
        let level = CoarseLevel::aggregated(&string.matrix, &fixed).unwrap();
        let spaces = CoarseSpaces::CoarseLevel(level);
        let system = PreconditionedSystem::new(&string.matrix, &string, &spaces);
        let mut preconditioner = BuiltInPreconditioners.preconditioner(system).unwrap();
        for size in [1e-2, 1e-5, 1e-8] {
            // upwards in the contact set as well: active unknowns have errors too
            let change = |i: usize| size * (1.0 + (0.7 * i as f64).sin());
            let moved = solution.values.iter().zip(&string.bounds).enumerate();
            let values: Vec<f64> =
                moved.map(|(i, (x, bound))| bound.nearest(x + change(i))).collect();
            let by_factors = energy_error_bound(&string, &values).unwrap();
            let bound = preconditioned_error_bound(&string, &values, &mut *preconditioner);
            let bound = bound.unwrap().unwrap();
            assert!(by_factors <= bound && bound <= 3.0 * by_factors, "{by_factors} {bound}");
        }
    }
}
