//! A symmetric matrix of which only what is left of the diagonal is kept.
//!
//! What is done with a matrix row by row is bound by memory. A symmetric matrix has its right part on
//! the left too: while a row is at hand its share goes to those before it. With columns of two bytes
//! half of the entries take two fifths of what the matrix takes in `f64`, a seventh of it in `f32`.

use std::ops::Range;

use super::pieces::{PIECE, map, map_mut, sum_mut2};
use crate::algebra::SparseMatrix;
use crate::real::Real;

/// The rows of a symmetric matrix by pieces, so that pieces can be dealt with at the same time.
pub(super) struct Lower<S> {
    pieces: Vec<Piece<S>>,
}

/// The rows of a piece.
pub(super) struct Piece<S> {
    diagonal: Vec<S>,
    /// What is left of the diagonal inside the piece.
    starts: Vec<u32>,
    columns: Vec<u16>,
    values: Vec<S>,
    /// All of the rows that lies outside: row, column, value.
    outside: Vec<(u16, u32, S)>,
}

impl<S: Real> Piece<S> {
    fn new<'m, T: Real>(
        matrix: &SparseMatrix<T>,
        row: &impl Fn(usize) -> (&'m [u32], &'m [T]),
        convert: &impl Fn(T) -> S,
        range: Range<usize>,
    ) -> Self {
        let n_rows = range.len();
        let stored = (matrix.row_starts[range.end] - matrix.row_starts[range.start]) as usize;
        let mut piece = Self {
            diagonal: Vec::with_capacity(n_rows),
            starts: Vec::with_capacity(n_rows + 1),
            columns: Vec::with_capacity(stored / 2),
            values: Vec::with_capacity(stored / 2),
            outside: Vec::new(),
        };
        piece.starts.push(0);
        for i in range.clone() {
            let (columns, values) = row(i);
            let mut diagonal = S::lit(0.0);
            for (&j, &a) in columns.iter().zip(values) {
                let column = j as usize;
                if column == i {
                    diagonal = convert(a);
                } else if column < range.start {
                    piece.outside.push(((i - range.start) as u16, j, convert(a)));
                } else if column < i {
                    piece.columns.push((column - range.start) as u16);
                    piece.values.push(convert(a));
                } else if column >= range.end {
                    // the row below has it too, and both must be the same
                    let (columns, values) = row(column);
                    let a = columns.binary_search(&(i as u32)).map_or(a, |k| values[k]);
                    piece.outside.push(((i - range.start) as u16, j, convert(a)));
                }
            }
            piece.diagonal.push(diagonal);
            piece.starts.push(piece.columns.len() as u32);
        }
        piece
    }

    /// Sets an entry outside.
    fn replace_outside(&mut self, k: u16, column: u32, value: S) {
        let first = self.outside.partition_point(|entry| entry.0 < k);
        if let Some(entry) = self.outside[first..].iter_mut().find(|entry| entry.1 == column) {
            entry.2 = value;
        }
    }

    /// What row `k` of the piece has left of the diagonal: columns inside the piece and values.
    #[inline(always)]
    pub fn row(&self, k: usize) -> impl Iterator<Item = (usize, S)> {
        let range = self.starts[k] as usize..self.starts[k + 1] as usize;
        let columns = self.columns[range.clone()].iter().map(|&j| usize::from(j));
        columns.zip(self.values[range].iter().copied())
    }

    /// The diagonal of the piece.
    pub fn diagonal(&self) -> &[S] {
        &self.diagonal
    }

    /// All that lies outside: row of the piece, column, value.
    pub fn outside(&self) -> &[(u16, u32, S)] {
        &self.outside
    }
}

