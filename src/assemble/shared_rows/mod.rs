//! Rows of spaces that share unknowns.
//!
//! Without a form on facets each cell adds its matrix to the positions in its rows that were noted
//! when the pattern was made: see [`pattern`](pattern::pattern) and [`fill`](fill::fill). With one, which
//! is rare here, rows gather from the matrices of [`patches`].

mod cells;
mod fill;
pub(crate) mod partition;
mod patches;
pub(crate) mod pattern;

use std::any::Any;
use std::marker::PhantomData;
use std::sync::OnceLock;

use super::space::Space;
use super::space::dofs::Dofs;
use crate::algebra::SparseMatrix;
use crate::element::{CrouzeixRaviart, P1, P2, ReferenceElement};
use crate::facet::FacetForm;
use crate::instances::look_up;
use crate::real::Real;
pub(crate) use pattern::EntryPositions;

/// The loops over shared rows, instantiated for an element, of which only they are generic.
#[derive(Clone, Copy)]
pub(crate) struct CellLoops<T: Real, const D: usize> {
    pattern: fn(&Dofs<'_>) -> (SparseMatrix<T>, EntryPositions),
    fill: fn(&Space<'_, T, D>, &EntryPositions, &mut SparseMatrix<T>),
}

impl<T: Real, const D: usize> CellLoops<T, D> {
    /// The loops of an element; none for elements that share no unknowns.
    pub fn of<E: ReferenceElement<T, D>>() -> Option<Self> {
        if const { E::LAYOUT.is_broken() } {
            None
        } else if const { E::COMPILED } {
            match look_up::<Loops<T, D, E>>(&COMPILED) {
                Some(found) => Some(found.loops),
                None => not_compiled::<T, D, E>(),
            }
        } else {
            Some(Loops::<T, D, E>::instance().loops)
        }
    }
}

/// Loops made here instead would be compiled in every crate, which the constant is there to prevent.
#[cold]
fn not_compiled<T: Real, const D: usize, E: ReferenceElement<T, D>>() -> ! {
    panic!(
        "no loops of {} over {} in dimension {D} are compiled: elements of other crates leave `ReferenceElement::COMPILED` false",
        std::any::type_name::<E>(),
        T::NAME
    )
}

/// The loops of the element `E`.
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

/// Shared rows of a space, with the positions of their entries once the pattern is computed.
pub(crate) struct SharedRows<T: Real, const D: usize> {
    loops: Option<CellLoops<T, D>>,
    positions: OnceLock<EntryPositions>,
}

impl<T: Real, const D: usize> SharedRows<T, D> {
    /// Rows whose pattern is not known yet.
    pub fn new(loops: Option<CellLoops<T, D>>) -> Self {
        Self { loops, positions: OnceLock::new() }
    }

    /// The pattern, with values zero.
    pub fn pattern(&self, space: &Space<'_, T, D>, form: &dyn FacetForm<T, D>) -> SparseMatrix<T> {
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
        space: &Space<'_, T, D>,
        form: &dyn FacetForm<T, D>,
        matrix: &mut SparseMatrix<T>,
    ) {
        match &self.loops {
            Some(loops) if !form.couples() => {
                let positions = self.positions.get_or_init(|| (loops.pattern)(&space.dofs).1);
                (loops.fill)(space, positions, matrix);
            }
            _ => patches::fill(space, form, matrix),
        }
    }
}
