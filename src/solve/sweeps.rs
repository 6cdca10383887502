//! Gauss-Seidel sweeps in single precision.
//!
//! Within a piece of the unknowns these are Gauss-Seidel sweeps, between pieces Jacobi's, so that
//! pieces can be swept at the same time. The backward sweep is the transpose of the forward one.
//!
//! A sweep is bound by memory. Only what is left of the diagonal is kept, because a symmetric matrix
//! has its right part there too: once an unknown is known its share goes to those before it, while
//! the row is at hand. So the forward sweep returns the residual for nothing, and with columns of two
//! bytes and values of four it reads a seventh of what the matrix takes.

use super::lower::Lower;
use super::pieces::{PIECE, each_mut, sum_mut2, zeros};
use crate::algebra::SparseMatrix;
use crate::real::Real;

/// A symmetric matrix over a number, ready for sweeps.
pub(super) struct Sweeps {
    lower: Lower<f32>,
    /// One over the diagonal; zero where an unknown is fixed: there everything stays zero.
    inverse: Vec<f32>,
}

fn single<T: Real>(a: T, scale: f64) -> f32 {
    (a.to_f64() / scale) as f32
}

impl Sweeps {
    /// For a matrix, with rows that may differ from those stored in it, over a number.
    pub fn new<'m, T: Real>(
        matrix: &SparseMatrix<T>,
        row: impl Fn(usize) -> (&'m [u32], &'m [T]) + Sync,
        scale: f64,
    ) -> Self {
        let lower = Lower::new(matrix, row, |a| single(a, scale));
        Self { lower, inverse: zeros(matrix.size()) }
    }

    /// Takes over rows that have changed. As in [`Sweeps::new`] an entry is that of the lower of its
    /// two rows, so that the outcome is the same to the bit.
    pub fn replace<'m, T: Real>(
        &mut self,
        rows: &[u32],
        row: impl Fn(usize) -> (&'m [u32], &'m [T]),
        scale: f64,
    ) {
        self.lower.replace(rows, row, |a| single(a, scale));
    }

    /// Sets which unknowns are fixed.
    pub fn fix(&mut self, fixed: &[bool]) {
        let pieces = self.lower.pieces();
        each_mut(&mut self.inverse, |range, inverse| {
            let diagonal = pieces[range.start / PIECE].diagonal();
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
            let piece = &self.lower.pieces()[range.start / PIECE];
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
            for &(k, j, a) in self.lower.pieces()[range.start / PIECE].outside() {
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
            for &(k, j, a) in self.lower.pieces()[range.start / PIECE].outside() {
                r[usize::from(k)] -= a * old[j as usize];
            }
        });
        sum_mut2(x, r, |range, x, r| {
            let piece = &self.lower.pieces()[range.start / PIECE];
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
    use super::super::lower::tests::matrix;
    use super::*;

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
