//! A table of the loops of P1, P2 and Crouzeix-Raviart elements, which compiles these loops in this crate: see
//! [`instances`](crate::instances).

use std::any::Any;
use std::marker::PhantomData;

use super::cell_loops::CellLoops;
use crate::element::{CrouzeixRaviart, P1, P2, ReferenceElement};
use crate::instances::look_up;

/// The loops of the element `E`.
#[derive(Clone, Copy)]
struct Loops<const D: usize, E> {
    loops: CellLoops<D>,
    element: PhantomData<E>,
}

impl<const D: usize, E: ReferenceElement<D>> Loops<D, E> {
    const fn instance() -> Self {
        Self { loops: CellLoops::instance::<E>(), element: PhantomData }
    }
}

static LOOPS: [&(dyn Any + Sync); 9] = [
    &Loops::<1, P1>::instance(),
    &Loops::<2, P1>::instance(),
    &Loops::<3, P1>::instance(),
    &Loops::<1, P2>::instance(),
    &Loops::<2, P2>::instance(),
    &Loops::<3, P2>::instance(),
    &Loops::<1, CrouzeixRaviart>::instance(),
    &Loops::<2, CrouzeixRaviart>::instance(),
    &Loops::<3, CrouzeixRaviart>::instance(),
];

/// The loops of an element of this library.
pub(super) fn loops<const D: usize, E: ReferenceElement<D>>() -> CellLoops<D> {
    match look_up::<Loops<D, E>>(&LOOPS) {
        Some(found) => found.loops,
        None => not_compiled::<D, E>(),
    }
}

/// Loops made here instead would be compiled in every crate, which the constant is there to prevent.
#[cold]
fn not_compiled<const D: usize, E: ReferenceElement<D>>() -> ! {
    panic!(
        "no loops of {} in dimension {D} are compiled: elements of other crates leave `ReferenceElement::COMPILED` false",
        std::any::type_name::<E>()
    )
}
