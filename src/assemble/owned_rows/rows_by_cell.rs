//! The pattern of consecutive rows that each belong to one cell, and the loop over their cells.

use std::convert::Infallible;
use std::ops::Range;

use crate::algebra::SparseMatrix;
use crate::memory::in_large_pages;
use crate::parallel::cells;

/// The pattern, with values zero, of `n` rows for each cell, from the lengths of the rows of a cell and a function that
/// writes the columns of these rows.
pub(super) fn pattern<L: Iterator<Item = usize>>(
    n_cells: usize,
    n: usize,
    lengths: impl Fn(usize) -> L,
    write_columns: impl Fn(usize, &mut [u32]) + Sync,
) -> SparseMatrix<f64> {
    let mut row_starts = in_large_pages(Vec::with_capacity(n * n_cells + 1));
    row_starts.push(0_u32);
    let mut end = 0;
    for cell in 0..n_cells {
        for length in lengths(cell) {
            end += length as u32;
            row_starts.push(end);
        }
    }
    let mut columns = in_large_pages(vec![0_u32; end as usize]);
    for_each_cell(&row_starts, n, &mut columns, write_columns);
    let values = in_large_pages(vec![0.0; end as usize]);
    SparseMatrix { row_starts, columns, values }
}

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
