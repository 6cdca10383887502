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

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Rows of a chunk of the matrices below.
    const LENGTH: usize = 1 << 12;

    fn dot(x: &[f32], y: &[f32]) -> f64 {
        x.iter().zip(y).map(|(&x, &y)| f64::from(x) * f64::from(y)).sum()
    }

    /// Asserts that an operator is symmetric in its products with two vectors; returns the size of the products.
    pub fn check_symmetry(apply: impl Fn(&[f32]) -> Vec<f32>, b: &[f32], c: &[f32]) -> f64 {
        let (bc, cb) = (dot(&apply(b), c), dot(&apply(c), b));
        let size = (dot(&apply(b), b) * dot(&apply(c), c)).sqrt();
        assert!((bc - cb).abs() < 1e-6 * size, "{bc} {cb} {size}");
        size
    }

    /// Second differences with more unknowns than a chunk, and couplings between chunks.
    fn matrix(n: usize) -> SparseMatrix<f64> {
        let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        for i in 0..n {
            let far = (i + n / 2) % n;
            let mut columns = vec![(i, 4.0), (far, -0.5)];
            if i > 0 {
                columns.push((i - 1, -1.0));
            }
            if i + 1 < n {
                columns.push((i + 1, -1.0));
            }
            columns.sort_by_key(|c| c.0);
            matrix.columns.extend(columns.iter().map(|c| c.0 as u32));
            matrix.values.extend(columns.iter().map(|c| c.1));
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        matrix
    }

    #[test]
    fn replaced_rows_equal_new_ones() {
        let n = 2 * LENGTH + 1000;
        let before = matrix(n);
        let mut after = before.clone();
        for i in 0..n {
            let range = after.row_starts[i] as usize..after.row_starts[i + 1] as usize;
            for (j, a) in after.columns[range.clone()].iter().zip(&mut after.values[range]) {
                if i % 5 == 1 || *j as usize % 5 == 1 {
                    *a *= 1.0 + 1e-3 * (i + *j as usize) as f64;
                }
            }
        }
        let rows: Vec<u32> = (0..n as u32)
            .filter(|&i| before.row(i as usize).1 != after.row(i as usize).1)
            .collect();
        assert!(rows.len() > n / 5 && rows.len() < n);
        let mut replaced = GaussSeidel::new(&before, |i| before.row(i), 2.0);
        replaced.replace_rows(&rows, |i| after.row(i), 2.0);
        let new = GaussSeidel::new(&after, |i| after.row(i), 2.0);
        for (one, other) in replaced.chunks.iter().zip(&new.chunks) {
            assert!(!one.outside.is_empty());
            assert_eq!(one.diagonal, other.diagonal);
            assert_eq!(one.values, other.values);
            assert_eq!(one.outside, other.outside);
        }
    }

    /// Each unknown is coupled with one unknown of each of the two other chunks, so strongly that Jacobi's iteration
    /// between chunks diverges.
    #[test]
    fn strong_couplings_between_chunks_leave_the_smoother_positive() {
        let (n, coupling) = (3 * LENGTH, 0.9);
        let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        for i in 0..n {
            for j in [0, 1, 2].map(|chunk| chunk * LENGTH + i % LENGTH) {
                matrix.columns.push(j as u32);
                matrix.values.push(if i == j { 1.0 } else { coupling });
            }
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        let mut smoother = GaussSeidel::new(&matrix, |i| matrix.row(i), 1.0);
        let rows: Vec<u32> = (0..n as u32).collect();
        for _ in 0..2 {
            smoother.set_fixed(&vec![false; n], &[]);
            let (b, mut x, mut r) = (vec![1.0; n], vec![9.0; n], vec![9.0; n]);
            smoother.forward(&b, &mut x, &mut r);
            let residual = 1.0 - f64::from(x[0]) * (1.0 + 2.0 * coupling);
            assert!(r.iter().all(|&r| (f64::from(r) - residual).abs() < 1e-6), "{}", r[0]);
            smoother.backward(&b, &mut x, &mut r);
            // with a positive smoother the iterate lies between zero and the solution 1 / 2.8
            let solution = 1.0 / (1.0 + 2.0 * coupling) as f32;
            assert!(x.iter().all(|&x| x > 0.0 && x < 1.001 * solution), "{} {solution}", x[0]);
            smoother.replace_rows(&rows, |i| matrix.row(i), 1.0);
        }
    }

    #[test]
    fn unknowns_that_are_kept_have_a_residual_and_keep_their_values() {
        let n = 1000;
        let matrix = matrix(n);
        let mut smoother = GaussSeidel::new(&matrix, |i| matrix.row(i), 4.0);
        let kept: Vec<u32> = (0..n as u32).step_by(3).collect();
        smoother.set_fixed(&vec![false; n], &kept);
        let (b, mut x, mut r) = (vec![1.0; n], vec![9.0; n], vec![9.0; n]);
        smoother.forward(&b, &mut x, &mut r);
        assert!(kept.iter().all(|&i| x[i as usize].abs() < 1e-20 && r[i as usize] > 1.0));
        kept.iter().for_each(|&i| x[i as usize] = 0.5);
        smoother.backward(&b, &mut x, &mut r);
        assert!(kept.iter().all(|&i| x[i as usize] == 0.5));
        assert!((0..n).all(|i| i % 3 == 0 || x[i] > 0.25));
    }

    #[test]
    fn forward_and_backward_iteration_are_a_symmetric_operator_and_return_the_residual() {
        let n = 2 * LENGTH + 1000;
        let matrix = matrix(n);
        let mut smoother = GaussSeidel::new(&matrix, |i| matrix.row(i), 2.0);
        let fixed: Vec<bool> = (0..n).map(|i| i % 7 == 3).collect();
        smoother.set_fixed(&fixed, &[]);
        let vector = |seed: usize| -> Vec<f32> {
            let entry = |i: usize| ((i * 2_654_435_761 + seed) % 1000) as f32 / 500.0 - 1.0;
            (0..n).map(|i| if fixed[i] { 0.0 } else { entry(i) }).collect()
        };
        let apply = |b: &[f32]| {
            let (mut x, mut r) = (vec![9.0; n], vec![9.0; n]);
            smoother.forward(b, &mut x, &mut r);
            let residual = |i: usize| {
                let product =
                    |s: f64, (&j, a): (&u32, &f64)| s - a / 2.0 * f64::from(x[j as usize]);
                let (columns, values) = matrix.row(i);
                columns.iter().zip(values).fold(f64::from(b[i]), product)
            };
            for i in 0..n {
                let expected = if fixed[i] { 0.0 } else { residual(i) };
                assert!((f64::from(r[i]) - expected).abs() < 1e-5, "{i}");
            }
            smoother.backward(b, &mut x, &mut r);
            x
        };
        let b = vector(0);
        let size = check_symmetry(apply, &b, &vector(77));
        assert!(size > 0.1 * dot(&b, &b), "{size}");
    }
}
