//! The smallest eigenvalue of a preconditioned matrix.

use super::{ConjugateGradients, KrylovRun, StoppingRule};
use crate::algebra::{Distribution, SparseMatrix};
use crate::linear::Preconditioner;
use crate::parallel::vectors::{pseudorandom_signs, zeros};
use crate::real::Real;

/// Assumed lower bound of the ratio of the smallest eigenvalue to the smallest Ritz value of
/// [`eigenvalue_run`]. The Ritz value is not smaller than the eigenvalue, and close to it after a few iterations.
pub(crate) const EIGENVALUE_TO_RITZ_VALUE: f64 = 0.9;

/// Relative tolerance of the norm of the residual in [`eigenvalue_run`].
const TOLERANCE: f64 = 1e-6;

/// A run of conjugate gradients for a symmetric matrix `A` on the free unknowns, with a preconditioner `B` that must be
/// set up for the fixed unknowns. The smallest Ritz value estimates the smallest eigenvalue of `B A`; the solution is
/// not used. The entries of the right-hand side are the square roots of the positive `diagonal` of `A` with
/// pseudo-random signs: its components in all eigenvectors have similar norms, also in eigenvectors that are
/// concentrated in a region with a small coefficient.
pub(crate) fn eigenvalue_run<T: Real>(
    matrix: &SparseMatrix<T>,
    distribution: &dyn Distribution,
    preconditioner: &mut dyn Preconditioner<T>,
    fixed: &[bool],
    diagonal: impl Fn(usize) -> f64,
    max_iterations: usize,
) -> KrylovRun {
    let mut load = zeros(fixed.len());
    let free = (0..fixed.len()).filter(|&i| !fixed[i]);
    for (i, is_positive) in free.zip(pseudorandom_signs()) {
        let root = T::lit(diagonal(i).sqrt());
        load[i] = if is_positive { root } else { -root };
    }
    let rule =
        StoppingRule { absolute_tolerance: 0.0, relative_tolerance: TOLERANCE, max_iterations };
    let system = (&mut zeros(fixed.len())[..], &mut load[..]);
    ConjugateGradients::new(matrix, distribution).solve(fixed, preconditioner, system, rule)
}
