//! The parallel loops, apart from what they do: work is handed over a piece at a time, so that
//! these loops are compiled once for each scalar and not once for each scheme.

use std::ops::Range;

use rayon::prelude::*;

/// Cells, rows or patches of one piece of work.
pub(crate) const CHUNK: usize = 1024;

/// Number of pieces that `n` items make.
pub(crate) fn n_pieces(n: usize) -> usize {
    n.div_ceil(CHUNK)
}

/// The items of a piece.
pub(crate) fn items(piece: usize, n: usize) -> Range<usize> {
    piece * CHUNK..((piece + 1) * CHUNK).min(n)
}

/// What is done with the items and entries of a piece.
pub(crate) type Work<'w, V, E> = &'w (dyn Fn(Range<usize>, &mut [V]) -> Result<(), E> + Sync);

/// Cuts `entries` so that each piece holds those of its items, where the entries of items `a..b` are
/// `end(a)..end(b)`, and calls `work` with each piece's items and entries; the first error wins.
pub(crate) fn for_each<V: Send, E: Send>(
    n: usize,
    end: &dyn Fn(usize) -> usize,
    entries: &mut [V],
    work: Work<'_, V, E>,
) -> Result<(), E> {
    let mut pieces = Vec::with_capacity(n_pieces(n));
    let mut rest = entries;
    for piece in 0..n_pieces(n) {
        let items = items(piece, n);
        let (own, tail) = rest.split_at_mut(end(items.end) - end(items.start));
        pieces.push((items, own));
        rest = tail;
    }
    pieces.into_par_iter().try_for_each(|(items, entries)| work(items, entries))
}

/// What `work` makes of each piece's items, in order.
pub(crate) fn map<R: Send>(n: usize, work: &(dyn Fn(Range<usize>) -> R + Sync)) -> Vec<R> {
    (0..n_pieces(n)).into_par_iter().map(|piece| work(items(piece, n))).collect()
}
