//! The trait of solvers of the linear systems of active sets.

use super::iterate::Iterate;
use crate::inequality::Outcome;
use crate::linear::direct::FactorError;
use crate::real::Real;

/// How accurately a linear system is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Accuracy {
    /// As accurately as the solver can: to [`LinearSolver::tolerance`].
    Full,
    /// Accurately enough to predict most contact states.
    Reduced,
}

/// How an iteration ends, or why a linear system was not solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// With this outcome, which no other linear solver would change.
    Outcome(Outcome),
    /// The iteration does not progress.
    Stagnation,
    /// The matrix of the active set is singular, where that of another one need not be.
    Singular,
    /// The linear solver does not fit the matrix, its iterations do not converge within their limit, or rounding leaves
    /// the certificate or the bound on the error too large: factors may do better.
    Unsuitable,
}

impl From<Outcome> for End {
    fn from(outcome: Outcome) -> Self {
        Self::Outcome(outcome)
    }
}

/// For factors of the matrix of an active set, after the whole matrix has been checked.
impl From<FactorError> for End {
    fn from(error: FactorError) -> Self {
        match error {
            // a negative pivot is one of rounding. Either bounds alone hold a part of
            // the domain, and no unknown is active there, or large penalties leave the matrix of this active set no digit
            FactorError::Singular | FactorError::NotPositive => Self::Singular,
            FactorError::OutOfMemory => Self::Outcome(Outcome::OutOfMemory),
        }
    }
}

/// A solver of the systems `A_II u_I = b_I - A_IE u_E`, where `I` are the inactive unknowns and `E`
/// the eliminated ones, which are fixed or active. Defaults are those of a solver with factors.
pub(crate) trait LinearSolver<T: Real>: Sync {
    /// Relative tolerance, in the energy norm, of systems solved with [`Accuracy::Full`]; zero if only
    /// rounding limits the accuracy.
    fn tolerance(&self) -> f64 {
        0.0
    }
    /// Prepares the solver for the linear system in which these unknowns are eliminated.
    fn set_eliminated(&mut self, eliminated: &[bool]) -> Result<(), End>;
    /// Corrects the values of the inactive unknowns, and the jump multipliers if the solver has them as unknowns, by
    /// the solution of the linear system with the residual as right-hand side. On return the residual of the iterate is
    /// that of the corrected values on all unknowns, computed in `f64`.
    fn correct(&mut self, iterate: &mut Iterate<'_, T>, accuracy: Accuracy) -> Result<(), End>;
    /// Computes the jump multipliers of a penalised matrix more accurately than they follow from the values, and the
    /// residual with these jump multipliers. False, without a change, if the matrix is not penalised or if
    /// [`LinearSolver::correct`] determines the jump multipliers already.
    fn determine_jump_multipliers(&mut self, iterate: &mut Iterate<'_, T>) -> Result<bool, End> {
        let _ = iterate;
        Ok(false)
    }
    /// Whether the energy norm of the error of the last solution is within the tolerance, relative to
    /// `energy_norm`.
    fn is_accurate(&self, energy_norm: f64) -> bool {
        let _ = energy_norm;
        true
    }
    /// Sums of the absolute values of the terms of the residual of unknown `i`: terms of inactive unknowns and jump
    /// multipliers, then terms of eliminated unknowns and of the load.
    fn residual_term_magnitudes(&self, i: usize, iterate: &Iterate<'_, T>) -> [f64; 2] {
        iterate.residual_term_magnitudes(i)
    }
}
