//! The loop over cells that own consecutive rows.

use std::convert::Infallible;
use std::ops::Range;

use crate::parallel::cells;

/// Calls a function with each cell and the entries of its `n` rows, in parallel.
pub(super) fn for_each_cell<V: Send>(
    row_starts: &[u32],
    n: usize,
    entries: &mut [V],
    work: impl Fn(usize, &mut [V]) + Sync,
) {
    let end = |cell: usize| row_starts[cell * n] as usize;
    let rows_of = |cells: Range<usize>, mut entries: &mut [V]| {
        for cell in cells {
            let (rows, rest) = entries.split_at_mut(end(cell + 1) - end(cell));
            work(cell, rows);
            entries = rest;
        }
        Ok::<(), Infallible>(())
    };
    let Ok(()) = cells::for_each((row_starts.len() - 1) / n, &end, entries, &rows_of);
}
