//! Gauss-Seidel sweeps in single precision.
//!
//! Within a piece of the unknowns these are Gauss-Seidel sweeps, between pieces Jacobi's, so that
//! pieces can be swept at the same time. The backward sweep is the transpose of the forward one.
//!
//! A sweep is bound by memory. Only what is left of the diagonal is kept, because a symmetric matrix
//! has its right part there too: once an unknown is known its share goes to those before it, while
//! the row is at hand. So the forward sweep returns the residual at no cost, and with columns of two
//! bytes and values of four both together read a seventh of what the matrix takes twice.

use crate::algebra::SparseMatrix;
use crate::parallel::vectors::{PIECE, each_mut, map, sum_mut2, zeros};
use crate::real::Real;

/// A symmetric matrix over a number, ready for sweeps.
pub(crate) struct Sweeps {
    pieces: Vec<Piece>,
    /// One over the diagonal; zero where an unknown is fixed: there everything stays zero.
    inverse: Vec<f32>,
}

/// The rows of a piece.
struct Piece {
    diagonal: Vec<f32>,
    /// What is left of the diagonal inside the piece.
    starts: Vec<u32>,
    columns: Vec<u16>,
    values: Vec<f32>,
    /// All of the rows that lies outside: row, column, value.
    outside: Vec<(u16, u32, f32)>,
}

#[inline(always)]
fn single<T: Real>(a: T, scale: f64) -> f32 {
    (a.to_f64() / scale) as f32
}

impl Piece {
    fn new<'m, T: Real>(
        matrix: &SparseMatrix<T>,
        row: &impl Fn(usize) -> (&'m [u32], &'m [T]),
        scale: f64,
        range: std::ops::Range<usize>,
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
        let single = |a: T| single(a, scale);
        piece.starts.push(0);
        for i in range.clone() {
            let (columns, values) = row(i);
            let mut diagonal = 0.0;
            for (&j, &a) in columns.iter().zip(values) {
                let column = j as usize;
                if column == i {
                    diagonal = single(a);
                } else if column < range.start {
                    piece.outside.push(((i - range.start) as u16, j, single(a)));
                } else if column < i {
                    piece.columns.push((column - range.start) as u16);
                    piece.values.push(single(a));
                } else if column >= range.end {
                    // the row below has it too, and both must be the same
                    let (columns, values) = row(column);
                    let a = columns.binary_search(&(i as u32)).map_or(a, |k| values[k]);
                    piece.outside.push(((i - range.start) as u16, j, single(a)));
                }
            }
            piece.diagonal.push(diagonal);
            piece.starts.push(piece.columns.len() as u32);
        }
        piece
    }

    /// Sets an entry outside.
    fn replace_outside(&mut self, k: u16, column: u32, value: f32) {
        let first = self.outside.partition_point(|entry| entry.0 < k);
        if let Some(entry) = self.outside[first..].iter_mut().find(|entry| entry.1 == column) {
            entry.2 = value;
        }
    }

    #[inline(always)]
    fn row(&self, k: usize) -> impl Iterator<Item = (usize, f32)> {
        let range = self.starts[k] as usize..self.starts[k + 1] as usize;
        let columns = self.columns[range.clone()].iter().map(|&j| usize::from(j));
        columns.zip(self.values[range].iter().copied())
    }
}

