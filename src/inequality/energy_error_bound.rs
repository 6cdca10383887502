//! A proven bound on the distance of any values from the solution of an inequality.

use super::Outcome;
use super::certificate::positive_diagonal;
use super::scales::Scales;
use super::validation::check_input;
use crate::algebra::{Bound, Inequality};
use crate::instances::compiled;
use crate::linear::direct::Factors;
use crate::real::Real;

/// A bound on the energy norm of the difference between the values `u` and the solution of an inequality with a
/// symmetric positive definite matrix, divided by the energy norm of `v`, the projection of `u` onto the bounds. It
/// needs one factorisation of the matrix on all unknowns that are not fixed.
///
/// The bound is the sum of `||v - u||_A` and a bound on `||e||_A`, with the difference `e` of the solution and `v`,
/// which are both admissible. Let `m_i = (A v - b)_i` if `i` is fixed, or if `v_i` is at a bound and `m_i` has the
/// right sign there; else `m_i = 0`. Then `||e||_A^2 <= e . (b + m - A v)`, because `e . m >= 0`; hence
/// `||e||_A^2 <= r . inv(A) r` with the residual `r = b + m - A v` on the unknowns that are not fixed. Nothing is
/// assumed of the active set. If no unknown is active, the bound is the error of `v`; else it is larger, because
/// `inv(A)` is the inverse on all unknowns that are not fixed, not on the inactive ones.
///
/// # Errors
/// [`Outcome::Malformed`], [`Outcome::NotFinite`], [`Outcome::Infeasible`] or [`Outcome::OutOfRange`] for invalid
/// input, values of another length and the inequality of one part of a mesh included; [`Outcome::NotCoercive`] if the
/// matrix is not symmetric; the reason if there are no Cholesky factors.
pub fn energy_error_bound<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Result<f64, Outcome> {
    compiled!(
        T: fn(&Inequality<T>, &[T]) -> Result<f64, Outcome>
            = error_bound_of
    )(inequality, u)
}

fn error_bound_of<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Result<f64, Outcome> {
    check_input(inequality)?;
    if u.len() != inequality.size() || inequality.distribution.is_some() {
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
    let energy_term = |i: usize| {
        let (columns, values) = matrix.row(i);
        let terms = columns.iter().zip(values);
        change(i) * terms.map(|(&j, a)| a.to_f64() * change(j as usize)).sum::<f64>()
    };
    let energy_of_change: f64 = (0..u.len()).filter(|&i| change(i) != 0.0).map(energy_term).sum();
    let mut residual = vec![0.0; u.len()];
    inequality.residual_f64(&admissible, &mut residual);
    let free = inequality.free_unknowns();
    let of_free = |&i: &u32| {
        let i = i as usize;
        T::lit(unbalanced_residual(&bounds[i], admissible[i], residual[i]))
    };
    let right_side: Vec<T> = free.iter().map(of_free).collect();
    let mut correction = right_side.clone();
    Factors::new(matrix, true, &free)?.solve_in_place(&mut correction, 1);
    let terms = right_side.iter().zip(&correction);
    let squared: f64 = terms.map(|(r, e)| r.to_f64() * e.to_f64()).sum();
    let diagonal = |i: usize| positive_diagonal(inequality, i);
    let scales = Scales::of(inequality, &admissible, &residual, &[], &diagonal, 1.0);
    // the following maxima would replace NaN by zero
    if squared.is_nan() || energy_of_change.is_nan() {
        return Err(Outcome::NotFinite);
    }
    Ok((squared.max(0.0).sqrt() + energy_of_change.max(0.0).sqrt()) / scales.energy_norm)
}

/// The part of the residual `b - A u` of an unknown that no multiplier of the right sign balances: zero if the unknown
/// is fixed, or at a bound where its multiplier has the right sign; else `residual`.
pub(super) fn unbalanced_residual<T: Real>(bound: &Bound<T>, value: T, residual: f64) -> f64 {
    let is_balanced = bound.fixed_value().is_some()
        || bound.lower().is_some_and(|l| value <= l && residual <= 0.0)
        || bound.upper().is_some_and(|u| value >= u && residual >= 0.0);
    if is_balanced { 0.0 } else { residual }
}
