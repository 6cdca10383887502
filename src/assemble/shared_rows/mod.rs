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

use std::any::Any;
use std::marker::PhantomData;

use super::space::Space;
use super::space::dofs::Dofs;
use crate::algebra::SparseMatrix;
use crate::element::{CrouzeixRaviart, P1, P2, ReferenceElement};
use crate::facet::FacetForm;
use crate::instances::find;
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
        } else if const { E::COMPILED } {
            Some(find::<Loops<T, D, E>>(&COMPILED).loops)
        } else {
            Some(Loops::<T, D, E>::instance().loops)
        }
    }
}

/// The loops of one element: the type tells which.
#[derive(Clone, Copy)]
struct Loops<T: Real, const D: usize, E> {
    loops: CellLoops<T, D>,
    element: PhantomData<E>,
}

impl<T: Real, const D: usize, E: ReferenceElement<T, D>> Loops<T, D, E> {
    const fn instance() -> Self {
        let loops = CellLoops { pattern: pattern::pattern::<T, D, E>, fill: fill::fill::<T, D, E> };
        Self { loops, element: PhantomData }
    }
}

/// The loops of the elements of this library that share unknowns: compiled here, see
/// [`instances`](crate::instances).
static COMPILED: [&(dyn Any + Sync); 18] = [
    &Loops::<f64, 1, P1>::instance(),
    &Loops::<f64, 2, P1>::instance(),
    &Loops::<f64, 3, P1>::instance(),
    &Loops::<f64, 1, P2>::instance(),
    &Loops::<f64, 2, P2>::instance(),
    &Loops::<f64, 3, P2>::instance(),
    &Loops::<f64, 1, CrouzeixRaviart>::instance(),
    &Loops::<f64, 2, CrouzeixRaviart>::instance(),
    &Loops::<f64, 3, CrouzeixRaviart>::instance(),
    &Loops::<f32, 1, P1>::instance(),
    &Loops::<f32, 2, P1>::instance(),
    &Loops::<f32, 3, P1>::instance(),
    &Loops::<f32, 1, P2>::instance(),
    &Loops::<f32, 2, P2>::instance(),
    &Loops::<f32, 3, P2>::instance(),
    &Loops::<f32, 1, CrouzeixRaviart>::instance(),
    &Loops::<f32, 2, CrouzeixRaviart>::instance(),
    &Loops::<f32, 3, CrouzeixRaviart>::instance(),
];

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
