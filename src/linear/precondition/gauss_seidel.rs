//! Symmetric Gauss-Seidel smoothing in single precision.
//!
//! Within a chunk of unknowns an iteration is a Gauss-Seidel iteration, between chunks a Jacobi
//! iteration, so that chunks run in parallel. The backward iteration is the transpose of the forward
//! one.
//!
//! Let `D` be the diagonal of the matrix `A`, `L` the strictly lower triangle within chunks, `O` the entries between
//! chunks, and `E` a non-negative diagonal. The iteration with `M = D + E + L` reduces the energy of the error if
//! `M + M^T - A = D + 2 E - O` is positive definite. `E` is zero in rows in which the entry of `D` is at least the sum
//! of the entries of `|O|`; these are all rows of a matrix with negative off-diagonal entries and non-negative row
//! sums. In other rows `E` makes `D + 2 E` larger than that sum (A. H. Baker, R. D. Falgout, T. V. Kolev, U. M. Yang,
//! SIAM J. Sci. Comput. 33 (2011), 2864-2887). Meshes of flat tetrahedra with a numbering without locality need a
//! positive `E`: Jacobi's iteration diverges for their matrices.
//!
//! An iteration is limited by memory bandwidth. Only the strictly lower triangle of each chunk is
//! stored: by symmetry, a row `i` of this triangle updates both the equation of unknown `i` and, once `x_i` is
//! computed, the residuals of the preceding unknowns. The forward iteration therefore returns the
//! residual without a further product. With column indices of two bytes and values of four, a
//! forward and a backward iteration read a seventh of the bytes of two products with the matrix.

use crate::algebra::SparseMatrix;
use crate::parallel::for_each_item;
use crate::parallel::vectors::{
    chunk_length, for_each_chunk, map_chunks, sum_chunks_of_two, zeros,
};
use crate::real::Real;

/// The entry of `D + 2 E`, divided by the sum of the absolute values of the entries between chunks, in rows in which
/// `E` is positive.
const MARGIN: f64 = 1.1;

/// The value of `inverse_diagonal` for a kept unknown, which is free but not smoothed. With this value a forward
/// iteration from zero leaves the unknown at zero up to rounding. The values for smoothed unknowns are much larger, the
/// value for fixed unknowns is zero.
const KEPT_INVERSE_DIAGONAL: f32 = 1e-30;

/// The Gauss-Seidel smoother of a symmetric matrix divided by a scale.
pub(crate) struct GaussSeidel {
    chunks: Vec<ChunkRows>,
    /// The reciprocals of the entries of `D + E`; zero for fixed unknowns, whose values then stay zero,
    /// and for unknowns whose diagonal entry is zero; [`KEPT_INVERSE_DIAGONAL`] for kept unknowns.
    inverse_diagonal: Vec<f32>,
}

/// The rows of a chunk.
struct ChunkRows {
    diagonal: Vec<f32>,
    /// The diagonal `E` that is added to the diagonal; empty if it is zero.
    added: Vec<f32>,
    /// Start of each row in `columns` and `values`, and the number of entries at the end.
    starts: Vec<u32>,
    /// The strictly lower triangle of the diagonal block of the chunk; columns relative to the chunk.
    columns: Vec<u16>,
    values: Vec<f32>,
    /// The entries outside of the diagonal block (`O`): row relative to the chunk, column, value.
    outside: Vec<(u16, u32, f32)>,
}

#[inline(always)]
fn to_single<T: Real>(a: T, scale: f64) -> f32 {
    (a.to_f64() / scale) as f32
}

