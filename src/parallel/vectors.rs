//! Parallel loops over vectors in chunks, whose length follows from that of the vector.
//!
//! Partial sums are added in the order of chunks, and smoothers treat chunks as blocks; both are
//! therefore independent of the number of threads.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::{for_each_item, map_items, split};
use crate::memory::in_large_pages;
use crate::real::{Real, maximum};

/// Largest number of entries in a chunk. Longer chunks leave threads without work.
const MOST: usize = 1 << 14;

/// Smallest number. Shorter chunks cost time for scheduling, and weaken smoothers that do not couple chunks.
const LEAST: usize = 1 << 12;

/// Number of chunks of a vector whose chunks have neither the largest nor the smallest number of entries: enough for
/// sixteen threads, some of which are late.
const CHUNKS: usize = 128;

/// A zero vector in newly allocated memory.
pub(crate) fn zeros<T: Real>(n: usize) -> Vec<T> {
    in_large_pages(vec![T::lit(0.0); n])
}

/// A reproducible pseudorandom sequence of signs, `true` for plus: the leading bits of a linear
/// congruential generator (multiplier of D. E. Knuth's MMIX).
pub(crate) fn pseudorandom_signs() -> impl Iterator<Item = bool> {
    let mut state = 1_u64;
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695);
        state >> 63 == 0
    })
}

/// The Euclidean inner product `x . y`, products and sum in `f64`.
pub(crate) fn dot<T: Real>(x: &[T], y: &mut [T]) -> f64 {
    sum_chunks(y, 1, |range, y| {
        let products = x[range].iter().zip(y.iter());
        products.fold(0.0, |sum, (x, y)| sum + x.to_f64() * y.to_f64())
    })
}

/// Whether a loop over `n` entries runs on the calling thread: one chunk, or one thread.
pub(super) fn is_sequential(n: usize) -> bool {
    n <= LEAST || rayon::current_num_threads() == 1
}

/// The length of chunks of `n` entries that divide no group of `group` consecutive entries. It depends on nothing else:
/// sums over chunks have the same bits on every machine.
pub(crate) fn chunk_length(n: usize, group: usize) -> usize {
    (n / CHUNKS).clamp(LEAST, MOST) / group * group
}

/// Gathers the values of `work` on the index range and the item of each chunk of `0..n`, in the order of chunks; no
/// chunk divides a group of `group` consecutive indices.
fn gather<X: Send, R: Send, G: FromIterator<R>>(
    n: usize,
    group: usize,
    items: impl Iterator<Item = X>,
    work: impl Fn(Range<usize>, X) -> R + Sync,
) -> G {
    let length = chunk_length(n, group);
    let one = |k: usize, item: X| work(k * length..((k + 1) * length).min(n), item);
    if is_sequential(n) {
        items.enumerate().map(|(k, item)| one(k, item)).collect()
    } else {
        map_items(items.collect(), &one).into_iter().collect()
    }
}

/// A sum of partial sums, in their order.
struct Total(f64);

impl FromIterator<f64> for Total {
    fn from_iter<I: IntoIterator<Item = f64>>(sums: I) -> Self {
        Self(sums.into_iter().sum())
    }
}

/// The values of `work` on the index range of each chunk of `0..n`, in the order of chunks.
pub(crate) fn map_chunks<R: Send>(n: usize, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    map_chunks_of_groups(n, 1, work)
}

/// As [`map_chunks`]; no chunk divides a group of `group` consecutive indices.
pub(crate) fn map_chunks_of_groups<R: Send>(
    n: usize,
    group: usize,
    work: impl Fn(Range<usize>) -> R + Sync,
) -> Vec<R> {
    let items = (0..n.div_ceil(chunk_length(n, group))).map(|_| ());
    gather(n, group, items, |range, ()| work(range))
}

/// The values of all lists, one list after the other.
pub(crate) fn concat<V: Copy + Default + Send + Sync>(mut lists: Vec<Vec<V>>) -> Vec<V> {
    let n = lists.iter().map(Vec::len).sum();
    if lists.len() == 1 {
        return lists.swap_remove(0);
    }
    if is_sequential(n) {
        return lists.concat();
    }
    let mut all = collect(n, |_| V::default());
    let parts = split(&mut all, lists.iter().map(Vec::len)).collect();
    for_each_item(parts, &|k, part: &mut [V]| part.copy_from_slice(&lists[k]));
    all
}

/// Where each entry of all lists starts, with the number of values at the end; a list has the ends of its entries, from
/// its own beginning.
pub(crate) fn starts(lists: &[&[u32]]) -> Vec<u32> {
    let mut starts = vec![0; 1 + lists.iter().map(|ends| ends.len()).sum::<usize>()];
    let mut first = 0;
    let firsts = lists.iter().map(|ends| {
        first += ends.last().copied().unwrap_or(0);
        first - ends.last().copied().unwrap_or(0)
    });
    let parts = split(&mut starts[1..], lists.iter().map(|ends| ends.len())).zip(firsts);
    for_each_item(parts.collect(), &|k, (part, first): (&mut [u32], u32)| {
        part.iter_mut().zip(lists[k]).for_each(|(start, end)| *start = first + end);
    });
    starts
}

