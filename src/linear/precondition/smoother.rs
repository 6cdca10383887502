//! The smoother of a level of multigrid, by unknowns or by cells.

use super::cell_gauss_seidel::CellGaussSeidel;
use super::gauss_seidel::GaussSeidel;
use crate::algebra::SparseMatrix;
use crate::linear::direct::FactorError;
use crate::real::Real;

/// The smoother of a level.
pub(crate) enum Smoother {
    /// One unknown after the other.
    Unknowns(GaussSeidel),
    /// All unknowns of a triangle at a time, three of them.
    Triangles(CellGaussSeidel<3>),
    /// All unknowns of a tetrahedron at a time, four of them.
    Tetrahedra(CellGaussSeidel<4>),
}

impl Smoother {
    /// The smoother by cells of `cell_size` unknowns each; `None` if there is none for this number.
    pub fn by_cells<T: Real>(
        matrix: &SparseMatrix<T>,
        cell_size: usize,
        scale: f64,
    ) -> Option<Self> {
        match cell_size {
            3 => Some(Self::Triangles(CellGaussSeidel::new(matrix, scale))),
            4 => Some(Self::Tetrahedra(CellGaussSeidel::new(matrix, scale))),
            _ => None,
        }
    }

    /// Sets the fixed unknowns, and the unknowns `kept`, which are neither fixed nor smoothed; smoothers by cells do
    /// not support the latter, and smooth them.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if the block of a cell is not positive definite.
    pub fn set_fixed(&mut self, fixed: &[bool], kept: &[u32]) -> Result<(), FactorError> {
        match self {
            Self::Unknowns(smoother) => {
                smoother.set_fixed(fixed, kept);
                Ok(())
            }
            Self::Triangles(smoother) => smoother.set_fixed(fixed),
            Self::Tetrahedra(smoother) => smoother.set_fixed(fixed),
        }
    }

    /// A forward iteration from zero: sets `x`, and `r = b - A x` on free unknowns, zero on fixed ones.
    pub fn forward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        match self {
            Self::Unknowns(smoother) => smoother.forward(b, x, r),
            Self::Triangles(smoother) => smoother.forward(b, x, r),
            Self::Tetrahedra(smoother) => smoother.forward(b, x, r),
        }
    }

    /// A backward iteration from `x`. `r` is workspace.
    pub fn backward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        match self {
            Self::Unknowns(smoother) => smoother.backward(b, x, r),
            Self::Triangles(smoother) => smoother.backward(b, x, r),
            Self::Tetrahedra(smoother) => smoother.backward(b, x, r),
        }
    }

    /// Zero for fixed unknowns, else another number.
    pub fn mask(&self) -> &[f32] {
        match self {
            Self::Unknowns(smoother) => smoother.inverse_diagonal(),
            Self::Triangles(smoother) => smoother.mask(),
            Self::Tetrahedra(smoother) => smoother.mask(),
        }
    }
}