impl ChunkRows {
    /// The rows `range`, given by `row`, divided by `scale`; see [`GaussSeidel::new`].
    fn new<'m, T: Real>(
        matrix: &SparseMatrix<T>,
        row: &impl Fn(usize) -> (&'m [u32], &'m [T]),
        scale: f64,
        range: std::ops::Range<usize>,
    ) -> Self {
        let n_rows = range.len();
        let stored = (matrix.row_starts[range.end] - matrix.row_starts[range.start]) as usize;
        let mut chunk = Self {
            diagonal: Vec::with_capacity(n_rows),
            added: Vec::new(),
            starts: Vec::with_capacity(n_rows + 1),
            columns: Vec::with_capacity(stored / 2),
            values: Vec::with_capacity(stored / 2),
            outside: Vec::new(),
        };
        let to_single = |a: T| to_single(a, scale);
        chunk.starts.push(0);
        for i in range.clone() {
            let (columns, values) = row(i);
            let mut diagonal = 0.0;
            for (&j, &a) in columns.iter().zip(values) {
                let column = j as usize;
                if column == i {
                    diagonal = to_single(a);
                } else if column < range.start {
                    chunk.outside.push(((i - range.start) as u16, j, to_single(a)));
                } else if column < i {
                    chunk.columns.push((column - range.start) as u16);
                    chunk.values.push(to_single(a));
                } else if column >= range.end {
                    // The value is taken from the row with the larger index, so that both rows
                    // contain the same value.
                    let (columns, values) = row(column);
                    let a = columns.binary_search(&(i as u32)).map_or(a, |k| values[k]);
                    chunk.outside.push(((i - range.start) as u16, j, to_single(a)));
                }
            }
            chunk.diagonal.push(diagonal);
            chunk.starts.push(chunk.columns.len() as u32);
        }
        chunk.update_added();
        chunk
    }

    /// Computes the diagonal `E`.
    fn update_added(&mut self) {
        self.added.clear();
        for of_row in self.outside.chunk_by(|one, other| one.0 == other.0) {
            let k = usize::from(of_row[0].0);
            let sum: f64 = of_row.iter().map(|entry| f64::from(entry.2.abs())).sum();
            let diagonal = f64::from(self.diagonal[k]);
            // sum and diagonal entry are equal up to rounding in some rows of second differences: no increase there
            if sum > diagonal * (1.0 + 1e-4) {
                self.added.resize(self.diagonal.len(), 0.0);
                self.added[k] = (0.5 * (MARGIN * sum - diagonal)) as f32;
            }
        }
    }

    /// Replaces the value in row `k`, relative to the chunk, and a column outside of the chunk.
    fn replace_outside(&mut self, k: u16, column: u32, value: f32) {
        let first = self.outside.partition_point(|entry| entry.0 < k);
        if let Some(entry) = self.outside[first..].iter_mut().find(|entry| entry.1 == column) {
            entry.2 = value;
        }
    }

    /// Columns and values of row `k` of the strictly lower triangle, both indices relative to the chunk.
    #[inline(always)]
    fn lower_row(&self, k: usize) -> impl Iterator<Item = (usize, f32)> {
        let range = self.starts[k] as usize..self.starts[k + 1] as usize;
        let columns = self.columns[range.clone()].iter().map(|&j| usize::from(j));
        columns.zip(self.values[range].iter().copied())
    }
}

