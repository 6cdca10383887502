//! Parallel loops over chunks, of fixed length where a result depends on it, for the same bits with any number of
//! threads.
//!
//! `cells`: loops of the assembly over cells, rows or patches. `vectors`: loops of solvers over the
//! entries of vectors, with inner products and pseudorandom signs.
//!
//! Every loop but [`vectors::collect`] ends in [`for_each_index`], so that the task machinery of rayon is compiled once
//! and not once for each loop, scalar and dimension. A task is a chunk of a thousand items or more, or of
//! rows that take as long, beside which a virtual call and a lock cost nothing.

pub(crate) mod cells;
pub(crate) mod vectors;

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

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

/// Calls `work` with the index and the value of every item, one task each.
pub(crate) fn for_each_item<A: Send>(items: Vec<A>, work: &(dyn Fn(usize, A) + Sync)) {
    let slots: Vec<Mutex<Option<A>>> = items.into_iter().map(|a| Mutex::new(Some(a))).collect();
    for_each_index(slots.len(), &|k| {
        let item = lock(&slots[k]).take();
        if let Some(item) = item {
            work(k, item);
        }
    });
}

/// Consecutive parts of a slice with these lengths, as many as there are lengths.
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

/// The content of a lock; a task that panicked leaves it as it was.
pub(crate) fn lock<A>(slot: &Mutex<A>) -> MutexGuard<'_, A> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}
