//! Sparse matrices in compressed sparse rows.

use std::ops::Range;

use super::NO_INDEX;
use crate::memory::in_large_pages;
use crate::parallel::grouping::group_by_key;
use crate::parallel::map_groups;
use crate::parallel::vectors::{all, collect, concat, for_each_chunk, positions, starts};
use crate::real::Real;

/// Rows that one task computes at least.
const ROWS_PER_TASK: usize = 1024;

/// Most tasks of a product: the sum of each task has an index for every column.
const MAX_TASKS: usize = 32;

/// A sparse matrix in compressed sparse rows; columns ascend strictly in each row. It is square but inside of this
/// library, where some methods serve rectangular ones too.
///
/// # Panics
/// A method that takes the number of a row panics if there is no such row, one that takes a vector if that is shorter
/// than the matrix, and all of them may if the matrix is not [well formed](SparseMatrix::is_well_formed).
#[derive(Clone, Debug, PartialEq)]
pub struct SparseMatrix<T> {
    /// Start of each row in `columns` and `values`, and the number of entries at the end.
    pub row_starts: Vec<u32>,
    /// Column of each entry.
    pub columns: Vec<u32>,
    /// Value of each entry.
    pub values: Vec<T>,
}

impl<T> SparseMatrix<T> {
    /// Number of rows.
    pub fn size(&self) -> usize {
        self.row_starts.len().saturating_sub(1)
    }
    /// Number of stored entries.
    pub fn nonzeros(&self) -> usize {
        self.columns.len()
    }
    /// Columns and values of row `i`.
    #[inline]
    pub fn row(&self, i: usize) -> (&[u32], &[T]) {
        let range = self.row_starts[i] as usize..self.row_starts[i + 1] as usize;
        (&self.columns[range.clone()], &self.values[range])
    }
    /// Columns and values of the rows of a range, one row after the other.
    #[inline(always)]
    pub(crate) fn rows(&self, range: Range<usize>) -> impl Iterator<Item = (&[u32], &[T])> {
        let columns = &self.columns[..];
        // of one length, so that the bounds of a row are checked once
        let values = &self.values[..columns.len()];
        self.row_starts[range.start..=range.end].windows(2).map(move |bounds| {
            let row = bounds[0] as usize..bounds[1] as usize;
            (&columns[row.clone()], &values[row])
        })
    }
    /// Columns and mutable values of row `i`.
    pub(crate) fn row_mut(&mut self, i: usize) -> (&[u32], &mut [T]) {
        let range = self.row_starts[i] as usize..self.row_starts[i + 1] as usize;
        (&self.columns[range.clone()], &mut self.values[range])
    }
}