impl Sweeps {
    /// For a matrix, with rows that may differ from those stored in it, over a number.
    pub fn new<'m, T: Real>(
        matrix: &SparseMatrix<T>,
        row: impl Fn(usize) -> (&'m [u32], &'m [T]) + Sync,
        scale: f64,
    ) -> Self {
        let n = matrix.size();
        let pieces = map(n, |range| Piece::new(matrix, &row, scale, range));
        Self { pieces, inverse: zeros(n) }
    }

    /// Takes over rows that have changed. As in [`Sweeps::new`] an entry is that of the lower of its
    /// two rows, so that the outcome is the same to the bit.
    pub fn replace<'m, T: Real>(
        &mut self,
        rows: &[u32],
        row: impl Fn(usize) -> (&'m [u32], &'m [T]),
        scale: f64,
    ) {
        for &i in rows {
            let own = i as usize / PIECE;
            let k = i as usize % PIECE;
            let (columns, values) = row(i as usize);
            let mut at = self.pieces[own].starts[k] as usize;
            for (&j, &a) in columns.iter().zip(values).take_while(|(j, _)| **j <= i) {
                let a = single(a, scale);
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

    /// Sets which unknowns are fixed.
    pub fn fix(&mut self, fixed: &[bool]) {
        let pieces = &self.pieces;
        each_mut(&mut self.inverse, |range, inverse| {
            let diagonal = &pieces[range.start / PIECE].diagonal;
            for ((inverse, &d), &fixed) in inverse.iter_mut().zip(diagonal).zip(&fixed[range]) {
                *inverse = if fixed || d == 0.0 { 0.0 } else { 1.0 / d };
            }
        });
    }

    /// One over the diagonal, zero where fixed.
    pub fn inverse(&self) -> &[f32] {
        &self.inverse
    }

    /// A forward sweep from zero; `r` becomes `b - A x` where free and zero where fixed.
    pub fn forward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        sum_mut2(x, r, |range, x, r| {
            let piece = &self.pieces[range.start / PIECE];
            let known = b[range.clone()].iter().zip(&self.inverse[range]);
            for (k, (&b, &inverse)) in known.enumerate() {
                let sum = piece.row(k).fold(b, |sum, (j, a)| sum - a * x[j]);
                let value = sum * inverse;
                x[k] = value;
                r[k] = 0.0;
                piece.row(k).for_each(|(j, a)| r[j] -= a * value);
            }
            0.0
        });
        let x = &*x;
        each_mut(r, |range, r| {
            for &(k, j, a) in &self.pieces[range.start / PIECE].outside {
                r[usize::from(k)] -= a * x[j as usize];
            }
            for (r, &inverse) in r.iter_mut().zip(&self.inverse[range]) {
                *r = if inverse == 0.0 { 0.0 } else { *r };
            }
        });
    }

    /// A backward sweep, from `x`. `r` is scratch.
    pub fn backward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        let old = &*x;
        each_mut(r, |range, r| {
            r.copy_from_slice(&b[range.clone()]);
            for &(k, j, a) in &self.pieces[range.start / PIECE].outside {
                r[usize::from(k)] -= a * old[j as usize];
            }
        });
        sum_mut2(x, r, |range, x, r| {
            let piece = &self.pieces[range.start / PIECE];
            for (k, &inverse) in self.inverse[range].iter().enumerate().rev() {
                let sum = piece.row(k).fold(r[k], |sum, (j, a)| sum - a * x[j]);
                let value = sum * inverse;
                x[k] = value;
                piece.row(k).for_each(|(j, a)| r[j] -= a * value);
            }
            0.0
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Second differences of more unknowns than a piece has, and couplings across.
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
        let mut replaced = Sweeps::new(&before, |i| before.row(i), 2.0);
        replaced.replace(&rows, |i| after.row(i), 2.0);
        let new = Sweeps::new(&after, |i| after.row(i), 2.0);
        for (one, other) in replaced.pieces.iter().zip(&new.pieces) {
            assert!(!one.outside.is_empty());
            assert_eq!(one.diagonal, other.diagonal);
            assert_eq!(one.values, other.values);
            assert_eq!(one.outside, other.outside);
        }
    }

    #[test]
    fn a_sweep_forward_and_one_backward_make_a_symmetric_operator_and_know_their_residual() {
        let n = 2 * PIECE + 1000;
        let matrix = matrix(n);
        let mut sweeps = Sweeps::new(&matrix, |i| matrix.row(i), 2.0);
        let fixed: Vec<bool> = (0..n).map(|i| i % 7 == 3).collect();
        sweeps.fix(&fixed);
        let some = |seed: usize| -> Vec<f32> {
            let one = |i: usize| ((i * 2_654_435_761 + seed) % 1000) as f32 / 500.0 - 1.0;
            (0..n).map(|i| if fixed[i] { 0.0 } else { one(i) }).collect()
        };
        let apply = |b: &[f32]| {
            let (mut x, mut r) = (vec![9.0; n], vec![9.0; n]);
            sweeps.forward(b, &mut x, &mut r);
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
            sweeps.backward(b, &mut x, &mut r);
            x
        };
        let (b, c) = (some(0), some(77));
        let dot = |x: &[f32], y: &[f32]| -> f64 {
            x.iter().zip(y).map(|(&x, &y)| f64::from(x) * f64::from(y)).sum()
        };
        let (bc, cb) = (dot(&apply(&b), &c), dot(&apply(&c), &b));
        let size = (dot(&apply(&b), &b) * dot(&apply(&c), &c)).sqrt();
        assert!((bc - cb).abs() < 1e-6 * size, "{bc} {cb} {size}");
        assert!(size > 0.1 * dot(&b, &b), "{size}");
    }
}
