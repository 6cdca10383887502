//! Checks of an inequality before it is solved.

use std::borrow::Cow;

use super::Outcome;
use super::certificate::positive_diagonal;
use crate::algebra::Inequality;
use crate::linear::direct::{DirectSystem, FactorError, Factors};
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
pub(super) fn data_are_in_range<T: Real>(inequality: &Inequality<T>, is_well_formed: bool) -> bool {
    let n = if is_well_formed { inequality.size() } else { 0 };
    let load = if is_well_formed { inequality.assembled_load() } else { Cow::Borrowed(&[][..]) };
    let chunks = map_chunks(n, |range| {
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
        chunks.iter().fold([0.0; 2], |[a, b]: [f64; 2], chunk| [a.max(chunk[0]), b.max(chunk[1])]);
    inequality.distribution().largest(&mut largest);
    let [least, most] = DATA_RANGE;
    largest.iter().all(|&magnitude| magnitude == 0.0 || (magnitude >= least && magnitude <= most))
}

/// The check before every solve: the input ([`check_input`]) and, by one Cholesky factorisation, that the matrix, or its
/// symmetric part if it is not symmetric, has no negative direction on the unknowns that are not fixed. A matrix that is
/// known to be definite is not factored, nor is that of one part of a mesh; one whose factors do not fit into memory
/// counts as definite. A singular matrix passes: bounds may hold what it does not.
///
/// # Errors
/// The outcome that a solver returns: those of [`check_input`], [`Outcome::NotCoercive`], or [`Outcome::Malformed`] if
/// the matrix is declared symmetric and is not.
pub(crate) fn check<T: Real>(inequality: &Inequality<T>) -> Result<(), Outcome> {
    over_all_parts(inequality, check_input(inequality))?;
    if inequality.is_definite || inequality.is_in_parts() {
        return Ok(());
    }
    match factor_free_unknowns(inequality) {
        Err(FactorError::NotPositive)
            if inequality.symmetric && !inequality.matrix.is_symmetric() =>
        {
            Err(Outcome::Malformed)
        }
        Err(FactorError::NotPositive) => Err(Outcome::NotCoercive),
        _ => Ok(()),
    }
}

/// The result of a check in all parts: of the outcomes of the parts the one that comes last in `OUTCOMES`, or
/// [`Outcome::NotFinite`] if messages between the parts fail.
fn over_all_parts<T: Real>(
    inequality: &Inequality<T>,
    checked: Result<(), Outcome>,
) -> Result<(), Outcome> {
    const OUTCOMES: [Outcome; 4] =
        [Outcome::OutOfRange, Outcome::Infeasible, Outcome::NotFinite, Outcome::Malformed];
    let code = |outcome: Outcome| OUTCOMES.iter().position(|&other| other == outcome);
    let mut largest = [checked.err().map_or(0, |outcome| code(outcome).unwrap_or(0) + 1) as f64];
    inequality.distribution().largest(&mut largest);
    match largest[0] as usize {
        0 if largest[0] == 0.0 => Ok(()),
        // not a number
        0 => Err(Outcome::NotFinite),
        code => Err(OUTCOMES[code - 1]),
    }
}

/// Factors the matrix, or its symmetric part, on all unknowns that are not fixed. On the kernel, where it is known, the
/// matrix need not be positive.
fn factor_free_unknowns<T: Real>(inequality: &Inequality<T>) -> Result<(), FactorError> {
    let mut free = inequality.free_unknowns();
    // kernel vectors have no common unknowns: with one unknown of each fixed the matrix is definite on the others
    let pinned: Vec<u32> = inequality.kernel.iter().filter_map(|w| Some(w.first()?.0)).collect();
    free.retain(|i| !pinned.contains(i));
    if inequality.symmetric {
        let mut is_free = vec![false; inequality.size()];
        free.iter().for_each(|&i| is_free[i as usize] = true);
        return DirectSystem::new(inequality).factor(&is_free, &[], &mut None).map(|_| ());
    }
    Factors::new(&symmetric_part(inequality), true, &free).map(|_| ())
}
