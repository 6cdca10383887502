//! The smoother of a level of multigrid, by unknowns or by cells.

use super::cell_gauss_seidel::{CellGaussSeidel, CellSmoother};
use super::gauss_seidel::GaussSeidel;
use crate::algebra::{DofLocation, SparseMatrix};
use crate::element::MAX_BASIS;
use crate::linear::direct::FactorError;
use crate::parallel::vectors::all;
use crate::real::Real;

/// The smoother of a level.
pub(crate) enum Smoother {
    /// One unknown after the other.
    Unknowns(GaussSeidel),
    /// All unknowns of a cell at a time.
    Cells(Box<dyn CellSmoother>),
}

impl Smoother {
    /// The smoother by cells of `cell_size` unknowns each; `None` if there is none for this number.
    pub fn by_cells<T: Real>(
        matrix: &SparseMatrix<T>,
        cell_size: usize,
        scale: f64,
    ) -> Option<Self> {
        Some(Self::Cells(match cell_size {
            // linear functions on an interval
            2 => Box::new(CellGaussSeidel::<2>::new(matrix, scale)),
            // linear functions on a triangle, quadratic ones on an interval
            3 => Box::new(CellGaussSeidel::<3>::new(matrix, scale)),
            // linear functions on a tetrahedron
            4 => Box::new(CellGaussSeidel::<4>::new(matrix, scale)),
            // quadratic functions on a triangle
            6 => Box::new(CellGaussSeidel::<6>::new(matrix, scale)),
            // quadratic functions on a tetrahedron
            10 => Box::new(CellGaussSeidel::<10>::new(matrix, scale)),
            _ => return None,
        }))
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
            Self::Cells(smoother) => smoother.set_fixed(fixed),
        }
    }

    /// A forward iteration from zero: sets `x`, and `r = b - A x` on free unknowns, zero on fixed ones.
    pub fn forward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        match self {
            Self::Unknowns(smoother) => smoother.forward(b, x, r),
            Self::Cells(smoother) => smoother.forward(b, x, r),
        }
    }

    /// A backward iteration from `x`. `r` is workspace.
    pub fn backward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        match self {
            Self::Unknowns(smoother) => smoother.backward(b, x, r),
            Self::Cells(smoother) => smoother.backward(b, x, r),
        }
    }

    /// Zero for fixed unknowns, else another number.
    pub fn mask(&self) -> &[f32] {
        match self {
            Self::Unknowns(smoother) => smoother.inverse_diagonal(),
            Self::Cells(smoother) => smoother.mask(),
        }
    }
}

/// The number of unknowns of a cell, from the locations of all unknowns: one if no unknown belongs to a single cell.
/// If every unknown belongs to a cell: the number `n` of unknowns at the beginning of the list that belong to the cell
/// of the first unknown, provided that `n` is at most [`MAX_BASIS`] and the list consists of groups of `n` consecutive
/// unknowns, each group with one cell. `None` for every other list, and for the empty list.
///
/// The function does not check that two groups belong to different cells.
pub(crate) fn unknowns_per_cell(locations: &[DofLocation]) -> Option<usize> {
    let first = locations.first()?.cell();
    if first.is_none() {
        return all(locations.len(), |i| locations[i].cell().is_none()).then_some(1);
    }
    let size = locations.iter().take_while(|p| p.cell() == first).count();
    let is_of_group = |i: usize| {
        let cell = locations[i].cell();
        cell.is_some() && cell == locations[i / size * size].cell()
    };
    let are_groups = size <= MAX_BASIS && locations.len().is_multiple_of(size);
    (are_groups && all(locations.len(), is_of_group)).then_some(size)
}
