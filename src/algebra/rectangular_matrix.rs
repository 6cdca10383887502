//! Rectangular sparse matrices, and the product `P^T A P`.

use super::index::NO_INDEX;
use super::matrix::{SparseMatrix, transpose};
use super::row::sort_by_column;
use crate::real::Real;

/// A rectangular matrix in compressed sparse rows.
#[derive(Clone, Debug)]
pub(crate) struct RectangularMatrix<T> {
    /// Start of each row in `columns` and `values`, and the number of entries at the end.
    pub starts: Vec<u32>,
    pub columns: Vec<u32>,
    pub values: Vec<T>,
}

impl<T: Real> RectangularMatrix<T> {
    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// Columns and values of row `i`.
    #[inline(always)]
    pub fn row(&self, i: usize) -> (&[u32], &[T]) {
        let range = self.starts[i] as usize..self.starts[i + 1] as usize;
        (&self.columns[range.clone()], &self.values[range])
    }

    /// Row `i` times a vector, in the scalar of the vector.
    #[inline(always)]
    pub fn row_dot<S: Real>(&self, i: usize, x: &[S]) -> S {
        let (columns, values) = self.row(i);
        let product = |s, (&j, a): (&u32, &T)| s + S::lit(a.to_f64()) * x[j as usize];
        columns.iter().zip(values).fold(S::lit(0.0), product)
    }

    /// The transpose of a matrix with `n_columns` columns.
    pub fn transpose(&self, n_columns: usize) -> Self {
        let rows = (&self.starts[..], &self.columns[..], &self.values[..]);
        let (starts, columns, values) = transpose(rows, n_columns);
        Self { starts, columns, values }
    }
}

/// The Galerkin product `P^T A P` with a prolongation `P` of `n_coarse` columns.
pub(crate) fn galerkin_product<T: Real>(
    matrix: &SparseMatrix<T>,
    prolongation: &RectangularMatrix<T>,
    n_coarse: usize,
) -> SparseMatrix<T> {
    let transpose = prolongation.transpose(n_coarse);
    let zero = T::lit(0.0);
    let mut position = vec![NO_INDEX; n_coarse];
    let mut sums: Vec<(u32, T)> = Vec::new();
    let mut coarse =
        SparseMatrix { row_starts: vec![0_u32], columns: Vec::new(), values: Vec::new() };
    for row in 0..n_coarse {
        sums.clear();
        let (fine, weights) = transpose.row(row);
        for (&i, &weight) in fine.iter().zip(weights) {
            let (columns, values) = matrix.row(i as usize);
            for (&j, &a) in columns.iter().zip(values) {
                let a = weight * a;
                if a == zero {
                    continue;
                }
                let (targets, others) = prolongation.row(j as usize);
                for (&target, &other) in targets.iter().zip(others) {
                    let at = &mut position[target as usize];
                    if *at == NO_INDEX {
                        *at = sums.len() as u32;
                        sums.push((target, zero));
                    }
                    sums[*at as usize].1 += a * other;
                }
            }
        }
        sums.iter().for_each(|&(target, _)| position[target as usize] = NO_INDEX);
        sort_by_column(&mut sums);
        coarse.columns.extend(sums.iter().map(|s| s.0));
        coarse.values.extend(sums.iter().map(|s| s.1));
        coarse.row_starts.push(coarse.columns.len() as u32);
    }
    coarse
}
