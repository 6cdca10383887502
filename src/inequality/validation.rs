//! Checks of an inequality before it is solved.

use super::Outcome;
use crate::algebra::Inequality;
use crate::linear::direct::StaticCondensation;
use crate::linear::direct::is_positive_definite;
use crate::real::Real;

/// Checks that sizes match, that all numbers are finite, and that no lower bound exceeds its upper one.
///
/// # Errors
/// The outcome that a solver returns: [`Outcome::Malformed`], [`Outcome::NotFinite`] or
/// [`Outcome::Infeasible`].
pub(crate) fn check_input<T: Real>(inequality: &Inequality<T>) -> Result<(), Outcome> {
    if !inequality.is_well_formed() {
        Err(Outcome::Malformed)
    } else if !inequality.is_finite() {
        Err(Outcome::NotFinite)
    } else if !inequality.is_feasible() {
        Err(Outcome::Infeasible)
    } else {
        Ok(())
    }
}

/// Checks by a Cholesky factorisation that the matrix, or its symmetric part if it is not symmetric, is
/// positive definite on all unknowns that are not fixed. A penalised matrix is factored by static
/// condensation.
///
/// # Errors
/// The outcome that a solver returns: [`Outcome::NotCoercive`], or the reason why there are no factors.
pub(crate) fn check_definite<T: Real>(inequality: &Inequality<T>) -> Result<(), Outcome> {
    if let Some(penalised) = &inequality.penalised {
        let is_free: Vec<bool> =
            inequality.bounds.iter().map(|bound| bound.fixed_value().is_none()).collect();
        StaticCondensation::new(penalised).factor(&is_free)?;
        return Ok(());
    }
    let Inequality { matrix, symmetric, .. } = inequality;
    if is_positive_definite(matrix, *symmetric, &inequality.free_unknowns())? {
        Ok(())
    } else {
        Err(Outcome::NotCoercive)
    }
}
