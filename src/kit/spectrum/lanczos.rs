//! The method of Lanczos, with full reorthogonalisation.

use nalgebra::{DMatrix, SymmetricEigen};

use super::positive_definite::PositiveDefinite;
use crate::kit::split_mix::SplitMix64;
use crate::readable_debug::debug_by_display;

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
    /// The residual did not fall to the tolerance.
    #[error("{0}")]
    NotReached(String),
    /// The steps after which a number is not finite, or the matrix is not positive in a direction.
    #[error("after {0} steps the matrix proved not to be positive definite or not finite")]
    NotPositive(usize),
    /// The two matrices have different sizes, or none.
    #[error("{0}")]
    Sizes(String),
}

debug_by_display!(SpectrumError);

/// The method of Lanczos for the largest eigenvalue of a product of positive definite matrices.
///
/// The iteration runs in the inner product of `B`, in which `B^-1 A` and `A^-1 B` are symmetric;
/// the smallest eigenvalue is the reciprocal of the largest one of `A^-1 B` (shift and invert at
/// zero). The initial vector is pseudo-random, with a fixed seed.
///
/// The tolerance bounds the residual relative to the eigenvalue, and with it the relative distance
/// to the nearest eigenvalue. It must be finer than the accuracy wanted: with clustered eigenvalues
/// a coarse tolerance accepts an eigenvalue inside the cluster. Rounding adds the condition number
/// times the rounding unit to the smallest eigenvalue.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Lanczos {
    /// Largest residual, relative to the eigenvalue.
    pub tolerance: f64,
    /// Largest number of steps, each of which keeps a vector.
    pub max_steps: usize,
}

impl Default for Lanczos {
    fn default() -> Self {
        Self { tolerance: 1e-10, max_steps: 1000 }
    }
}

impl Lanczos {
    /// Sets the largest residual, relative to the eigenvalue.
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }
    /// Sets the largest number of steps.
    #[must_use]
    pub fn with_max_steps(self, max_steps: usize) -> Self {
        Self { max_steps, ..self }
    }

    /// Both extreme eigenvalues of `B^-1 A`.
    ///
    /// # Errors
    /// [`SpectrumError`].
    pub fn extremes(
        &self,
        a: &dyn PositiveDefinite,
        b: &dyn PositiveDefinite,
    ) -> Result<Extremes, SpectrumError> {
        Ok(Extremes { smallest: self.smallest(a, b)?, largest: self.largest(a, b)? })
    }

    /// The largest eigenvalue of `B^-1 A`.
    ///
    /// # Errors
    /// [`SpectrumError`].
    pub fn largest(
        &self,
        a: &dyn PositiveDefinite,
        b: &dyn PositiveDefinite,
    ) -> Result<f64, SpectrumError> {
        self.run([a, b], [a, b])
    }

    /// The smallest eigenvalue of `B^-1 A`.
    ///
    /// # Errors
    /// [`SpectrumError`].
    pub fn smallest(
        &self,
        a: &dyn PositiveDefinite,
        b: &dyn PositiveDefinite,
    ) -> Result<f64, SpectrumError> {
        self.run([a, b], [b, a]).map(|value| 1.0 / value)
    }

    /// The largest eigenvalue of `inverted^-1 applied`, which are `a` and `b` or `b` and `a`: in both cases symmetric in
    /// the inner product of `b`, in which the vectors are orthonormal.
    fn run(
        &self,
        [a, b]: [&dyn PositiveDefinite; 2],
        [applied, inverted]: [&dyn PositiveDefinite; 2],
    ) -> Result<f64, SpectrumError> {
        let size = a.size();
        if size != b.size() || size == 0 {
            let message =
                format!("matrices of {size} and {} rows have no common spectrum", b.size());
            return Err(SpectrumError::Sizes(message));
        }
        let mut generator = SplitMix64(1);
        let mut next: Vec<f64> = (0..size).map(|_| generator.unit() - 0.5).collect();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let (mut diagonal, mut off_diagonal) = (Vec::new(), Vec::new());
        let mut check = 4;
        let mut length = norm(&next, b);
        loop {
            let steps = basis.len();
            if !(length.is_finite() && length > 0.0) {
                return Err(SpectrumError::NotPositive(steps));
            }
            next.iter_mut().for_each(|x| *x /= length);
            let mut image = applied.apply(&next);
            inverted.solve(&mut image);
            basis.push(next);
            diagonal.push(orthogonalise(&mut image, &basis, b));
            length = norm(&image, b);
            let steps = basis.len();
            let last = steps == size.min(self.max_steps);
            // up to rounding the Krylov space is invariant
            let invariant = length <= f64::EPSILON * diagonal[steps - 1].abs();
            if steps >= check || last || invariant {
                let (value, last_entry) = largest_of_tridiagonal(&diagonal, &off_diagonal);
                let residual = (length * last_entry / value).abs();
                if residual <= self.tolerance && value > 0.0 {
                    return Ok(value);
                }
                if last || invariant {
                    return Err(SpectrumError::NotReached(format!(
                        "after {steps} steps the eigenvalue {value:e} is known to a relative residual of {residual:.1e} only, asked for {:.1e}",
                        self.tolerance
                    )));
                }
                check = steps + steps / 4 + 1;
            }
            off_diagonal.push(length);
            next = image;
        }
    }
}

/// The norm in the inner product of `b`.
fn norm(x: &[f64], b: &dyn PositiveDefinite) -> f64 {
    dot(x, &b.apply(x)).sqrt()
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// Makes a vector orthogonal to a basis in the inner product of `b`, twice because of rounding
/// errors; returns its component along the last vector of the basis.
fn orthogonalise(x: &mut [f64], basis: &[Vec<f64>], b: &dyn PositiveDefinite) -> f64 {
    let mut along_last = 0.0;
    for _ in 0..2 {
        let image = b.apply(x);
        for (k, v) in basis.iter().enumerate() {
            let component = dot(v, &image);
            x.iter_mut().zip(v).for_each(|(x, v)| *x -= component * v);
            if k + 1 == basis.len() {
                along_last += component;
            }
        }
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
