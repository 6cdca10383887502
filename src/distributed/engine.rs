//! A library for distributed matrices, as the solver uses it: preconditioners of distributed matrices.

use std::fmt::Debug;

use crate::linear::FactorError;

/// A library for matrices whose rows are distributed over processes.
///
/// All parts call its functions, and those of its [`EngineSolver`]s, equally often and in the same order. A function
/// that fails in one part fails in all: corrections are then not numbers, and the engine keeps the reason for
/// [`take_failure`](Self::take_failure).
pub trait Engine: Debug + Send + Sync {
    /// Name and version, for reports.
    fn name(&self) -> String;
    /// A preconditioner of a symmetric positive definite matrix.
    fn solver(&self, rows: &dyn OwnRows, method: EngineMethod) -> Box<dyn EngineSolver>;
    /// The reason for the last failure of a function in this part since the last call, if there is one. A matrix without
    /// factors is no failure.
    fn take_failure(&self) -> Option<String>;
}

/// How an engine solves systems.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EngineMethod {
    /// By a cycle of algebraic multigrid, symmetric and positive definite.
    Multigrid,
    /// By factors.
    Factors,
}

/// The rows of a distributed matrix that one part owns: consecutive ones.
pub trait OwnRows {
    /// The number of the first row among the rows of all parts.
    fn first(&self) -> u64;
    /// How many there are.
    fn count(&self) -> usize;
    /// Replaces the list by the entries of an own row: numbers of columns, in any order, and values.
    fn row(&self, own: usize, entries: &mut Vec<(u64, f64)>);
}

/// A preconditioner of a distributed matrix.
pub trait EngineSolver: Send + Sync {
    /// Sets which own unknowns are fixed: the rows and columns of fixed unknowns become those of a multiple of the
    /// identity, whose factor is of the size of the other diagonal entries.
    ///
    /// # Errors
    /// In all parts: [`FactorError::NotPositive`] if the matrix is not positive definite then, or the engine has
    /// failed; [`FactorError::OutOfMemory`].
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError>;
    /// Sets `correction` to the preconditioner times `residual`, both at own unknowns.
    fn apply(&mut self, residual: &[f64], correction: &mut [f64]);
}
