//! Inverses of small symmetric matrices on some of their rows, stored by rows.

use crate::real::Real;

/// Inverts a symmetric positive definite block in place on its free unknowns, by Gauss-Jordan
/// elimination; false if a pivot is not positive, with the block destroyed.
#[inline(always)]
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
