//! A square submatrix: some rows and the same columns of a matrix.

use super::index::NO_INDEX;
use super::matrix::SparseMatrix;
use crate::real::Real;

/// A submatrix `A_II` in compressed sparse rows, or the lower triangle of one. Rows and columns are
/// numbered by their positions in the ascending index set `I`.
#[derive(Clone, Debug)]
pub(crate) struct Submatrix<T> {
    /// Start of each row in `columns` and `values`, and the number of entries at the end.
    pub row_starts: Vec<u32>,
    /// Column of each entry, ascending in each row.
    pub columns: Vec<u32>,
    /// Value of each entry.
    pub values: Vec<T>,
}

impl<T: Real> Submatrix<T> {
    /// `A_II` for the ascending index set `free`.
    pub fn new(matrix: &SparseMatrix<T>, free: &[u32]) -> Self {
        Self::extract(matrix, free, false)
    }

    /// The lower triangle of `A_II`, diagonal included, for the ascending index set `free`.
    pub fn lower_triangle(matrix: &SparseMatrix<T>, free: &[u32]) -> Self {
        Self::extract(matrix, free, true)
    }

    fn extract(matrix: &SparseMatrix<T>, free: &[u32], is_lower: bool) -> Self {
        let mut position = vec![NO_INDEX; matrix.size()];
        for (k, &i) in free.iter().enumerate() {
            position[i as usize] = k as u32;
        }
        // An upper bound on the number of entries avoids reallocation.
        let stored = free.iter().map(|&i| matrix.row(i as usize).0.len()).sum::<usize>();
        let capacity = if is_lower { (stored + free.len()).div_ceil(2) } else { stored };
        let mut submatrix = Self {
            row_starts: Vec::with_capacity(free.len() + 1),
            columns: Vec::with_capacity(capacity),
            values: Vec::with_capacity(capacity),
        };
        submatrix.row_starts.push(0);
        for (k, &i) in free.iter().enumerate() {
            let last = if is_lower { k as u32 } else { NO_INDEX - 1 };
            let (columns, values) = matrix.row(i as usize);
            for (&j, &a) in columns.iter().zip(values) {
                let j = position[j as usize];
                if j <= last {
                    submatrix.columns.push(j);
                    submatrix.values.push(a);
                }
            }
            submatrix.row_starts.push(submatrix.columns.len() as u32);
        }
        submatrix
    }
}

/// The submatrix of all rows and columns.
impl<T> From<SparseMatrix<T>> for Submatrix<T> {
    fn from(matrix: SparseMatrix<T>) -> Self {
        let SparseMatrix { row_starts, columns, values } = matrix;
        Self { row_starts, columns, values }
    }
}

/// The submatrix as a matrix of its own; not a lower triangle.
impl<T> From<Submatrix<T>> for SparseMatrix<T> {
    fn from(matrix: Submatrix<T>) -> Self {
        let Submatrix { row_starts, columns, values } = matrix;
        Self { row_starts, columns, values }
    }
}

impl<T> Submatrix<T> {
    /// Number of rows.
    pub fn size(&self) -> usize {
        self.row_starts.len() - 1
    }

    /// Columns and values of row `i`.
    pub fn row(&self, i: usize) -> (&[u32], &[T]) {
        let range = self.row_starts[i] as usize..self.row_starts[i + 1] as usize;
        (&self.columns[range.clone()], &self.values[range])
    }

    /// Columns and mutable values of row `i`.
    pub fn row_mut(&mut self, i: usize) -> (&[u32], &mut [T]) {
        let range = self.row_starts[i] as usize..self.row_starts[i + 1] as usize;
        (&self.columns[range.clone()], &mut self.values[range])
    }
}
