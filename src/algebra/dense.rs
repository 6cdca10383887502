//! Inverses of small dense matrices, stored by rows, and orthonormal bases.

use crate::real::Real;

/// Inverts an `n` by `n` matrix in place by Gauss-Jordan elimination with partial pivoting. Returns
/// whether the determinant is positive, `None` if the matrix is singular or an entry is not finite.
pub(crate) fn invert_in_place(a: &mut [f64], n: usize) -> Option<bool> {
    let mut is_positive = true;
    let mut exchanges = Vec::with_capacity(n);
    for k in 0..n {
        let size = |i: &usize| a[i * n + k].abs();
        let pivot = (k..n).max_by(|i, j| size(i).total_cmp(&size(j)))?;
        let value = a[pivot * n + k];
        if !(value.is_finite() && value != 0.0) {
            return None;
        }
        is_positive ^= value < 0.0;
        if pivot != k {
            is_positive ^= true;
            for j in 0..n {
                a.swap(pivot * n + j, k * n + j);
            }
        }
        exchanges.push(pivot);
        a[k * n + k] = 1.0;
        for j in 0..n {
            a[k * n + j] /= value;
        }
        for i in (0..n).filter(|&i| i != k) {
            let factor = a[i * n + k];
            a[i * n + k] = 0.0;
            for j in 0..n {
                a[i * n + j] -= factor * a[k * n + j];
            }
        }
    }
    for (k, &pivot) in exchanges.iter().enumerate().rev() {
        if pivot != k {
            for i in 0..n {
                a.swap(i * n + pivot, i * n + k);
            }
        }
    }
    Some(is_positive)
}

/// Appends a vector to the orthonormal vectors `basis`, one after the other, made orthonormal to them;
/// leaves the basis as it is, and returns `false`, where the part of the vector orthogonal to the basis
/// has a norm of at most `tolerance`. Gram-Schmidt orthogonalisation, twice for rounding.
pub(crate) fn extend_basis(
    basis: &mut Vec<f64>,
    vector: impl Iterator<Item = f64>,
    tolerance: f64,
) -> bool {
    let start = basis.len();
    basis.extend(vector);
    let (basis_vectors, rest) = basis.split_at_mut(start);
    for _ in 0..2 {
        for other in basis_vectors.chunks_exact(rest.len().max(1)) {
            let product = rest.iter().zip(other).fold(0.0, |s, (a, b)| s + a * b);
            rest.iter_mut().zip(other).for_each(|(a, b)| *a -= product * b);
        }
    }
    let norm = rest.iter().fold(0.0, |s, a| s + a * a).sqrt();
    let is_new = norm > tolerance;
    rest.iter_mut().for_each(|a| *a /= norm);
    if !is_new {
        basis.truncate(start);
    }
    is_new
}

/// Inverts a symmetric positive definite block in place on its free unknowns, by Gauss-Jordan
/// elimination; false if a pivot is not positive, with the block destroyed.
pub(crate) fn invert_positive_definite<T: Real>(a: &mut [T], size: usize, fixed: &[bool]) -> bool {
    let one = T::lit(1.0);
    for k in (0..size).filter(|&k| !fixed[k]) {
        let pivot = a[k * size + k];
        if pivot <= T::lit(0.0) || !pivot.to_f64().is_finite() {
            return false;
        }
        let inverse = one / pivot;
        a[k * size + k] = one;
        for j in 0..size {
            a[k * size + j] *= inverse;
        }
        for i in (0..size).filter(|&i| i != k) {
            let factor = a[i * size + k];
            a[i * size + k] = T::lit(0.0);
            for j in 0..size {
                let term = factor * a[k * size + j];
                a[i * size + j] -= term;
            }
        }
    }
    true
}
