//! The symbolic part of a Cholesky factorisation, and views of matrices as faer's data structure.

use std::sync::Arc;

use faer::Side;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};

use super::error::{FactorError, out_of_memory};
use crate::algebra::SparseMatrix;
use crate::real::Real;

/// The pattern of the Cholesky factor of a symmetric matrix, which all factors of matrices with this pattern share.
pub(crate) type SymbolicFactor = Arc<SymbolicCholesky<u32>>;

/// The pattern for the lower triangle of a matrix in the order of approximate minimum degree (P. R. Amestoy, T. A.
/// Davis, I. S. Duff, SIAM J. Matrix Anal. Appl. 17 (1996), 886-905).
///
/// # Errors
/// [`FactorError::OutOfMemory`].
pub(crate) fn symbolic_factor<T: Real>(
    lower: &SparseMatrix<T>,
) -> Result<SymbolicFactor, FactorError> {
    // The transpose of the lower triangle is the upper triangle.
    let pattern = transpose_view(lower);
    let params = CholeskySymbolicParams::default();
    factorize_symbolic_cholesky(pattern.symbolic(), Side::Upper, SymmetricOrdering::Amd, params)
        .map(Arc::new)
        .map_err(out_of_memory)
}

/// A view of the transpose in compressed column storage: the row arrays of the matrix are the
/// column arrays of its transpose.
pub(crate) fn transpose_view<T>(matrix: &SparseMatrix<T>) -> SparseColMatRef<'_, u32, T> {
    let n = matrix.size();
    let pattern = faer::sparse::SymbolicSparseColMatRef::new_checked(
        n,
        n,
        &matrix.row_starts,
        None,
        &matrix.columns,
    );
    SparseColMatRef::new(pattern, &matrix.values)
}
