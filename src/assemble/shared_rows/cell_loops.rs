//! The functions of shared rows that are generic over the element, as function pointers.

use super::fill::fill;
use super::pattern::{EntryPositions, pattern};
use crate::algebra::SparseMatrix;
use crate::assemble::space::Space;
use crate::assemble::space::dofs::Dofs;
use crate::element::ReferenceElement;
use crate::real::Real;

/// The loops over cells that compute the pattern of shared rows and fill their entries, instantiated for an element.
#[derive(Clone, Copy)]
pub(crate) struct CellLoops<T: Real, const D: usize> {
    pub pattern: fn(&Dofs<'_>) -> (SparseMatrix<T>, EntryPositions),
    pub fill: fn(&Space<'_, T, D>, &EntryPositions, &mut SparseMatrix<T>),
}

impl<T: Real, const D: usize> CellLoops<T, D> {
    /// The loops of `E`, compiled in the crate that calls this function.
    pub const fn instance<E: ReferenceElement<T, D>>() -> Self {
        Self { pattern: pattern::<T, D, E>, fill: fill::<T, D, E> }
    }
}
