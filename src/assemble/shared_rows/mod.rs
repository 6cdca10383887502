//! Rows of spaces that share unknowns.
//!
//! Without a form on facets each cell adds its matrix to the positions in its rows that were noted
//! when the pattern was made: see [`pattern`](pattern::pattern) and [`fill`](fill::fill). With one, which
//! is rare here, rows gather from the matrices of [`patches`].

mod cell_loops;
mod cells;
// without the table, unit tests compile the loops of the elements that they use
#[cfg(not(test))]
mod compiled;
mod fill;
pub(crate) mod partition;
mod patches;
pub(crate) mod pattern;

use std::sync::OnceLock;

use super::space::Space;
use crate::algebra::SparseMatrix;
use crate::element::ReferenceElement;
use crate::facet::FacetForm;
use crate::parallel::once;
pub(crate) use cell_loops::CellLoops;
pub(crate) use pattern::EntryPositions;

/// The loops of an element; none for elements that share no unknowns.
pub(crate) fn loops_of<const D: usize, E: ReferenceElement<D>>() -> Option<CellLoops<D>> {
    if const { E::LAYOUT.is_broken() } {
        return None;
    }
    #[cfg(not(test))]
    if const { E::COMPILED } {
        return Some(compiled::loops::<D, E>());
    }
    Some(CellLoops::instance::<E>())
}

/// Shared rows of a space, with the positions of their entries once the pattern is computed.
pub(crate) struct SharedRows<const D: usize> {
    loops: Option<CellLoops<D>>,
    positions: OnceLock<EntryPositions>,
}

impl<const D: usize> SharedRows<D> {
    /// Rows whose pattern is not known yet.
    pub fn new(loops: Option<CellLoops<D>>) -> Self {
        Self { loops, positions: OnceLock::new() }
    }

    /// The pattern, with values zero.
    pub fn pattern(&self, space: &Space<'_, D>, form: &dyn FacetForm<D>) -> SparseMatrix<f64> {
        match &self.loops {
            Some(loops) if !form.couples() => {
                let (matrix, positions) = (loops.pattern)(&space.dofs);
                // a space has one pattern: another thread that was first has set the same positions
                let _ = self.positions.set(positions);
                matrix
            }
            _ => patches::pattern(space, form),
        }
    }

    /// The values, on a known pattern.
    pub fn fill(
        &self,
        space: &Space<'_, D>,
        form: &dyn FacetForm<D>,
        matrix: &mut SparseMatrix<f64>,
    ) {
        match &self.loops {
            Some(loops) if !form.couples() => {
                let positions = once(&self.positions, || (loops.pattern)(&space.dofs).1);
                (loops.fill)(space, positions, matrix);
            }
            _ => patches::fill(space, form, matrix),
        }
    }
}
