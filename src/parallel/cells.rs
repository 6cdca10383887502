//! Parallel loops of the assembly over chunks of cells or rows.
//!
//! The work on a chunk is a `dyn Fn`, so that a loop is compiled once and not once for each scheme.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::{for_each_item, lock, map_groups, split};

/// Number of items (cells or rows) in a chunk.
const CHUNK: usize = 1024;

/// Number of chunks of `n` items.
pub(crate) fn n_chunks(n: usize) -> usize {
    n.div_ceil(CHUNK)
}

/// The items of a chunk.
pub(crate) fn items(chunk: usize, n: usize) -> Range<usize> {
    chunk * CHUNK..((chunk + 1) * CHUNK).min(n)
}

/// The work on a chunk: a function of its items and their entries.
pub(crate) type ChunkWork<'w, V, E> = &'w (dyn Fn(Range<usize>, &mut [V]) -> Result<(), E> + Sync);

/// Calls `work` with the items of each chunk and their share of `entries`; the entries of the items
/// `a..b` are `end(a)..end(b)`.
///
/// # Errors
/// The error of the first chunk for which `work` fails, whatever the number of threads. Later chunks may be skipped.
pub(crate) fn for_each<V: Send, E: Send>(
    n: usize,
    end: &dyn Fn(usize) -> usize,
    entries: &mut [V],
    work: ChunkWork<'_, V, E>,
) -> Result<(), E> {
    let items = || (0..n_chunks(n)).map(|chunk| items(chunk, n));
    let lengths = items().map(|items| end(items.end) - end(items.start));
    let chunks = items().zip(split(entries, lengths)).collect();
    // the first chunk that failed so far, and its error
    let failed: Mutex<Option<(usize, E)>> = Mutex::new(None);
    let is_first = |failed: &Option<(usize, E)>, chunk: usize| {
        failed.as_ref().is_none_or(|(first, _)| chunk < *first)
    };
    for_each_item(chunks, &|chunk, (items, entries)| {
        if is_first(&lock(&failed), chunk)
            && let Err(error) = work(items, entries)
        {
            let mut failed = lock(&failed);
            if is_first(&failed, chunk) {
                *failed = Some((chunk, error));
            }
        }
    });
    match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some((_, error)) => Err(error),
        None => Ok(()),
    }
}

/// The values of `work` on the items of each chunk, in the order of chunks.
pub(crate) fn map<R: Send>(n: usize, work: &(dyn Fn(Range<usize>) -> R + Sync)) -> Vec<R> {
    map_groups(n, CHUNK, work)
}