/// The indices below `n` for which a predicate holds, ascending.
pub(crate) fn indices(n: usize, predicate: impl Fn(usize) -> bool + Sync) -> Vec<u32> {
    let of_chunk =
        |range: Range<usize>| range.filter(|&i| predicate(i)).map(|i| i as u32).collect::<Vec<_>>();
    concat(map_chunks(n, of_chunk))
}

/// Flags for the indices below `n`, of which `work` sets some, on any number of threads: it is called once, with a
/// function that sets the flag of an index.
pub(crate) fn flags(n: usize, work: impl FnOnce(&(dyn Fn(usize) + Sync))) -> Vec<bool> {
    let flags = collect(n, |_| AtomicBool::new(false));
    work(&|i| flags[i].store(true, Ordering::Relaxed));
    collect(n, |i| flags[i].load(Ordering::Relaxed))
}

/// The position of each index below `n` in an ascending list; `u32::MAX` for an index that the list does not have.
pub(crate) fn positions(n: usize, list: &[u32]) -> Vec<u32> {
    let mut positions = in_large_pages(vec![0; n]);
    for_each_chunk(&mut positions, |range, positions| {
        positions.fill(u32::MAX);
        let first = list.partition_point(|&i| (i as usize) < range.start);
        for (k, &i) in (first..).zip(&list[first..]).take_while(|(_, i)| (**i as usize) < range.end)
        {
            positions[i as usize - range.start] = k as u32;
        }
    });
    positions
}

/// Whether a predicate holds for all indices below `n`.
pub(crate) fn all(n: usize, predicate: impl Fn(usize) -> bool + Sync) -> bool {
    map_chunks(n, |mut range| range.all(&predicate)).into_iter().all(|holds| holds)
}

/// The largest of zero and the values of `work` at all indices below `n`; NaN if one of them is NaN.
pub(crate) fn largest(n: usize, work: impl Fn(usize) -> f64 + Sync) -> f64 {
    map_chunks(n, |range| range.map(&work).fold(0.0, maximum)).into_iter().fold(0.0, maximum)
}

/// The sum over the chunks of `x` of the values of `work` for the index range and the entries of a chunk; no chunk
/// divides a group of `group` consecutive entries.
pub(crate) fn sum_chunks<A: Send>(
    x: &mut [A],
    group: usize,
    work: impl Fn(Range<usize>, &mut [A]) -> f64 + Sync,
) -> f64 {
    let (n, length) = (x.len(), chunk_length(x.len(), group));
    let Total(sum) = gather(n, group, x.chunks_mut(length), work);
    sum
}

/// As [`sum_chunks`], for two vectors of the same length.
pub(crate) fn sum_chunks_of_two<A: Send, B: Send>(
    x: &mut [A],
    y: &mut [B],
    group: usize,
    work: impl Fn(Range<usize>, &mut [A], &mut [B]) -> f64 + Sync,
) -> f64 {
    let (n, length) = (x.len(), chunk_length(x.len(), group));
    let chunks = x.chunks_mut(length).zip(y.chunks_mut(length));
    let Total(sum) = gather(n, group, chunks, |range, (x, y)| work(range, x, y));
    sum
}

/// The values of `work` at all indices below `n`, in newly allocated memory that all threads write.
pub(crate) fn collect<V: Send>(n: usize, work: impl Fn(usize) -> V + Sync) -> Vec<V> {
    let mut values = in_large_pages(Vec::with_capacity(n));
    if is_sequential(n) {
        values.extend((0..n).map(work));
    } else {
        collect_in_parallel(n, &work, &mut values);
    }
    values
}

/// The parallel case of [`collect`], compiled once for each type of values.
fn collect_in_parallel<V: Send>(n: usize, work: &(dyn Fn(usize) -> V + Sync), values: &mut Vec<V>) {
    (0..n).into_par_iter().with_min_len(LEAST).map(work).collect_into_vec(values);
}

/// Calls `work` with the index range and the entries of each chunk of `x`.
pub(crate) fn for_each_chunk<A: Send>(x: &mut [A], work: impl Fn(Range<usize>, &mut [A]) + Sync) {
    for_each_chunk_of_groups(x, 1, work);
}

/// As [`for_each_chunk_of_groups`], for two vectors of the same length.
pub(crate) fn for_each_chunk_of_two<A: Send, B: Send>(
    x: &mut [A],
    y: &mut [B],
    group: usize,
    work: impl Fn(Range<usize>, &mut [A], &mut [B]) + Sync,
) {
    let (n, length) = (x.len(), chunk_length(x.len(), group));
    let chunks = x.chunks_mut(length).zip(y.chunks_mut(length));
    gather(n, group, chunks, |range, (x, y)| work(range, x, y))
}

/// Calls `work` with the index range and the entries of each chunk of `x`; no chunk divides a group
/// of `group` consecutive entries.
pub(crate) fn for_each_chunk_of_groups<A: Send>(
    x: &mut [A],
    group: usize,
    work: impl Fn(Range<usize>, &mut [A]) + Sync,
) {
    let (n, length) = (x.len(), chunk_length(x.len(), group));
    gather(n, group, x.chunks_mut(length), work)
}