impl<T: Real> SparseMatrix<T> {
    /// The diagonal matrix with these entries.
    #[must_use]
    pub fn from_diagonal(values: Vec<T>) -> Self {
        let n = values.len() as u32;
        Self { row_starts: (0..=n).collect(), columns: (0..n).collect(), values }
    }
    /// Whether the three vectors describe a square matrix: row starts ascend, columns ascend strictly
    /// in each row and are less than the size, and every entry has a value.
    pub fn is_well_formed(&self) -> bool {
        let n = self.size();
        self.row_starts.first() == Some(&0)
            && self.row_starts.windows(2).all(|w| w[0] <= w[1])
            && self.row_starts[n] as usize == self.columns.len()
            && self.columns.len() == self.values.len()
            && all(n, |i| {
                let columns = self.row(i).0;
                columns.windows(2).all(|w| w[0] < w[1])
                    && columns.last().is_none_or(|&j| (j as usize) < n)
            })
    }
    /// The entry at (i, j), zero where none is stored.
    pub fn get(&self, i: usize, j: usize) -> T {
        let (columns, values) = self.row(i);
        columns.binary_search(&(j as u32)).map_or_else(|_| T::lit(0.0), |k| values[k])
    }
    /// Whether the matrix is symmetric: no two entries at (i, j) and (j, i) differ by more than the
    /// square root of machine epsilon times the geometric mean of the diagonal entries.
    pub fn is_symmetric(&self) -> bool {
        let diagonal: Vec<f64> = self.diagonal().iter().map(|d| d.to_f64().abs().sqrt()).collect();
        let tolerance = T::EPSILON.sqrt();
        (0..self.size()).all(|i| {
            let (columns, values) = self.row(i);
            columns.iter().zip(values).all(|(&j, a)| {
                let j = j as usize;
                let difference = (a.to_f64() - self.get(j, i).to_f64()).abs();
                difference <= tolerance * diagonal[i] * diagonal[j]
            })
        })
    }
    /// The diagonal.
    pub fn diagonal(&self) -> Vec<T> {
        let mut diagonal = vec![T::lit(0.0); self.size()];
        for_each_chunk(&mut diagonal, |range, diagonal| {
            diagonal.iter_mut().zip(range).for_each(|(d, i)| *d = self.get(i, i));
        });
        diagonal
    }
    /// The entry `(A x)_i`.
    #[inline]
    pub fn row_dot(&self, i: usize, x: &[T]) -> T {
        product_of_row(self.row(i), x)
    }
    /// The entry `(A x)_i`, products and sum in `f64`.
    #[inline]
    pub fn row_dot_f64(&self, i: usize, x: &[T]) -> f64 {
        let (columns, values) = self.row(i);
        columns.iter().zip(values).fold(0.0, |s, (&j, &a)| s + a.to_f64() * x[j as usize].to_f64())
    }
    /// The residual `r = b - A x` in `f64`. For `f32` data the products are exact.
    ///
    /// # Panics
    /// If `b` or `x` is shorter than `r`, or `r` is longer than the matrix has rows.
    pub fn residual_f64(&self, b: &[T], x: &[T], r: &mut [f64]) {
        self.residual_of(b, |j| x[j].to_f64(), r);
    }
    /// The residual `r = b - A x` in `f64` for values `x(j)` in `f64`.
    ///
    /// # Panics
    /// If `b` is shorter than `r`, or `r` is longer than the matrix has rows.
    pub fn residual_of(&self, b: &[T], x: impl Fn(usize) -> f64 + Sync, r: &mut [f64]) {
        for_each_chunk(r, |range, r| {
            for ((r, i), (columns, values)) in r.iter_mut().zip(range.clone()).zip(self.rows(range))
            {
                let product = |s: f64, (&j, a): (&u32, &T)| s + a.to_f64() * x(j as usize);
                *r = b[i].to_f64() - columns.iter().zip(values).fold(0.0, product);
            }
        });
    }
    /// The transpose of a matrix with this number of columns.
    #[must_use]
    pub fn transpose(&self, n_columns: usize) -> Self {
        let (row_starts, entries) = group_by_key(self.size(), n_columns, |i, put| {
            let (columns, values) = self.row(i);
            columns.iter().zip(values).for_each(|(&j, &a)| put(j, (i as u32, a)));
        });
        let columns = collect(entries.len(), |k| entries[k].0);
        let values = collect(entries.len(), |k| entries[k].1);
        Self { row_starts, columns, values }
    }
    /// The symmetric part `(A + A^T) / 2`, symmetric to the last bit. Its pattern is the union of
    /// those of `A` and `A^T`.
    #[must_use]
    pub fn symmetric_part(&self) -> Self {
        let transpose = self.transpose(self.size());
        let half = T::lit(0.5);
        let mut part = Self {
            row_starts: Vec::with_capacity(self.row_starts.len()),
            columns: Vec::with_capacity(self.nonzeros()),
            values: Vec::with_capacity(self.nonzeros()),
        };
        part.row_starts.push(0);
        for i in 0..self.size() {
            let ((here, ours), (there, theirs)) = (self.row(i), transpose.row(i));
            let (mut k, mut l) = (0, 0);
            while let Some(&j) = [here.get(k), there.get(l)].into_iter().flatten().min() {
                let mut sum = T::lit(0.0);
                if here.get(k) == Some(&j) {
                    sum += half * ours[k];
                    k += 1;
                }
                if there.get(l) == Some(&j) {
                    sum += half * theirs[l];
                    l += 1;
                }
                part.columns.push(j);
                part.values.push(sum);
            }
            part.row_starts.push(part.columns.len() as u32);
        }
        part
    }
}

