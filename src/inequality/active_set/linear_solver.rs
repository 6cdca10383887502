//! The linear systems of an active set, as the active set iteration sees them.

use super::iterate::Iterate;
use crate::inequality::Outcome;
use crate::linear::direct::FactorError;

/// How accurately a linear system is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Accuracy {
    /// As accurately as the solver can: to [`LinearSolver::tolerance`].
    Full,
    /// Accurately enough to predict most contact states.
    Reduced,
}

/// Why a linear system was not solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LinearFailure {
    /// There are no factors.
    Factors(FactorError),
    /// The outcome of the solve, which no other linear solver would change.
    Outcome(Outcome),
    /// The solver does not fit the matrix, or needs too many iterations.
    Unsuitable,
}

impl From<FactorError> for LinearFailure {
    fn from(error: FactorError) -> Self {
        Self::Factors(error)
    }
}

/// A solver of the systems `A_II u_I = b_I - A_IE u_E`, where `I` are the inactive unknowns and `E`
/// the eliminated ones, which are fixed or active.
pub(crate) trait LinearSolver<T>: Sync {
    /// Relative tolerance, in the energy norm, of systems solved with [`Accuracy::Full`]; zero if only
    /// rounding limits the accuracy.
    fn tolerance(&self) -> f64;
    /// Prepares the systems without the eliminated unknowns.
    ///
    /// # Errors
    /// See [`LinearFailure`].
    fn set_eliminated(&mut self, eliminated: &[bool]) -> Result<(), LinearFailure>;
    /// Corrects the values of the inactive unknowns, and the jump multipliers if the solver has them as
    /// unknowns, by the solution for the residual. On return the residual is the true one of all
    /// unknowns, in `f64`.
    ///
    /// # Errors
    /// See [`LinearFailure`].
    fn correct(
        &mut self,
        iterate: &mut Iterate<'_, T>,
        accuracy: Accuracy,
    ) -> Result<(), LinearFailure>;
    /// Determines the jump multipliers of a penalised matrix, with the residual that belongs to them,
    /// more accurately than they follow from the values; false if the solver cannot, or if its
    /// corrections determine them already.
    ///
    /// # Errors
    /// See [`LinearFailure`].
    fn determine_jump_multipliers(
        &mut self,
        iterate: &mut Iterate<'_, T>,
    ) -> Result<bool, LinearFailure> {
        let _ = iterate;
        Ok(false)
    }
    /// Whether the energy norm of the error of the last solution is within the tolerance, relative to
    /// `energy_norm`.
    fn is_accurate(&self, energy_norm: f64) -> bool;
    /// Sums of the absolute values of the terms of which the residual of unknown `i` is computed: terms
    /// of inactive unknowns, then terms of eliminated unknowns and of the load.
    fn residual_term_magnitudes(&self, i: usize, iterate: &Iterate<'_, T>) -> [f64; 2];
    /// The largest of the values whose rounding an inactive unknown `i` has, if the solver resolves differences of
    /// values to rounding; else infinite.
    fn size_of_values_near(&self, i: usize, iterate: &Iterate<'_, T>) -> f64 {
        let _ = (i, iterate);
        f64::INFINITY
    }
}
