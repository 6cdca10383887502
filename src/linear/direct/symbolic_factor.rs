//! The symbolic part of a Cholesky factorisation, and views of matrices as faer's data structure.

use std::sync::Arc;

use faer::Side;
use faer::perm::Perm;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};

use super::error::{FactorError, out_of_memory};
use crate::algebra::SparseMatrix;
use crate::real::Real;

/// The pattern of the Cholesky factor of a symmetric matrix, for an order of elimination.
#[derive(Clone, Debug)]
pub(crate) struct SymbolicFactor(Arc<SymbolicCholesky<u32>>);

impl SymbolicFactor {
    /// The pattern for the lower triangle of a matrix and an order of elimination: a permutation of the
    /// rows, or approximate minimum degree for `None`.
    ///
    /// # Errors
    /// [`FactorError::OutOfMemory`].
    ///
    /// # Panics
    /// If `order` is not a permutation of the rows.
    pub fn new<T: Real>(
        lower: &SparseMatrix<T>,
        order: Option<Vec<u32>>,
    ) -> Result<Self, FactorError> {
        let order = order.map(|order| {
            let mut inverse = vec![0; order.len()];
            order.iter().enumerate().for_each(|(k, &i)| inverse[i as usize] = k as u32);
            Perm::new_checked(order.into(), inverse.into(), lower.size())
        });
        let ordering = match &order {
            Some(order) => SymmetricOrdering::Custom(order.as_ref()),
            None => SymmetricOrdering::Amd,
        };
        // The transpose of the lower triangle is the upper triangle.
        let pattern = transpose_view(lower);
        let params = CholeskySymbolicParams::default();
        let symbolic =
            factorize_symbolic_cholesky(pattern.symbolic(), Side::Upper, ordering, params)
                .map_err(out_of_memory)?;
        Ok(Self(Arc::new(symbolic)))
    }

    /// The pattern as faer's data structure, which all factors of matrices with this pattern share.
    pub fn symbolic_cholesky(&self) -> Arc<SymbolicCholesky<u32>> {
        self.0.clone()
    }
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
