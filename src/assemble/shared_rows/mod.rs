//! Rows of spaces that share unknowns.
//!
//! Without a form on facets each cell adds its matrix to the places in its rows that were noted when
//! the pattern was made: see [`pattern`](pattern::pattern) and [`fill`](fill::fill). With one, which
//! is rare here, rows gather from the matrices of [`patches`].

mod cells;
mod fill;
pub(crate) mod partition;
mod patches;
pub(crate) mod pattern;

use super::space::Space;
use super::space::dofs::Dofs;
use crate::algebra::SparseMatrix;
use crate::element::ReferenceElement;
use crate::facet::FacetForm;
use crate::real::Real;
pub(crate) use pattern::Places;

/// The loops over shared rows, instantiated for an element, of which only they are generic.
#[derive(Clone, Copy)]
pub(crate) struct CellLoops<T: Real, const D: usize> {
    pattern: fn(&Dofs<'_>) -> SparseMatrix<T>,
    fill: fn(&Space<'_, T, D>, &mut SparseMatrix<T>),
}

impl<T: Real, const D: usize> CellLoops<T, D> {
    /// The loops of an element; none for elements that share no unknowns.
    pub fn of<E: ReferenceElement<T, D>>() -> Option<Self> {
        if const { E::LAYOUT.is_broken() } {
            None
        } else {
            Some(Self { pattern: pattern::pattern::<T, D, E>, fill: fill::fill::<T, D, E> })
        }
    }
}

/// The pattern, with values zero.
pub(crate) fn pattern<T: Real, const D: usize>(
    space: &Space<'_, T, D>,
    form: &dyn FacetForm<T, D>,
    loops: Option<&CellLoops<T, D>>,
) -> SparseMatrix<T> {
    match loops {
        Some(loops) if !form.couples() => (loops.pattern)(&space.dofs),
        _ => patches::pattern(space, form),
    }
}

/// The values, on a known pattern.
pub(crate) fn fill<T: Real, const D: usize>(
    space: &Space<'_, T, D>,
    form: &dyn FacetForm<T, D>,
    loops: Option<&CellLoops<T, D>>,
    matrix: &mut SparseMatrix<T>,
) {
    match loops {
        Some(loops) if !form.couples() => (loops.fill)(space, matrix),
        _ => patches::fill(space, form, matrix),
    }
}