impl GaussSeidel {
    /// The smoother of a matrix with the pattern of `matrix` and the rows `row(i)`, with ascending
    /// columns, divided by `scale`. All unknowns are fixed until [`GaussSeidel::set_fixed`].
    pub fn new<'m, T: Real>(
        matrix: &SparseMatrix<T>,
        row: impl Fn(usize) -> (&'m [u32], &'m [T]) + Sync,
        scale: f64,
    ) -> Self {
        let n = matrix.size();
        let chunks = map_chunks(n, |range| ChunkRows::new(matrix, &row, scale, range));
        Self { chunks, inverse_diagonal: zeros(n) }
    }

    /// The number of rows of a chunk.
    fn chunk_length(&self) -> usize {
        chunk_length(self.inverse_diagonal.len(), 1)
    }

    /// Replaces the values of the given rows and of the columns with the same indices; the pattern
    /// must be the same as before. As in [`GaussSeidel::new`], of two symmetric entries the one in
    /// the row with the larger index is used, so that both functions have the same result to the
    /// last bit. [`GaussSeidel::set_fixed`] must follow.
    pub fn replace_rows<'m, T: Real>(
        &mut self,
        rows: &[u32],
        row: impl Fn(usize) -> (&'m [u32], &'m [T]),
        scale: f64,
    ) {
        let length = self.chunk_length();
        for &i in rows {
            let own = i as usize / length;
            let k = i as usize % length;
            let (columns, values) = row(i as usize);
            let mut at = self.chunks[own].starts[k] as usize;
            for (&j, &a) in columns.iter().zip(values).take_while(|(j, _)| **j <= i) {
                let a = to_single(a, scale);
                if j == i {
                    self.chunks[own].diagonal[k] = a;
                } else if j as usize / length == own {
                    self.chunks[own].values[at] = a;
                    at += 1;
                } else {
                    self.chunks[own].replace_outside(k as u16, j, a);
                    let other = &mut self.chunks[j as usize / length];
                    other.replace_outside((j as usize % length) as u16, i, a);
                }
            }
        }
        let chunks = self.chunks.iter_mut().collect();
        for_each_item(chunks, &|_, chunk: &mut ChunkRows| chunk.update_added());
    }

    /// Sets the fixed unknowns, and the unknowns `kept`, which are neither fixed nor smoothed: the forward
    /// iteration returns their residuals, and the backward iteration does not change their values.
    pub fn set_fixed(&mut self, fixed: &[bool], kept: &[u32]) {
        let (length, chunks) = (self.chunk_length(), &self.chunks);
        for_each_chunk(&mut self.inverse_diagonal, |range, inverse| {
            let ChunkRows { diagonal, added, .. } = &chunks[range.start / length];
            for ((inverse, &d), &fixed) in inverse.iter_mut().zip(diagonal).zip(&fixed[range]) {
                *inverse = if fixed || d == 0.0 { 0.0 } else { 1.0 / d };
            }
            for (inverse, &added) in inverse.iter_mut().zip(added) {
                *inverse /= 1.0 + added * *inverse;
            }
        });
        kept.iter().for_each(|&i| self.inverse_diagonal[i as usize] = KEPT_INVERSE_DIAGONAL);
    }

    /// The reciprocals of the entries of `D + E`, zero for fixed unknowns, positive for kept ones.
    pub fn inverse_diagonal(&self) -> &[f32] {
        &self.inverse_diagonal
    }

    /// A forward iteration from zero: sets `x`, and `r = b - A x` on free unknowns, zero on fixed ones.
    pub fn forward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        let length = self.chunk_length();
        sum_chunks_of_two(x, r, 1, |range, x, r| {
            let chunk = &self.chunks[range.start / length];
            let equations = b[range.clone()].iter().zip(&self.inverse_diagonal[range]);
            for (k, (&b, &inverse)) in equations.enumerate() {
                let sum = chunk.lower_row(k).fold(b, |sum, (j, a)| sum - a * x[j]);
                let value = sum * inverse;
                x[k] = value;
                // the residual of a fixed unknown is set to zero below
                let own = chunk.added.get(k).map_or(0.0, |added| added * value);
                r[k] = if inverse > KEPT_INVERSE_DIAGONAL { own } else { sum };
                chunk.lower_row(k).for_each(|(j, a)| r[j] -= a * value);
            }
            0.0
        });
        let x = &*x;
        for_each_chunk(r, |range, r| {
            for &(k, j, a) in &self.chunks[range.start / length].outside {
                r[usize::from(k)] -= a * x[j as usize];
            }
            for (r, &inverse) in r.iter_mut().zip(&self.inverse_diagonal[range]) {
                *r = if inverse == 0.0 { 0.0 } else { *r };
            }
        });
    }

    /// A backward iteration from `x`. `r` is workspace.
    pub fn backward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        let length = self.chunk_length();
        let old = &*x;
        for_each_chunk(r, |range, r| {
            r.copy_from_slice(&b[range.clone()]);
            for &(k, j, a) in &self.chunks[range.start / length].outside {
                r[usize::from(k)] -= a * old[j as usize];
            }
        });
        sum_chunks_of_two(x, r, 1, |range, x, r| {
            let chunk = &self.chunks[range.start / length];
            for (k, &inverse) in self.inverse_diagonal[range].iter().enumerate().rev() {
                let first = r[k] + chunk.added.get(k).map_or(0.0, |added| added * x[k]);
                let sum = chunk.lower_row(k).fold(first, |sum, (j, a)| sum - a * x[j]);
                // the value of a fixed unknown is zero since the forward iteration
                let value = if inverse > KEPT_INVERSE_DIAGONAL { sum * inverse } else { x[k] };
                x[k] = value;
                chunk.lower_row(k).for_each(|(j, a)| r[j] -= a * value);
            }
            0.0
        });
    }
}
