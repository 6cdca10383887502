//! Parallel loops over chunks, of fixed length where a result depends on it, for the same bits with any number of
//! threads.
//!
//! `cells`: loops of the assembly over cells or rows. `vectors`: loops of solvers over the
//! entries of vectors, with inner products and pseudorandom signs. `grouping`: a counting sort.
//!
//! Every loop but [`vectors::collect`] ends in [`for_each_index`], so that the task machinery of rayon is compiled once
//! and not once for each loop, scalar and dimension. A task is a chunk of a thousand items or more, or of
//! rows that take as long, beside which a virtual call and a lock cost nothing.

pub(crate) mod cells;
pub(crate) mod grouping;
pub(crate) mod vectors;

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use rayon::prelude::*;

/// Calls `work` with every index below `n`, one task each.
pub(crate) fn for_each_index(n: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..n).into_par_iter().for_each(work);
}

/// The values of `work` at all indices below `n`, in their order, one task each.
pub(crate) fn map_indices<R: Send>(n: usize, work: &(dyn Fn(usize) -> R + Sync)) -> Vec<R> {
    let slots: Vec<Mutex<Option<R>>> = (0..n).map(|_| Mutex::new(None)).collect();
    for_each_index(n, &|k| {
        let value = work(k);
        *lock(&slots[k]) = Some(value);
    });
    let mut values = Vec::with_capacity(n);
    for slot in slots {
        values.extend(slot.into_inner().unwrap_or_else(PoisonError::into_inner));
    }
    values
}

/// The values of `work` on consecutive groups of `length` of the indices below `n`, the last one
/// shorter, in their order, one task each.
pub(crate) fn map_groups<R: Send>(
    n: usize,
    length: usize,
    work: &(dyn Fn(Range<usize>) -> R + Sync),
) -> Vec<R> {
    map_indices(n.div_ceil(length), &|k| work(k * length..((k + 1) * length).min(n)))
}

/// The values of `work` at the index and the value of every item, in their order, one task each.
///
/// An item leaves its lock before the work on it begins: no lock is held while other tasks may run on its thread.
pub(crate) fn map_items<A: Send, R: Send>(
    items: Vec<A>,
    work: &(dyn Fn(usize, A) -> R + Sync),
) -> Vec<R> {
    let slots: Vec<Mutex<Option<A>>> = items.into_iter().map(|a| Mutex::new(Some(a))).collect();
    map_indices(slots.len(), &|k| {
        let item = lock(&slots[k]).take();
        work(k, item.expect("the task of an index is the only one that takes its item"))
    })
}

/// Calls `work` with the index and the value of every item, one task each.
pub(crate) fn for_each_item<A: Send>(items: Vec<A>, work: &(dyn Fn(usize, A) + Sync)) {
    map_items(items, work);
}

/// Consecutive pieces of a slice with these lengths, as many as there are lengths.
pub(crate) fn split<V>(
    mut rest: &mut [V],
    lengths: impl Iterator<Item = usize>,
) -> impl Iterator<Item = &mut [V]> {
    lengths.map(move |length| {
        let (own, tail) = std::mem::take(&mut rest).split_at_mut(length);
        rest = tail;
        own
    })
}

/// The value of a cell. Where there is none yet, the calling thread makes one.
///
/// The value is made before the cell is locked. A thread that waits for its own parallel work takes other tasks of the
/// pool, and one of them may ask for the same cell: under `OnceLock::get_or_init` the thread would wait for itself.
/// Threads that come at the same time each make the value, and the first one stays; a loop therefore has what it needs
/// made before it.
pub(crate) fn once<V>(cell: &OnceLock<V>, make: impl FnOnce() -> V) -> &V {
    if let Some(value) = cell.get() {
        return value;
    }
    let value = make();
    cell.get_or_init(|| value)
}

/// The content of a lock; a task that panicked leaves it as it was.
pub(crate) fn lock<A>(slot: &Mutex<A>) -> MutexGuard<'_, A> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}
