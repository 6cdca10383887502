//! Errors of factorisations.

use faer::sparse::FaerError;

/// The reason why no factors of a matrix could be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FactorError {
    /// The symmetric matrix `A` is indefinite: some `x` has `x.A x < 0`.
    #[error("the matrix is not positive definite")]
    NotPositive,
    /// The matrix is singular to working precision. A matrix that is positive semidefinite up to
    /// rounding, as for a body without supports, is singular, not indefinite.
    #[error("the matrix is singular to working precision")]
    Singular,
    /// The factors exceed the memory or the range of the index type.
    #[error("the factors do not fit into memory")]
    OutOfMemory,
}

/// The [`FactorError`] for an error of faer, which means index overflow or lack of memory.
pub(crate) fn out_of_memory(_: FaerError) -> FactorError {
    FactorError::OutOfMemory
}
