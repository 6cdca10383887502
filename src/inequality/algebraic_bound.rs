//! A bound on the energy norm of the algebraic error of admissible values.

use super::Outcome;
use crate::algebra::{Bound, Inequality};
use crate::parallel::vectors::collect;
use crate::real::Real;

/// The threshold of strong activity divided by the estimate of the energy norm of the error.
const THRESHOLD_FACTOR: f64 = 4.0;

/// Number of thresholds tried before no unknown counts as strongly active.
const MAX_THRESHOLDS: usize = 3;

/// Values within their bounds, with what the bound on their error depends on.
pub(super) struct AdmissibleValues<'v, T: Real> {
    pub inequality: &'v Inequality<T>,
    pub values: &'v [T],
    /// `b - A u`.
    pub residual: &'v [f64],
    /// The positive diagonal of the matrix.
    pub diagonal: &'v [f64],
    /// The energy norm of the values.
    pub energy_norm: f64,
}

/// A bound on the energy norm of the error of admissible values, divided by the energy norm of the values in place of
/// that of the solution. `None` if `dual_norm` is.
///
/// Notation: `u` are the values, `u*` is the solution, `e = u* - u` the error, `S = (A + A^T) / 2` the symmetric part of
/// `A`, and `||e||_A = (e . A e)^(1/2)` the energy norm, which equals `(e . S e)^(1/2)`. The vector `m` equals `A u - b`
/// on fixed unknowns and on unknowns at a bound whose multiplier has the right sign (`m_i >= 0` at a lower bound,
/// `m_i <= 0` at an upper one), and zero on all others. The *unbalanced residual* `r = b + m - A u` is therefore
/// `b - A u` with zeros on these unknowns; multipliers of the wrong sign remain in `r`.
///
/// 1. `||e||_A^2 <= e . r <= ||e||_A (r . inv(S) r)^(1/2)`, since `u` and `u*` are admissible and `e . m >= 0`. Here
///    `inv(S)` is the inverse on the unknowns where `e` may be nonzero. `dual_norm(eliminated, r)` is a bound on
///    `(r . inv(S) r)^(1/2)` with some unknowns eliminated; `None` if the caller has none for them.
/// 2. Fewer unknowns give a smaller bound. Call an unknown at a bound strongly active if its multiplier exceeds a
///    threshold times `sqrt(d_i)`, `d_i` its diagonal entry, and consider the problem in which all strongly active
///    unknowns keep their values. If the bound on the error `e` of that problem is at most the threshold, none of their
///    multipliers changes its sign between `u` and its solution, which is therefore the solution of the inequality.
///    *Proven for a symmetric `A`*, where `|(A e)_i| <= sqrt(d_i) ||e||_A`; *assumed for any other*, where the
///    skew-symmetric part of `A` may change a multiplier by more. Otherwise the threshold, at first `threshold`, is
///    raised, and in the end no unknown counts as strongly active: then nothing is assumed here.
pub(super) fn algebraic_bound<T: Real>(
    of: &AdmissibleValues<'_, T>,
    mut threshold: f64,
    mut dual_norm: impl FnMut(&[bool], &[T]) -> Result<Option<f64>, Outcome>,
) -> Result<Option<f64>, Outcome> {
    let AdmissibleValues { inequality, values, residual, diagonal, energy_norm } = *of;
    let bounds = &inequality.bounds;
    let unbalanced = |i: usize| {
        let is_balanced = !inequality.owns(i)
            || bounds[i].fixed_value().is_some()
            || multiplier(&bounds[i], values[i], residual[i]) >= 0.0;
        T::lit(if is_balanced { 0.0 } else { residual[i] })
    };
    let unbalanced = collect(values.len(), unbalanced);
    for trial in 0..=MAX_THRESHOLDS {
        if trial == MAX_THRESHOLDS {
            threshold = f64::INFINITY;
        }
        let is_eliminated = |i: usize| {
            !inequality.owns(i)
                || bounds[i].fixed_value().is_some()
                || multiplier(&bounds[i], values[i], residual[i]) > threshold * diagonal[i].sqrt()
        };
        let eliminated = collect(values.len(), is_eliminated);
        let Some(bound) = dual_norm(&eliminated, &unbalanced)? else { return Ok(None) };
        if bound <= threshold {
            return Ok(Some(bound / energy_norm));
        }
        threshold = THRESHOLD_FACTOR * bound;
    }
    Ok(None)
}

/// The multiplier of a value at a bound, positive if its sign is right; minus infinity for a value at no bound.
fn multiplier<T: Real>(bound: &Bound<T>, value: T, residual: f64) -> f64 {
    if bound.lower().is_some_and(|l| value <= l) {
        -residual
    } else if bound.upper().is_some_and(|u| value >= u) {
        residual
    } else {
        f64::NEG_INFINITY
    }
}