/// Matrices made row by row. Their columns may be in any order.
impl<T: Real> SparseMatrix<T> {
    /// The rows of a range, which `add` appends to columns and values one by one.
    pub(crate) fn by_rows(
        range: Range<usize>,
        mut add: impl FnMut(usize, &mut Vec<u32>, &mut Vec<T>),
    ) -> Self {
        let (mut columns, mut values) = (Vec::new(), Vec::new());
        let mut row_starts = Vec::with_capacity(range.len() + 1);
        row_starts.push(0);
        for row in range.clone() {
            add(row, &mut columns, &mut values);
            row_starts.push(columns.len() as u32);
            if row == range.start {
                // most rows have about as many entries as the first one; vectors that grow are copied
                let expected = columns.len() * range.len();
                columns.reserve(expected);
                values.reserve(expected);
                (columns, values) = (in_large_pages(columns), in_large_pages(values));
            }
        }
        Self { row_starts, columns, values }
    }

    /// The rows that `work` computes for ranges of rows, one task each; one range where there is one thread.
    pub(crate) fn by_groups(n_rows: usize, work: &(dyn Fn(Range<usize>) -> Self + Sync)) -> Self {
        let length = match rayon::current_num_threads() {
            1 => n_rows,
            _ => ROWS_PER_TASK.max(n_rows / MAX_TASKS),
        };
        if n_rows <= length {
            return work(0..n_rows);
        }
        let groups = map_groups(n_rows, length, work);
        let ends: Vec<&[u32]> = groups.iter().map(|group| &group.row_starts[1..]).collect();
        let row_starts = starts(&ends);
        let (columns, values): (Vec<_>, Vec<_>) =
            groups.into_iter().map(|group| (group.columns, group.values)).unzip();
        Self { row_starts, columns: concat(columns), values: concat(values) }
    }

    /// The submatrix `A_II` for an ascending index set `I = free`: its row and column `k` are those of `free[k]` in
    /// `A`.
    pub(crate) fn submatrix(&self, free: &[u32]) -> Self {
        // columns that are not in the submatrix have the position `NO_INDEX`
        self.extract(free, |_| NO_INDEX - 1)
    }

    /// The lower triangle of the submatrix `A_II`, diagonal included.
    pub(crate) fn lower_triangle(&self, free: &[u32]) -> Self {
        self.extract(free, |k| k as u32)
    }

    /// The entries of each row `k` of the submatrix up to column `last(k)`.
    fn extract(&self, free: &[u32], last: impl Fn(usize) -> u32 + Sync) -> Self {
        let position = positions(self.size(), free);
        Self::by_groups(free.len(), &|range| {
            Self::by_rows(range, |k, columns, values| {
                let (neighbours, entries) = self.row(free[k] as usize);
                for (&j, &a) in neighbours.iter().zip(entries) {
                    let j = position[j as usize];
                    if j <= last(k) {
                        columns.push(j);
                        values.push(a);
                    }
                }
            })
        })
    }
}

/// The product of a row, columns and values, with a vector.
#[inline(always)]
pub(crate) fn product_of_row<T: Real>((columns, values): (&[u32], &[T]), x: &[T]) -> T {
    columns.iter().zip(values).fold(T::lit(0.0), |s, (&j, &a)| s + a * x[j as usize])
}

/// Sorts the entries of a row by their columns; generic over the scalar alone, so that the sorting code
/// is not compiled for every caller.
pub(crate) fn sort_by_column<T: Real>(row: &mut [(u32, T)]) {
    row.sort_unstable_by_key(|&(column, _)| column);
}
