//! Rectangular sparse matrices, the product `P^T A P`, and the submatrix of some unknowns: the product with the columns
//! `P` of the identity.

use std::ops::Range;

use super::NO_INDEX;
use super::matrix::{SparseMatrix, sort_by_column, transpose};
use crate::parallel::map_groups;
use crate::parallel::vectors::{concat, positions, starts};
use crate::real::Real;

/// Rows that one task computes at least.
const ROWS_PER_TASK: usize = 1024;

/// Most tasks of a product: the sum of each task has an index for every column.
const MAX_TASKS: usize = 32;

/// A rectangular matrix in compressed sparse rows.
#[derive(Clone, Debug)]
pub(crate) struct RectangularMatrix<T> {
    /// Start of each row in `columns` and `values`, and the number of entries at the end.
    pub starts: Vec<u32>,
    pub columns: Vec<u32>,
    pub values: Vec<T>,
}

impl<T: Real> RectangularMatrix<T> {
    /// The rows of a range, which `add` appends to columns and values one by one.
    pub fn by_rows(
        range: Range<usize>,
        mut add: impl FnMut(usize, &mut Vec<u32>, &mut Vec<T>),
    ) -> Self {
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for row in range {
            add(row, &mut columns, &mut values);
            starts.push(columns.len() as u32);
        }
        Self { starts, columns, values }
    }

    /// The rows that `work` computes for ranges of rows, one task each; one range where there is one thread.
    pub fn by_groups(n_rows: usize, work: &(dyn Fn(Range<usize>) -> Self + Sync)) -> Self {
        let length = match rayon::current_num_threads() {
            1 => n_rows,
            _ => ROWS_PER_TASK.max(n_rows / MAX_TASKS),
        };
        if n_rows <= length {
            return work(0..n_rows);
        }
        Self::joined(map_groups(n_rows, length, work))
    }

    /// The rows of all groups, one group after the other.
    fn joined(groups: Vec<Self>) -> Self {
        let ends: Vec<&[u32]> = groups.iter().map(|group| &group.starts[1..]).collect();
        let starts = starts(&ends);
        let (columns, values): (Vec<_>, Vec<_>) =
            groups.into_iter().map(|group| (group.columns, group.values)).unzip();
        Self { starts, columns: concat(columns), values: concat(values) }
    }

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

/// The Galerkin product `P^T A P` with a prolongation `P` of `n_coarse` columns, as `P^T (A P)`: each row of `A P` is
/// computed once, however many coarse functions do not vanish there.
pub(crate) fn galerkin_product<T: Real>(
    matrix: &SparseMatrix<T>,
    prolongation: &RectangularMatrix<T>,
    n_coarse: usize,
) -> SparseMatrix<T> {
    let image = RectangularMatrix::by_groups(matrix.size(), &|range| {
        let mut sum = SparseSum::new(n_coarse);
        RectangularMatrix::by_rows(range, |i, columns, values| {
            if prolongation.row(i).0.is_empty() {
                // no row of P^T reads this row of A P
                return;
            }
            let (neighbours, entries) = matrix.row(i);
            for (&j, &a) in neighbours.iter().zip(entries) {
                if a != T::lit(0.0) {
                    sum.add(a, prolongation.row(j as usize));
                }
            }
            sum.move_to(columns, values);
        })
    });
    let transpose = prolongation.transpose(n_coarse);
    let coarse = RectangularMatrix::by_groups(n_coarse, &|range| {
        let mut sum = SparseSum::new(n_coarse);
        RectangularMatrix::by_rows(range, |row, columns, values| {
            let (fine, weights) = transpose.row(row);
            for (&i, &weight) in fine.iter().zip(weights) {
                sum.add(weight, image.row(i as usize));
            }
            sort_by_column(&mut sum.terms);
            sum.move_to(columns, values);
        })
    });
    SparseMatrix { row_starts: coarse.starts, columns: coarse.columns, values: coarse.values }
}

/// A sum of multiples of sparse rows.
pub(crate) struct SparseSum<T> {
    /// Columns with their entries, in the order in which they were added.
    terms: Vec<(u32, T)>,
    /// The index in `terms` of each column; [`NO_INDEX`] for a column without a term.
    places: Vec<u32>,
}

impl<T: Real> SparseSum<T> {
    /// The empty sum of rows with this number of columns.
    pub fn new(n_columns: usize) -> Self {
        Self { terms: Vec::new(), places: vec![NO_INDEX; n_columns] }
    }

    /// Adds a multiple of a row.
    #[inline(always)]
    fn add(&mut self, factor: T, (columns, values): (&[u32], &[T])) {
        for (&column, &value) in columns.iter().zip(values) {
            self.add_term(column, factor * value);
        }
    }

    /// Adds a term.
    #[inline(always)]
    pub fn add_term(&mut self, column: u32, value: T) {
        let place = &mut self.places[column as usize];
        if *place == NO_INDEX {
            *place = self.terms.len() as u32;
            self.terms.push((column, T::lit(0.0)));
        }
        self.terms[*place as usize].1 += value;
    }

    /// Appends the terms to a list of columns and one of values, and leaves the empty sum.
    pub fn move_to(&mut self, columns: &mut Vec<u32>, values: &mut Vec<T>) {
        for &(column, value) in &self.terms {
            self.places[column as usize] = NO_INDEX;
            columns.push(column);
            values.push(value);
        }
        self.terms.clear();
    }
}

impl<T: Real> SparseMatrix<T> {
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
        if free.is_empty() {
            return Self { row_starts: vec![0], columns: Vec::new(), values: Vec::new() };
        }
        let position = positions(self.size(), free);
        let of_rows = |rows: Range<usize>| {
            // an upper bound on the number of entries avoids reallocation
            let stored = rows.clone().map(|k| self.row(free[k] as usize).0.len()).sum();
            let mut part = RectangularMatrix {
                starts: vec![0],
                columns: Vec::with_capacity(stored),
                values: Vec::with_capacity(stored),
            };
            for k in rows {
                let (columns, entries) = self.row(free[k] as usize);
                for (&j, &a) in columns.iter().zip(entries) {
                    let j = position[j as usize];
                    if j <= last(k) {
                        part.columns.push(j);
                        part.values.push(a);
                    }
                }
                part.starts.push(part.columns.len() as u32);
            }
            part
        };
        let RectangularMatrix { starts: row_starts, columns, values } =
            RectangularMatrix::by_groups(free.len(), &of_rows);
        Self { row_starts, columns, values }
    }
}
