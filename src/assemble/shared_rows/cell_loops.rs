//! The functions of shared rows that are generic over the element, as function pointers.

use super::fill::fill;
use super::pattern::{EntryPositions, pattern};
use crate::algebra::SparseMatrix;
use crate::assemble::space::Space;
use crate::assemble::space::dofs::Dofs;
use crate::element::ReferenceElement;

/// The loops over cells that compute the pattern of shared rows and fill their entries, instantiated for an element.
#[derive(Clone, Copy)]
pub(crate) struct CellLoops<const D: usize> {
    pub pattern: fn(&Dofs<'_>) -> (SparseMatrix<f64>, EntryPositions),
    pub fill: fn(&Space<'_, D>, &EntryPositions, &mut SparseMatrix<f64>),
}

impl<const D: usize> CellLoops<D> {
    /// The loops of `E`, compiled in the crate that calls this function.
    pub const fn instance<E: ReferenceElement<D>>() -> Self {
        Self { pattern: pattern::<D, E>, fill: fill::<D, E> }
    }
}
