//! A matrix restricted to some of its rows and columns.

use super::SparseMatrix;
use crate::real::Real;

/// Marks an unknown that the restriction leaves out.
const OUT: u32 = u32::MAX;

/// Some rows and columns of a matrix, renumbered in their order.
#[derive(Clone, Debug)]
pub(crate) struct Submatrix<T> {
    /// Start of each row, and the number of entries at the end.
    pub row_starts: Vec<u32>,
    /// Column of each entry in the new numbering, ascending in each row.
    pub columns: Vec<u32>,
    /// Value of each entry.
    pub values: Vec<T>,
}

impl<T: Real> Submatrix<T> {
    /// The rows and columns `free`, ascending.
    pub fn new(matrix: &SparseMatrix<T>, free: &[u32]) -> Self {
        Self::restrict(matrix, free, false)
    }

    /// The same, without what lies right of the diagonal.
    pub fn left_of_diagonal(matrix: &SparseMatrix<T>, free: &[u32]) -> Self {
        Self::restrict(matrix, free, true)
    }

    fn restrict(matrix: &SparseMatrix<T>, free: &[u32], left: bool) -> Self {
        let mut new = vec![OUT; matrix.size()];
        for (k, &i) in free.iter().enumerate() {
            new[i as usize] = k as u32;
        }
        // A bound on what will be kept saves growing; the order of `free` keeps columns ascending.
        let rows = free.iter().map(|&i| matrix.row(i as usize).0.len()).sum::<usize>();
        let bound = if left { (rows + free.len()).div_ceil(2) } else { rows };
        let mut restricted = Self {
            row_starts: Vec::with_capacity(free.len() + 1),
            columns: Vec::with_capacity(bound),
            values: Vec::with_capacity(bound),
        };
        restricted.row_starts.push(0);
        for (k, &i) in free.iter().enumerate() {
            let last = if left { k as u32 } else { OUT - 1 };
            let (columns, values) = matrix.row(i as usize);
            for (&j, &a) in columns.iter().zip(values) {
                let j = new[j as usize];
                if j <= last {
                    restricted.columns.push(j);
                    restricted.values.push(a);
                }
            }
            restricted.row_starts.push(restricted.columns.len() as u32);
        }
        restricted
    }

    /// The diagonal, zero where none is stored.
    pub fn diagonal(&self) -> Vec<T> {
        let entry = |i: usize| {
            let (columns, values) = self.row(i);
            columns.binary_search(&(i as u32)).map_or(T::lit(0.0), |k| values[k])
        };
        (0..self.size()).map(entry).collect()
    }
}

/// All rows and columns.
impl<T> From<SparseMatrix<T>> for Submatrix<T> {
    fn from(matrix: SparseMatrix<T>) -> Self {
        let SparseMatrix { row_starts, columns, values } = matrix;
        Self { row_starts, columns, values }
    }
}

impl<T> Submatrix<T> {
    /// Number of rows.
    pub fn size(&self) -> usize {
        self.row_starts.len() - 1
    }

    /// Columns and values of a row.
    pub fn row(&self, i: usize) -> (&[u32], &[T]) {
        let range = self.row_starts[i] as usize..self.row_starts[i + 1] as usize;
        (&self.columns[range.clone()], &self.values[range])
    }

    /// Columns of a row, and its values to be changed.
    pub fn row_mut(&mut self, i: usize) -> (&[u32], &mut [T]) {
        let range = self.row_starts[i] as usize..self.row_starts[i + 1] as usize;
        (&self.columns[range.clone()], &mut self.values[range])
    }
}