impl<S: Real> Lower<S> {
    /// Keeps a matrix, with rows that may differ from those stored in it, in another scalar.
    pub fn new<'m, T: Real>(
        matrix: &SparseMatrix<T>,
        row: impl Fn(usize) -> (&'m [u32], &'m [T]) + Sync,
        convert: impl Fn(T) -> S + Sync,
    ) -> Self {
        let pieces = map(matrix.size(), |range| Piece::new(matrix, &row, &convert, range));
        Self { pieces }
    }

    /// The pieces, in order; piece `k` has the rows from `k` times [`PIECE`] on.
    pub fn pieces(&self) -> &[Piece<S>] {
        &self.pieces
    }

    /// Takes over rows that have changed. As in [`Lower::new`] an entry is that of the lower of its
    /// two rows, so that the outcome is the same to the bit.
    pub fn replace<'m, T: Real>(
        &mut self,
        rows: &[u32],
        row: impl Fn(usize) -> (&'m [u32], &'m [T]),
        convert: impl Fn(T) -> S,
    ) {
        for &i in rows {
            let (own, k) = (i as usize / PIECE, i as usize % PIECE);
            let (columns, values) = row(i as usize);
            let mut at = self.pieces[own].starts[k] as usize;
            for (&j, &a) in columns.iter().zip(values).take_while(|(j, _)| **j <= i) {
                let a = convert(a);
                if j == i {
                    self.pieces[own].diagonal[k] = a;
                } else if j as usize / PIECE == own {
                    self.pieces[own].values[at] = a;
                    at += 1;
                } else {
                    self.pieces[own].replace_outside(k as u16, j, a);
                    let other = &mut self.pieces[j as usize / PIECE];
                    other.replace_outside((j as usize % PIECE) as u16, i, a);
                }
            }
        }
    }

    /// `p` becomes `z + beta p`, then `q` the product with it where free and zero where fixed;
    /// returns `p . q`.
    pub fn turn_and_multiply(
        &self,
        z: &[S],
        beta: S,
        fixed: &[bool],
        p: &mut [S],
        q: &mut [S],
    ) -> f64 {
        sum_mut2(p, q, |range, p, q| {
            let piece = &self.pieces[range.start / PIECE];
            let known = z[range].iter().zip(&piece.diagonal);
            for (k, (&z, &d)) in known.enumerate() {
                let value = z + beta * p[k];
                p[k] = value;
                let mut sum = d * value;
                for (j, a) in piece.row(k) {
                    sum += a * p[j];
                    q[j] += a * value;
                }
                q[k] = sum;
            }
            0.0
        });
        let p = &*p;
        let parts = map_mut(q, |range, q| {
            for &(k, j, a) in &self.pieces[range.start / PIECE].outside {
                q[usize::from(k)] += a * p[j as usize];
            }
            let directions = p[range.clone()].iter().zip(&fixed[range]);
            q.iter_mut().zip(directions).fold(0.0, |sum, (q, (p, &fixed))| {
                *q = if fixed { S::lit(0.0) } else { *q };
                sum + p.to_f64() * q.to_f64()
            })
        });
        parts.iter().sum()
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Second differences of more unknowns than a piece has, and couplings across.
    pub fn matrix(n: usize) -> SparseMatrix<f64> {
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
    fn rows_replaced_are_as_good_as_new() {
        let n = 2 * PIECE + 1000;
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
        let single = |a: f64| a as f32;
        let mut replaced = Lower::new(&before, |i| before.row(i), single);
        replaced.replace(&rows, |i| after.row(i), single);
        let new = Lower::new(&after, |i| after.row(i), single);
        for (one, other) in replaced.pieces.iter().zip(&new.pieces) {
            assert!(!one.outside.is_empty());
            assert_eq!(one.diagonal, other.diagonal);
            assert_eq!(one.values, other.values);
            assert_eq!(one.outside, other.outside);
        }
    }

    #[test]
    fn a_product_is_that_of_the_matrix() {
        let n = 2 * PIECE + 1000;
        let matrix = matrix(n);
        let lower = Lower::new(&matrix, |i| matrix.row(i), |a: f64| a);
        let some = |i: usize| ((i * 2_654_435_761) % 1000) as f64 / 500.0 - 1.0;
        let fixed: Vec<bool> = (0..n).map(|i| i % 7 == 3).collect();
        let free = |i: usize, x: f64| if fixed[i] { 0.0 } else { x };
        let z: Vec<f64> = (0..n).map(|i| free(i, some(i))).collect();
        let before: Vec<f64> = (0..n).map(|i| free(i, some(i + 7))).collect();
        let (mut p, mut q) = (before.clone(), vec![9.0; n]);
        let energy = lower.turn_and_multiply(&z, 0.5, &fixed, &mut p, &mut q);
        let mut expected = 0.0;
        for i in 0..n {
            assert_eq!(p[i], z[i] + 0.5 * before[i]);
            let product = free(i, matrix.row_dot(i, &p));
            assert!((q[i] - product).abs() < 1e-14, "{i}");
            expected += p[i] * product;
        }
        assert!((energy - expected).abs() < 1e-12 * expected);
    }
}
