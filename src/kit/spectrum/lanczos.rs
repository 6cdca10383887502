//! The method of Lanczos, with full reorthogonalisation.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::algebra::SparseMatrix;
use crate::kit::split_mix::SplitMix64;
use crate::linear::{FactorError, Factors};
use crate::readable_debug::debug_by_display;

/// Largest number of steps, each of which keeps a vector.
const MAX_STEPS: usize = 1000;

/// The smallest and the largest eigenvalue of `B^-1 A`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Extremes {
    /// The smallest eigenvalue.
    pub smallest: f64,
    /// The largest eigenvalue.
    pub largest: f64,
}

impl Extremes {
    /// The condition number: the quotient of the two.
    pub fn condition(&self) -> f64 {
        self.largest / self.smallest
    }
}

/// The reason why an eigenvalue was not found. `Debug` prints the message.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumError {
    /// The residual did not fall to the tolerance, or a number is not finite.
    #[error("{0}")]
    NotReached(String),
    /// A matrix has no Cholesky factor.
    #[error(transparent)]
    NotFactored(#[from] FactorError),
    /// The two matrices have different sizes, or none.
    #[error("{0}")]
    Sizes(String),
}

debug_by_display!(SpectrumError);

/// The extreme eigenvalues of `B^-1 A` for symmetric positive definite matrices `A` and `B`.
///
/// The method of Lanczos runs in the inner product of `B`, in which `B^-1 A` and `A^-1 B` are symmetric;
/// the smallest eigenvalue is the reciprocal of the largest one of `A^-1 B` (shift and invert at
/// zero). The initial vector is pseudo-random, with a fixed seed.
///
/// The tolerance bounds the residual relative to the eigenvalue, and with it the relative distance
/// to the nearest eigenvalue. It must be finer than the accuracy wanted: with clustered eigenvalues
/// a coarse tolerance accepts an eigenvalue inside the cluster. Rounding adds the condition number
/// times the rounding unit to the smallest eigenvalue.
///
/// # Errors
/// [`SpectrumError`].
pub fn extreme_eigenvalues(
    a: &SparseMatrix<f64>,
    b: &SparseMatrix<f64>,
    tolerance: f64,
) -> Result<Extremes, SpectrumError> {
    if a.size() != b.size() || a.size() == 0 {
        let message =
            format!("matrices of {} and {} rows have no common spectrum", a.size(), b.size());
        return Err(SpectrumError::Sizes(message));
    }
    let largest = largest_eigenvalue([a, b], b, tolerance)?;
    let smallest = 1.0 / largest_eigenvalue([b, a], b, tolerance)?;
    Ok(Extremes { smallest, largest })
}

/// The largest eigenvalue of `inverted^-1 applied`, which is symmetric in the inner product of `b`, in which the vectors
/// are orthonormal.
fn largest_eigenvalue(
    [applied, inverted]: [&SparseMatrix<f64>; 2],
    b: &SparseMatrix<f64>,
    tolerance: f64,
) -> Result<f64, SpectrumError> {
    let size = b.size();
    let all: Vec<u32> = (0..size as u32).collect();
    let factors = Factors::new(inverted, true, &all)?;
    let mut generator = SplitMix64(1);
    let mut next: Vec<f64> = (0..size).map(|_| generator.unit() - 0.5).collect();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let (mut diagonal, mut off_diagonal) = (Vec::new(), Vec::new());
    let mut check = 4;
    let mut length = norm(&next, b);
    loop {
        next.iter_mut().for_each(|x| *x /= length);
        let mut image = product(applied, &next);
        factors.solve_in_place(&mut image, 1);
        basis.push(next);
        diagonal.push(orthogonalise(&mut image, &basis, b));
        length = norm(&image, b);
        let steps = basis.len();
        if !length.is_finite() {
            let message = format!("after {steps} steps a number is not finite");
            return Err(SpectrumError::NotReached(message));
        }
        // up to rounding the Krylov space is invariant
        let is_invariant = length <= f64::EPSILON * diagonal[steps - 1].abs();
        let is_last = steps == size.min(MAX_STEPS) || is_invariant;
        if steps >= check || is_last {
            let (value, last_entry) = largest_of_tridiagonal(&diagonal, &off_diagonal);
            let residual = (length * last_entry / value).abs();
            if residual <= tolerance && value > 0.0 {
                return Ok(value);
            }
            if is_last {
                return Err(SpectrumError::NotReached(format!(
                    "after {steps} steps the eigenvalue {value:e} is known to a relative residual of {residual:.1e} only, asked for {tolerance:.1e}",
                )));
            }
            check = steps + steps / 4 + 1;
        }
        off_diagonal.push(length);
        next = image;
    }
}

fn product(matrix: &SparseMatrix<f64>, x: &[f64]) -> Vec<f64> {
    (0..matrix.size()).map(|i| matrix.row_dot(i, x)).collect()
}

/// The norm in the inner product of `b`.
fn norm(x: &[f64], b: &SparseMatrix<f64>) -> f64 {
    dot(x, &product(b, x)).sqrt()
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// Makes a vector orthogonal to a basis in the inner product of `b`, twice because of rounding
/// errors; returns its component along the last vector of the basis.
fn orthogonalise(x: &mut [f64], basis: &[Vec<f64>], b: &SparseMatrix<f64>) -> f64 {
    let mut along_last = 0.0;
    for _ in 0..2 {
        let image = product(b, x);
        let mut component = 0.0;
        for v in basis {
            component = dot(v, &image);
            x.iter_mut().zip(v).for_each(|(x, v)| *x -= component * v);
        }
        along_last += component;
    }
    along_last
}

/// The largest eigenvalue of a tridiagonal matrix, and the last entry of its eigenvector.
fn largest_of_tridiagonal(diagonal: &[f64], off_diagonal: &[f64]) -> (f64, f64) {
    let n = diagonal.len();
    let matrix = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => off_diagonal[i.min(j)],
        _ => 0.0,
    });
    let eigen = SymmetricEigen::new(matrix);
    let k = eigen.eigenvalues.imax();
    (eigen.eigenvalues[k], eigen.eigenvectors[(n - 1, k)])
}
