//! Parallel loops over vectors, in pieces of fixed length: sums are added up in the same order and
//! smoothers see the same pieces whatever the number of threads, so that all get the same bits.

use std::ops::Range;

use rayon::prelude::*;

use crate::memory::in_large_pages;
use crate::real::Real;

/// Numbers in a piece: enough to outweigh handing it over, and for a smoother to hardly notice the
/// cuts.
pub(crate) const PIECE: usize = 1 << 14;

/// A vector of zeros in fresh memory.
pub(crate) fn zeros<T: Real>(n: usize) -> Vec<T> {
    in_large_pages(vec![T::lit(0.0); n])
}

/// Signs without structure, the same every time: plus for true.
pub(crate) fn signs() -> impl Iterator<Item = bool> {
    let mut state = 1_u64;
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695);
        state >> 63 == 0
    })
}

/// The numbers of a piece.
fn range(piece: usize, n: usize) -> Range<usize> {
    piece * PIECE..((piece + 1) * PIECE).min(n)
}

/// Whether it pays to hand pieces over.
fn alone(n: usize) -> bool {
    n <= PIECE || rayon::current_num_threads() == 1
}

/// What `work` makes of each piece of `n` numbers, in order.
pub(crate) fn map<R: Send>(n: usize, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    let pieces = n.div_ceil(PIECE);
    let one = |k: usize| work(range(k, n));
    if alone(n) {
        (0..pieces).map(one).collect()
    } else {
        (0..pieces).into_par_iter().map(one).collect()
    }
}

/// The same where `work` may change its piece of `x`.
pub(crate) fn map_mut<A: Send, R: Send>(
    x: &mut [A],
    work: impl Fn(Range<usize>, &mut [A]) -> R + Sync,
) -> Vec<R> {
    let n = x.len();
    let one = |(k, x): (usize, &mut [A])| work(range(k, n), x);
    if alone(n) {
        x.chunks_mut(PIECE).enumerate().map(one).collect()
    } else {
        x.par_chunks_mut(PIECE).enumerate().map(one).collect()
    }
}

/// Calls `work` with each piece of `x`, and adds up what it returns.
pub(crate) fn sum_mut<A: Send>(
    x: &mut [A],
    work: impl Fn(Range<usize>, &mut [A]) -> f64 + Sync,
) -> f64 {
    map_mut(x, work).iter().sum()
}

/// The same with two vectors of one length.
pub(crate) fn sum_mut2<A: Send, B: Send>(
    x: &mut [A],
    y: &mut [B],
    work: impl Fn(Range<usize>, &mut [A], &mut [B]) -> f64 + Sync,
) -> f64 {
    let n = x.len();
    let one = |(k, (x, y)): (usize, (&mut [A], &mut [B]))| work(range(k, n), x, y);
    if alone(n) {
        x.chunks_mut(PIECE).zip(y.chunks_mut(PIECE)).enumerate().map(one).sum()
    } else {
        let pieces = x.par_chunks_mut(PIECE).zip(y.par_chunks_mut(PIECE)).enumerate();
        pieces.map(one).collect::<Vec<f64>>().iter().sum()
    }
}

/// Calls `work` with each piece of `x`.
pub(crate) fn each_mut<A: Send>(x: &mut [A], work: impl Fn(Range<usize>, &mut [A]) + Sync) {
    each_mut_of(x, 1, work);
}

/// Calls `work` with pieces of whole groups of numbers; the range is that of the numbers.
pub(crate) fn each_mut_of<A: Send>(
    x: &mut [A],
    group: usize,
    work: impl Fn(Range<usize>, &mut [A]) + Sync,
) {
    let (n, length) = (x.len(), PIECE / group * group);
    let one = |(k, x): (usize, &mut [A])| work(k * length..k * length + x.len(), x);
    if alone(n) {
        x.chunks_mut(length).enumerate().for_each(one);
    } else {
        x.par_chunks_mut(length).enumerate().for_each(one);
    }
}
