//! Gauss-Seidel sweeps.
//!
//! Within a piece of the unknowns these are Gauss-Seidel sweeps, between pieces Jacobi's, so that
//! pieces can be swept at the same time. The backward sweep is the transpose of the forward one.
//! `inverse` is one over the diagonal, and zero where an unknown is fixed: there everything stays.

use super::pieces::each_mut;
use crate::algebra::SparseMatrix;
use crate::real::Real;

/// One over the diagonal, zero where fixed.
pub(super) fn invert_diagonal<T: Real>(diagonal: &[T], fixed: &[bool], inverse: &mut [T]) {
    let (zero, one) = (T::lit(0.0), T::lit(1.0));
    each_mut(inverse, |range, piece| {
        for ((inverse, &d), &fixed) in
            piece.iter_mut().zip(&diagonal[range.clone()]).zip(&fixed[range])
        {
            *inverse = if fixed || d == zero { zero } else { one / d };
        }
    });
}

/// A forward sweep from zero.
pub(super) fn forward<T: Real>(a: &SparseMatrix<T>, inverse: &[T], b: &[T], x: &mut [T]) {
    each_mut(x, |range, x| {
        let start = range.start;
        for (k, i) in range.enumerate() {
            if inverse[i] == T::lit(0.0) {
                x[k] = T::lit(0.0);
                continue;
            }
            let (before, _) = x.split_at(k);
            let (columns, values) = a.row(i);
            let mut sum = b[i];
            for (&j, &a) in columns.iter().zip(values) {
                let j = j as usize;
                if j >= i {
                    break;
                }
                // what lies before this piece wraps to a number beyond its end
                if let Some(&x) = before.get(j.wrapping_sub(start)) {
                    sum -= a * x;
                }
            }
            x[k] = sum * inverse[i];
        }
    });
}

/// `b - A x` where free, zero where fixed.
pub(super) fn residual<T: Real>(a: &SparseMatrix<T>, inverse: &[T], b: &[T], x: &[T], r: &mut [T]) {
    each_mut(r, |range, r| {
        for (i, r) in range.zip(r) {
            *r = if inverse[i] == T::lit(0.0) { T::lit(0.0) } else { b[i] - a.row_dot(i, x) };
        }
    });
}

/// A backward sweep, from `x`. `old` is scratch.
pub(super) fn backward<T: Real>(
    a: &SparseMatrix<T>,
    inverse: &[T],
    b: &[T],
    x: &mut [T],
    old: &mut [T],
) {
    if x.len() > super::pieces::PIECE {
        old.copy_from_slice(x);
    }
    let old = &*old;
    each_mut(x, |range, x| {
        let start = range.start;
        for (k, i) in range.enumerate().rev() {
            if inverse[i] == T::lit(0.0) {
                continue;
            }
            let (columns, values) = a.row(i);
            let mut sum = b[i];
            for (&j, &a) in columns.iter().zip(values) {
                let j = j as usize;
                sum -= a * *x.get(j.wrapping_sub(start)).unwrap_or_else(|| &old[j]);
            }
            x[k] += sum * inverse[i];
        }
    });
}
