//! The smallest eigenvalue of a preconditioned matrix.

use super::{ConjugateGradients, KrylovRun, Product, StoppingRule};
use crate::algebra::Distribution;
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
        let root = T::lit(diagonal(i).sqrt());
        load[i] = if is_positive { root } else { -root };
    }
    let rule =
        StoppingRule { absolute_tolerance: 0.0, relative_tolerance: TOLERANCE, max_iterations };
    let system = (&mut zeros(fixed.len())[..], &mut load[..]);
    ConjugateGradients::new(matrix, distribution).solve(fixed, preconditioner, system, rule)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::SparseMatrix;
    use crate::linear::direct::FactorError;

    /// Division by the diagonal.
    struct Jacobi(Vec<f64>);

    impl Preconditioner<f64> for Jacobi {
        fn name(&self) -> &'static str {
            "test"
        }
        fn set_fixed(&mut self, _fixed: &[bool]) -> Result<(), FactorError> {
            Ok(())
        }
        fn apply(&mut self, r: &[f64], z: &mut [f64]) {
            z.iter_mut().zip(r).zip(&self.0).for_each(|((z, r), d)| *z = r / d);
        }
    }

    /// The smallest eigenvalue belongs to a block whose coefficient is that of all others divided by `contrast`.
    #[test]
    fn an_eigenvector_in_a_region_with_a_small_coefficient_is_found() {
        let n = 40;
        for contrast in [1.0, 1e8, 1e16] {
            let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
            for i in 0..n {
                let block = i / 2 * 2;
                let (alpha, s) = if i < 2 { (1.0 / contrast, 0.9) } else { (1.0, 0.1) };
                matrix.columns.extend([block, block + 1]);
                let entry = |j| alpha * if i == j { 1.0 } else { s };
                matrix.values.extend([block, block + 1].map(entry));
                matrix.row_starts.push(matrix.columns.len() as u32);
            }
            let diagonal: Vec<f64> = matrix.diagonal();
            let run = eigenvalue_run(
                Product::Assembled(&matrix),
                None,
                &mut Jacobi(diagonal.clone()),
                &vec![false; n as usize],
                |i| diagonal[i],
                100,
            );
            let (smallest, _) = run.ritz.unwrap();
            assert!((0.1 - 1e-6..0.1 / EIGENVALUE_TO_RITZ_VALUE).contains(&smallest), "{smallest}");
        }
    }
}
