//! Parallel loops of the assembly over chunks of cells or rows.
//!
//! The work on a chunk is a `dyn Fn`, so that a loop is compiled once and not once for each scheme.

use std::ops::Range;

use super::{map_groups, map_items, split};

/// Number of items (cells or rows) in a chunk.
const CHUNK: usize = 1024;

/// The work on a chunk: a function of its items and their entries.
pub(crate) type ChunkWork<'w, V, E> = &'w (dyn Fn(Range<usize>, &mut [V]) -> Result<(), E> + Sync);

/// Calls `work` with the items of each chunk and their share of `entries`; the entries of the items
/// `a..b` are `end(a)..end(b)`.
///
/// # Errors
/// The error of the first chunk for which `work` fails.
pub(crate) fn for_each<V: Send, E: Send>(
    n: usize,
    end: &dyn Fn(usize) -> usize,
    entries: &mut [V],
    work: ChunkWork<'_, V, E>,
) -> Result<(), E> {
    let items = || (0..n).step_by(CHUNK).map(|first| first..(first + CHUNK).min(n));
    let lengths = items().map(|items| end(items.end) - end(items.start));
    let chunks = items().zip(split(entries, lengths)).collect();
    let found = map_items(chunks, &|_, (items, entries)| work(items, entries));
    found.into_iter().collect()
}

/// The values of `work` on the items of each chunk, in the order of chunks.
pub(crate) fn map<R: Send>(n: usize, work: &(dyn Fn(Range<usize>) -> R + Sync)) -> Vec<R> {
    map_groups(n, CHUNK, work)
}
