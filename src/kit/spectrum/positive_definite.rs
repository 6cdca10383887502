//! Symmetric positive definite matrices as operators.

use crate::algebra::SparseMatrix;
use crate::linear::{FactorError, Factors};

/// A symmetric positive definite matrix with its product and its inverse.
pub trait PositiveDefinite {
    /// Number of rows.
    fn size(&self) -> usize;
    /// The product with a vector.
    fn apply(&self, x: &[f64]) -> Vec<f64>;
    /// Replaces `x` by the solution of the system with right-hand side `x`.
    fn solve(&self, x: &mut [f64]);
}

/// A diagonal matrix with positive entries.
#[derive(Clone, Debug)]
pub struct Diagonal(pub Vec<f64>);

impl Diagonal {
    /// The identity matrix.
    pub fn identity(size: usize) -> Self {
        Self(vec![1.0; size])
    }
}

impl PositiveDefinite for Diagonal {
    fn size(&self) -> usize {
        self.0.len()
    }
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.0).map(|(x, d)| x * d).collect()
    }
    fn solve(&self, x: &mut [f64]) {
        x.iter_mut().zip(&self.0).for_each(|(x, d)| *x /= d);
    }
}

/// A sparse matrix and its Cholesky factor.
#[derive(Debug)]
pub struct CholeskyMatrix<'a> {
    matrix: &'a SparseMatrix<f64>,
    factors: Factors<f64>,
}

impl<'a> CholeskyMatrix<'a> {
    /// Factors a symmetric matrix.
    ///
    /// # Errors
    /// [`FactorError`] if it is not positive definite to working precision.
    pub fn new(matrix: &'a SparseMatrix<f64>) -> Result<Self, FactorError> {
        let all: Vec<u32> = (0..matrix.size() as u32).collect();
        Ok(Self { matrix, factors: Factors::new(matrix, true, &all)? })
    }
}

impl PositiveDefinite for CholeskyMatrix<'_> {
    fn size(&self) -> usize {
        self.matrix.size()
    }
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        (0..self.size()).map(|i| self.matrix.row_dot(i, x)).collect()
    }
    fn solve(&self, x: &mut [f64]) {
        self.factors.solve_in_place(x, 1);
    }
}
