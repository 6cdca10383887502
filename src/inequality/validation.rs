//! Checks of an inequality before it is solved.

use super::Outcome;
use super::certificate::positive_diagonal;
use crate::algebra::Inequality;
use crate::linear::direct::{FactorError, Factors, StaticCondensation};
use crate::linear::krylov::symmetric_part;
use crate::real::Real;

/// The largest and the smallest size of data, as values or energies, whose squares neither overflow nor
/// underflow, with a margin for products with coefficients and volumes.
const DATA_RANGE: [f64; 2] = [1e-120, 1e120];

/// Checks that sizes match, that all numbers are finite, that no lower bound exceeds its upper one, and
/// that squares of the data neither overflow nor underflow.
///
/// # Errors
/// The outcome that a solver returns: [`Outcome::Malformed`], [`Outcome::NotFinite`],
/// [`Outcome::Infeasible`] or [`Outcome::OutOfRange`].
pub(crate) fn check_input<T: Real>(inequality: &Inequality<T>) -> Result<(), Outcome> {
    let is_well_formed = inequality.is_well_formed();
    // all parts of a mesh compare their data, whatever is wrong in one of them
    let is_in_range = data_are_in_range(inequality, is_well_formed);
    if !is_well_formed {
        Err(Outcome::Malformed)
    } else if !inequality.is_finite() {
        Err(Outcome::NotFinite)
    } else if !inequality.is_feasible() {
        Err(Outcome::Infeasible)
    } else if !is_in_range {
        Err(Outcome::OutOfRange)
    } else {
        Ok(())
    }
}

/// Whether the largest of the loads and of the admissible values nearest to zero, over all parts of a mesh, is zero or
/// within [`DATA_RANGE`], as a value and as the square root of an energy.
fn data_are_in_range<T: Real>(inequality: &Inequality<T>, is_well_formed: bool) -> bool {
    let mut largest = [0.0_f64; 2];
    let n = if is_well_formed { inequality.size() } else { 0 };
    for i in (0..n).filter(|&i| inequality.owns(i)) {
        let (bound, load) = (&inequality.bounds[i], inequality.load[i]);
        let root = positive_diagonal(inequality, i).sqrt();
        let value =
            bound.nearest(T::lit(0.0)).to_f64().abs().max(load.to_f64().abs() / root / root);
        largest = [largest[0].max(value), largest[1].max(value * root)];
    }
    if let Some(distribution) = inequality.distribution() {
        distribution.largest(&mut largest);
    }
    let [least, most] = DATA_RANGE;
    largest.iter().all(|&size| size == 0.0 || (size >= least && size <= most))
}

/// Checks by a Cholesky factorisation that the matrix, or its symmetric part if it is not symmetric, is
/// positive definite on all unknowns that are not fixed. A penalised matrix is factored by static
/// condensation. On the kernel, where it is known, the matrix need not be positive.
///
/// # Errors
/// The outcome that a solver returns: [`Outcome::NotCoercive`], or the reason why there are no factors.
pub(crate) fn check_definite<T: Real>(inequality: &Inequality<T>) -> Result<(), Outcome> {
    factor_free_unknowns(inequality).map_err(|error| match error {
        FactorError::Singular if inequality.penalised.is_none() => Outcome::NotCoercive,
        _ => error.into(),
    })
}

/// Whether the matrix, or its symmetric part, is indefinite: as [`check_definite`], but false for a singular matrix,
/// which may have a solution all the same, and where it is known to be definite or cannot be factored.
pub(super) fn is_indefinite<T: Real>(inequality: &Inequality<T>) -> bool {
    !inequality.is_definite
        && inequality.distribution.is_none()
        && factor_free_unknowns(inequality) == Err(FactorError::NotPositive)
}

/// Factors the matrix, or its symmetric part, on all unknowns that are not fixed; see [`check_definite`].
fn factor_free_unknowns<T: Real>(inequality: &Inequality<T>) -> Result<(), FactorError> {
    let mut free = inequality.free_unknowns();
    // with one unknown of a kernel vector fixed the matrix is positive definite on the others
    let of_kernel: Vec<u32> = inequality.kernel.iter().filter_map(|w| Some(w.first()?.0)).collect();
    free.retain(|i| !of_kernel.contains(i));
    if let Some(penalised) = &inequality.penalised {
        let mut is_free = vec![false; inequality.size()];
        free.iter().for_each(|&i| is_free[i as usize] = true);
        return StaticCondensation::new(penalised).factor(&is_free).map(|_| ());
    }
    Factors::new(&symmetric_part(inequality), true, &free).map(|_| ())
}

/// The outcome where a Krylov method or a preconditioner found the symmetric part of the matrix not to be positive
/// definite. `None` if rounding of large penalties is the reason: the matrix is known to be definite, or has Cholesky
/// factors. A distributed matrix has no factors.
pub(crate) fn outcome_of_not_positive<T: Real>(inequality: &Inequality<T>) -> Option<Outcome> {
    if inequality.is_definite {
        None
    } else if inequality.distribution.is_some() {
        Some(Outcome::NotCoercive)
    } else {
        check_definite(inequality).err()
    }
}
