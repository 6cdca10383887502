//! The smallest eigenvalue of a preconditioned matrix.

use super::{ConjugateGradients, KrylovRun, Product, StoppingRule};
use crate::algebra::Distribution;
use crate::linear::Preconditioner;
use crate::parallel::vectors::{pseudorandom_signs, zeros};
use crate::real::Real;

/// Assumed lower bound of the ratio of the smallest eigenvalue to the smallest Ritz value of
/// [`eigenvalue_run`]. The Ritz value is above the eigenvalue and close to it after a few iterations.
pub(crate) const EIGENVALUE_TO_RITZ_VALUE: f64 = 0.9;

/// Relative tolerance of the linear system that is solved for its Ritz values alone.
const TOLERANCE: f64 = 1e-6;

/// Conjugate gradients for a symmetric matrix on the unknowns that are not fixed, whose smallest Ritz value
/// estimates the smallest eigenvalue of `B A`. The right-hand side has the size of the positive `diagonal` and
/// pseudo-random signs, so that every eigenvector has a component. The preconditioner must be set up for
/// the fixed unknowns.
pub(crate) fn eigenvalue_run<T: Real>(
    matrix: Product<'_, T>,
    distribution: Option<&dyn Distribution>,
    preconditioner: &mut dyn Preconditioner<T>,
    fixed: &[bool],
    diagonal: impl Fn(usize) -> f64,
    max_iterations: usize,
) -> KrylovRun {
    let mut load = zeros(fixed.len());
    let free = (0..fixed.len()).filter(|&i| !fixed[i]);
    for (i, is_positive) in free.zip(pseudorandom_signs()) {
        let d = T::lit(diagonal(i));
        load[i] = if is_positive { d } else { -d };
    }
    let rule = StoppingRule { norm: 0.0, reduction: TOLERANCE, max_iterations };
    let system = (&mut zeros(fixed.len())[..], &mut load[..]);
    ConjugateGradients::new(matrix, distribution).solve(fixed, preconditioner, system, rule)
}
