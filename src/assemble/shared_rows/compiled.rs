//! A table of the loops of P1, P2 and Crouzeix-Raviart elements, which compiles these loops in this crate: see
//! [`instances`](crate::instances).

use std::any::Any;
use std::marker::PhantomData;

use super::cell_loops::CellLoops;
use crate::element::{CrouzeixRaviart, P1, P2, ReferenceElement};
use crate::instances::look_up;
use crate::real::Real;

/// The loops of the element `E`.
#[derive(Clone, Copy)]
struct Loops<T: Real, const D: usize, E> {
    loops: CellLoops<T, D>,
    element: PhantomData<E>,
}

impl<T: Real, const D: usize, E: ReferenceElement<T, D>> Loops<T, D, E> {
    const fn instance() -> Self {
        Self { loops: CellLoops::instance::<E>(), element: PhantomData }
    }
}

static LOOPS: [&(dyn Any + Sync); 18] = [
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

/// The loops of an element of this library.
pub(super) fn loops<T: Real, const D: usize, E: ReferenceElement<T, D>>() -> CellLoops<T, D> {
    match look_up::<Loops<T, D, E>>(&LOOPS) {
        Some(found) => found.loops,
        None => not_compiled::<T, D, E>(),
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
