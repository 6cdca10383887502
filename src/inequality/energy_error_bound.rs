//! A proven bound on the distance of any values from the solution of an inequality.

use super::Outcome;
use super::certificate::positive_diagonal;
use super::scales::Scales;
use super::validation::check_input;
use crate::algebra::{Bound, Inequality};
use crate::instances::compiled;
use crate::linear::direct::Factors;
use crate::real::Real;

/// A bound on the energy norm of the difference of values and the solution of an inequality with a
/// symmetric positive definite matrix, divided by the energy norm of the values. It needs one
/// factorisation of the matrix on all unknowns that are not fixed.
///
/// Let `v` be the projection of the values onto the bounds; the energy norm of the difference of `v` and
/// the values is part of the bound. Let `m_i = (A v - b)_i` where `v_i` is at a bound and `m_i` has the right sign there, or where
/// `i` is fixed; zero elsewhere. With `e` the difference of the solution and `v`, both admissible,
/// `||e||_A^2 <= e . (b + m - A v)`, because `e . m >= 0`; hence `||e||_A^2 <= r . inv(A) r` with the
/// residual `r = b + m - A v` on the unknowns that are not fixed. Nothing is assumed of the active set.
/// The bound is sharp where no unknown is active, and otherwise larger than the error by at most what
/// the inverse of the whole matrix exceeds that on the inactive unknowns.
///
/// # Errors
/// An outcome: [`Outcome::Malformed`] and its like for wrong input, values of another length included,
/// [`Outcome::NotCoercive`] and its like where the matrix is not symmetric or has no Cholesky factor.
pub fn energy_error_bound<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Result<f64, Outcome> {
    compiled!(
        T: fn(&Inequality<T>, &[T]) -> Result<f64, Outcome>
            = bound_of
    )(inequality, u)
}

fn bound_of<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Result<f64, Outcome> {
    check_input(inequality)?;
    if u.len() != inequality.size() {
        return Err(Outcome::Malformed);
    }
    if !u.iter().all(|x| x.to_f64().is_finite()) {
        return Err(Outcome::NotFinite);
    }
    if !inequality.symmetric {
        return Err(Outcome::NotCoercive);
    }
    let Inequality { matrix, bounds, .. } = inequality;
    let admissible: Vec<T> = u.iter().zip(bounds).map(|(&x, bound)| bound.nearest(x)).collect();
    let change = |i: usize| admissible[i].to_f64() - u[i].to_f64();
    let of_change = |i: usize| {
        let (columns, values) = matrix.row(i);
        let terms = columns.iter().zip(values);
        change(i) * terms.map(|(&j, a)| a.to_f64() * change(j as usize)).sum::<f64>()
    };
    let projection: f64 = (0..u.len()).filter(|&i| change(i) != 0.0).map(of_change).sum();
    let mut residual = vec![0.0; u.len()];
    inequality.residual_f64(&admissible, &mut residual);
    let free = inequality.free_unknowns();
    let unbalanced = |&i: &u32| {
        let i = i as usize;
        T::lit(unbalanced(&bounds[i], admissible[i], residual[i]))
    };
    let right_side: Vec<T> = free.iter().map(unbalanced).collect();
    let mut correction = right_side.clone();
    Factors::new(matrix, true, &free)?.solve_in_place(&mut correction, 1);
    let terms = right_side.iter().zip(&correction);
    let squared: f64 = terms.map(|(r, e)| r.to_f64() * e.to_f64()).sum();
    let diagonal = |i: usize| positive_diagonal(inequality, i);
    let scales = Scales::of(inequality, &admissible, &residual, &[], &diagonal, 1.0);
    // the larger of zero and a number that is not one would be zero
    if squared.is_nan() || projection.is_nan() {
        return Err(Outcome::NotFinite);
    }
    Ok((squared.max(0.0).sqrt() + projection.max(0.0).sqrt()) / scales.energy_norm)
}

/// The residual of an unknown that no multiplier balances: `residual`, or zero if the unknown is fixed, or at a bound
/// that `residual` presses it against.
pub(super) fn unbalanced<T: Real>(bound: &Bound<T>, value: T, residual: f64) -> f64 {
    let is_balanced = bound.fixed_value().is_some()
        || bound.lower().is_some_and(|l| value <= l && residual <= 0.0)
        || bound.upper().is_some_and(|u| value >= u && residual >= 0.0);
    if is_balanced { 0.0 } else { residual }
}
