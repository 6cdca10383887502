//! Rows of spaces that share unknowns, and of broken ones without a form on facets.
//!
//! Without a form on facets each cell adds its matrix to the positions in its rows that were noted
//! when the pattern was made: see [`pattern`](pattern::pattern) and [`fill`](fill::fill). With one, which
//! is rare here, see [`with_facets`].

mod fill;
pub(crate) mod pattern;
pub(crate) mod places;
mod unknowns;
mod with_facets;

use std::sync::OnceLock;

use super::space::Space;
use crate::algebra::SparseMatrix;
use crate::facet::FacetForm;
use crate::parallel::once;
pub(crate) use pattern::EntryPositions;

/// Shared rows, with the positions of their entries once the pattern is computed.
#[derive(Default)]
pub(crate) struct SharedRows {
    positions: OnceLock<EntryPositions>,
}

impl SharedRows {
    /// The pattern, with values zero.
    pub fn pattern<const D: usize>(
        &self,
        space: &Space<'_, D>,
        form: &dyn FacetForm<D>,
    ) -> SparseMatrix<f64> {
        if form.couples() {
            return with_facets::pattern(space);
        }
        let (matrix, positions) = pattern::pattern::<D>(&space.dofs);
        // a space has one pattern: another thread that was first has set the same positions
        let _ = self.positions.set(positions);
        matrix
    }

    /// The values, on a known pattern.
    pub fn fill<const D: usize>(
        &self,
        space: &Space<'_, D>,
        form: &dyn FacetForm<D>,
        matrix: &mut SparseMatrix<f64>,
    ) {
        if form.couples() {
            return with_facets::fill(space, form, matrix);
        }
        let positions = once(&self.positions, || pattern::pattern::<D>(&space.dofs).1);
        fill::fill(space, positions, matrix);
    }
}
