//! The tensor of an anisotropic diffusion coefficient.

use std::fmt;
use std::sync::Arc;

use crate::real::{Matrix, Point};

/// A symmetric, positive definite tensor by which the diffusion coefficient is multiplied: a constant, or a function of
/// space.
#[derive(Clone)]
#[non_exhaustive]
pub enum Tensor<const D: usize> {
    /// A constant.
    Constant(Matrix<D>),
    /// A function of space, which linear elements take at the barycentre of each cell.
    Function(Arc<dyn Fn(&Point<D>) -> Matrix<D> + Send + Sync>),
}

impl<const D: usize> Tensor<D> {
    /// A tensor that is a function of space.
    pub fn function(value: impl Fn(&Point<D>) -> Matrix<D> + Send + Sync + 'static) -> Self {
        Self::Function(Arc::new(value))
    }
    /// The value at a point.
    pub fn at(&self, x: &Point<D>) -> Matrix<D> {
        match self {
            Self::Constant(tensor) => *tensor,
            Self::Function(value) => value(x),
        }
    }
    /// Whether it is a constant.
    pub(crate) fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }
}

impl<const D: usize> From<[[f64; D]; D]> for Tensor<D> {
    fn from(rows: [[f64; D]; D]) -> Self {
        Self::Constant(Matrix::from_fn(|i, j| rows[i][j]))
    }
}

impl<const D: usize> fmt::Debug for Tensor<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(tensor) => f.debug_tuple("Constant").field(tensor).finish(),
            Self::Function(_) => f.write_str("Function(..)"),
        }
    }
}
