//! Checks of an inequality before it is solved.

use std::borrow::Cow;

use super::Outcome;
use super::certificate::positive_diagonal;
use crate::algebra::Inequality;
use crate::linear::direct::{FactorError, Factors, StaticCondensation};
use crate::linear::krylov::symmetric_part;
use crate::parallel::vectors::map_chunks;
use crate::real::Real;

/// The least and the largest magnitude of data, as values or as square roots of energies, whose squares neither
/// underflow nor overflow, with a margin for products with coefficients and volumes.
const DATA_RANGE: [f64; 2] = [1e-120, 1e120];

/// Checks that sizes match, that all numbers are finite, that no lower bound exceeds its upper one, and
/// that squares of the data neither overflow nor underflow.
///
/// # Errors
/// The outcome that a solver returns: [`Outcome::Malformed`], [`Outcome::NotFinite`],
/// [`Outcome::Infeasible`] or [`Outcome::OutOfRange`].
pub(crate) fn check_input<T: Real>(inequality: &Inequality<T>) -> Result<(), Outcome> {
    let is_well_formed = inequality.is_well_formed();
    // a collective reduction: every part of a mesh calls it, whatever is wrong in one of them
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

/// Whether the largest datum over all parts of a mesh is zero or within [`DATA_RANGE`]. The data of unknown `i` are its
/// admissible value nearest to zero and `|b_i| / a_ii`, both as values, and their products with the square root of
/// `a_ii`, as square roots of energies.
fn data_are_in_range<T: Real>(inequality: &Inequality<T>, is_well_formed: bool) -> bool {
    let n = if is_well_formed { inequality.size() } else { 0 };
    let load = if is_well_formed { inequality.assembled_load() } else { Cow::Borrowed(&[][..]) };
    let parts = map_chunks(n, |range| {
        range.filter(|&i| inequality.owns(i)).fold([0.0_f64; 2], |largest, i| {
            let (bound, load) = (&inequality.bounds[i], load[i]);
            let sqrt_diagonal = positive_diagonal(inequality, i).sqrt();
            let value = bound
                .nearest(T::lit(0.0))
                .to_f64()
                .abs()
                .max(load.to_f64().abs() / sqrt_diagonal / sqrt_diagonal);
            [largest[0].max(value), largest[1].max(value * sqrt_diagonal)]
        })
    });
    let mut largest =
        parts.iter().fold([0.0; 2], |[a, b]: [f64; 2], part| [a.max(part[0]), b.max(part[1])]);
    if let Some(distribution) = inequality.distribution() {
        distribution.largest(&mut largest);
    }
    let [least, most] = DATA_RANGE;
    largest.iter().all(|&magnitude| magnitude == 0.0 || (magnitude >= least && magnitude <= most))
}

/// Checks by a Cholesky factorisation that the matrix, or its symmetric part if it is not symmetric, is
/// positive definite on all unknowns that are not fixed. A penalised matrix, which is symmetric, is factored by
/// static condensation. On the kernel, where it is known, the matrix need not be positive.
///
/// # Errors
/// The outcome that a solver returns: [`Outcome::NotCoercive`], or the reason why there are no factors.
pub(crate) fn check_definite<T: Real>(inequality: &Inequality<T>) -> Result<(), Outcome> {
    factor_free_unknowns(inequality).map_err(|error| match error {
        FactorError::Singular if inequality.penalised.is_none() => Outcome::NotCoercive,
        _ => error.into(),
    })
}

/// Whether the factorisation of the matrix, or of its symmetric part, on the unknowns that are not fixed finds a
/// negative pivot, so that the energy is not convex. Unlike in [`check_definite`] the answer is false for a singular
/// matrix, which may have a solution all the same, for a matrix that is known to be definite, and for one that
/// cannot be factored.
pub(super) fn has_negative_direction<T: Real>(inequality: &Inequality<T>) -> bool {
    !inequality.is_definite
        && inequality.distribution.is_none()
        && factor_free_unknowns(inequality) == Err(FactorError::NotPositive)
}

/// Factors the matrix, or its symmetric part, on all unknowns that are not fixed; see [`check_definite`].
fn factor_free_unknowns<T: Real>(inequality: &Inequality<T>) -> Result<(), FactorError> {
    let mut free = inequality.free_unknowns();
    // kernel vectors have no common unknowns: with one unknown of each fixed the matrix is definite on the others
    let pinned: Vec<u32> = inequality.kernel.iter().filter_map(|w| Some(w.first()?.0)).collect();
    free.retain(|i| !pinned.contains(i));
    if let Some(penalised) = &inequality.penalised {
        let mut is_free = vec![false; inequality.size()];
        free.iter().for_each(|&i| is_free[i as usize] = true);
        return StaticCondensation::new(penalised, &inequality.matrix).factor(&is_free).map(|_| ());
    }
    Factors::new(&symmetric_part(inequality), true, &free).map(|_| ())
}

/// The outcome where a Krylov method or a preconditioner found the symmetric part of the matrix not to be positive
/// definite. `None` if rounding of large penalties is the reason: the matrix is known to be definite, or has Cholesky
/// factors. A distributed matrix has no factors.
pub(crate) fn diagnose_loss_of_positivity<T: Real>(inequality: &Inequality<T>) -> Option<Outcome> {
    if inequality.is_definite {
        None
    } else if inequality.distribution.is_some() {
        Some(Outcome::NotCoercive)
    } else {
        check_definite(inequality).err()
    }
}
