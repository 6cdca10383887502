//! Products of the matrix of an inequality with vectors.

use std::ops::Range;

use super::penalised_product::PenalisedProduct;
use crate::algebra::{Inequality, SparseMatrix};
use crate::real::Real;

/// A symmetric matrix, stored in the form for which a product with a vector reads the fewest bytes.
pub(crate) enum Product<'m, T> {
    /// The stored entries.
    Assembled(&'m SparseMatrix<T>),
    /// The sum `K + M^T S M`: discontinuous linear functions with a penalty on jumps of means.
    Penalised(PenalisedProduct<'m, T>),
}

impl<'m, T: Real> Product<'m, T> {
    /// The matrix of an inequality.
    pub fn of(inequality: &'m Inequality<T>) -> Self {
        let Inequality { matrix, penalised, .. } = inequality;
        let product = penalised.as_ref().and_then(PenalisedProduct::new);
        product.map_or(Self::Assembled(matrix), Self::Penalised)
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        match self {
            Self::Assembled(matrix) => matrix.size(),
            Self::Penalised(product) => product.size(),
        }
    }

    /// The number of consecutive rows, those of one cell, that a range of [`Product::rows`] must not divide; one for
    /// stored entries.
    pub fn group(&self) -> usize {
        match self {
            Self::Assembled(_) => 1,
            Self::Penalised(product) => product.cell_size(),
        }
    }

    /// Computes the rows `range` of `q = A p` and returns their part of `p . q`. On fixed unknowns `p` must be zero,
    /// and `q` is set to zero. The range must not divide a group.
    pub fn rows(&self, range: Range<usize>, fixed: &[bool], p: &[T], q: &mut [T]) -> f64 {
        match self {
            Self::Assembled(matrix) => {
                let mut sum = 0.0;
                for (i, q) in range.zip(q) {
                    *q = if fixed[i] { T::lit(0.0) } else { matrix.row_dot(i, p) };
                    sum += p[i].to_f64() * q.to_f64();
                }
                sum
            }
            Self::Penalised(product) => product.rows(range, fixed, p, q),
        }
    }
}
