//! The jumps of a penalised matrix, by jumps and by blocks of unknowns.

use super::NO_INDEX;
use crate::parallel::grouping::group_by_key;
use crate::parallel::vectors::{all, collect};
use crate::real::Real;

/// The term `weight * (u[here] - u[there])` of a jump. The difference is computed first, so that a
/// function without jump has none in rounded arithmetic.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JumpTerm<T> {
    /// The first unknown, or [`JumpTerm::NO_UNKNOWN`].
    pub here: u32,
    /// The second unknown, or [`JumpTerm::NO_UNKNOWN`].
    pub there: u32,
    /// The weight.
    pub weight: T,
}

impl<T> JumpTerm<T> {
    /// No unknown; its value in the difference is zero.
    pub const NO_UNKNOWN: u32 = NO_INDEX;
}

/// The matrix `M` of the jumps `M u`: the terms of each jump, and for each block of unknowns the sides of jumps that
/// contain some of them. Whoever computes the rows of `M^T` of a block by itself reads these sides.
///
/// In a jump all [`JumpTerm::here`] belong to one block, all [`JumpTerm::there`] to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Jumps<T> {
    block_size: usize,
    /// Start of each jump in `terms`, and the number of terms at the end.
    term_starts: Vec<u32>,
    terms: Vec<JumpTerm<T>>,
    /// Start of each block in `sides`, and the number of sides at the end.
    side_starts: Vec<u32>,
    sides: Vec<JumpSide>,
}

/// One side of a jump: the terms with [`JumpTerm::here`], of positive sign, or those with [`JumpTerm::there`], of
/// negative sign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JumpSide {
    /// Twice the number of the jump, and one more for [`JumpTerm::there`].
    code: u32,
}

impl JumpSide {
    fn new(jump: usize, is_there: bool) -> Self {
        Self { code: 2 * jump as u32 + u32::from(is_there) }
    }

    /// The number of the jump.
    #[inline(always)]
    pub fn jump(self) -> usize {
        (self.code / 2) as usize
    }

    /// Whether the side is that of [`JumpTerm::here`].
    #[inline(always)]
    pub fn is_here(self) -> bool {
        self.code.is_multiple_of(2)
    }

    /// The sign of the side in the jump.
    #[inline(always)]
    pub fn sign(self) -> f64 {
        if self.is_here() { 1.0 } else { -1.0 }
    }

    /// The unknown of a term on this side, or [`JumpTerm::NO_UNKNOWN`].
    #[inline(always)]
    pub fn unknown<T>(self, term: &JumpTerm<T>) -> u32 {
        if self.is_here() { term.here } else { term.there }
    }
}

impl<T: Real> Jumps<T> {
    /// The jumps for `n_blocks` blocks of `block_size` unknowns, given by the start of each jump in `terms`, with the
    /// number of terms at the end.
    ///
    /// `None` if blocks have no unknowns, if the starts are not those of lists in `terms`, if there are 2^31 jumps or
    /// more, if a term has an unknown that no block has, if the unknowns of one side of a jump belong to two blocks or
    /// those of both sides to one.
    #[must_use]
    pub fn new(
        (n_blocks, block_size): (usize, usize),
        term_starts: Vec<u32>,
        terms: Vec<JumpTerm<T>>,
    ) -> Option<Self> {
        let n_terms = u32::try_from(terms.len()).ok();
        let are_starts = block_size > 0
            && term_starts.first() == Some(&0)
            && term_starts.last().copied() == n_terms
            && term_starts.is_sorted()
            && term_starts.len() <= 1 << 31;
        let (side_starts, sides) = (vec![0], Vec::new());
        let jumps = Self { block_size, term_starts, terms, side_starts, sides };
        if !are_starts || !all(jumps.len(), |jump| jumps.is_between_blocks(jump, n_blocks)) {
            return None;
        }
        let (side_starts, sides) = group_by_key(jumps.len(), n_blocks, |jump, put| {
            for (block, is_there) in jumps.blocks_of(jump).into_iter().zip([false, true]) {
                if let Some(block) = block {
                    put(block, JumpSide::new(jump, is_there));
                }
            }
        });
        Some(Self { side_starts, sides, ..jumps })
    }

    /// Whether the unknowns of each side of a jump belong to one block, and those of both sides not to the same.
    fn is_between_blocks(&self, jump: usize, n_blocks: usize) -> bool {
        let blocks = self.blocks_of(jump);
        let [here, there] = blocks;
        let is_of = |unknown: u32, block: Option<u32>| {
            unknown == JumpTerm::<T>::NO_UNKNOWN || block == Some(unknown / self.block_size as u32)
        };
        blocks.iter().flatten().all(|&block| (block as usize) < n_blocks)
            && (here.is_none() || here != there)
            && self.terms_of(jump).iter().all(|t| is_of(t.here, here) && is_of(t.there, there))
    }

    /// The number of blocks.
    pub fn n_blocks(&self) -> usize {
        self.side_starts.len() - 1
    }

    /// The number of unknowns of a block.
    pub fn block_size(&self) -> usize {
        self.block_size
    }

    /// The number of jumps.
    #[expect(clippy::len_without_is_empty, reason = "nobody asks whether there are none")]
    pub fn len(&self) -> usize {
        self.term_starts.len() - 1
    }

    /// The terms of all jumps.
    pub fn terms(&self) -> &[JumpTerm<T>] {
        &self.terms
    }

    /// The terms of a jump.
    #[inline]
    pub fn terms_of(&self, jump: usize) -> &[JumpTerm<T>] {
        &self.terms[self.term_starts[jump] as usize..self.term_starts[jump + 1] as usize]
    }

    /// The sides of jumps that contain unknowns of a block, by ascending jumps.
    #[inline(always)]
    pub fn sides_of(&self, block: usize) -> &[JumpSide] {
        &self.sides[self.side_starts[block] as usize..self.side_starts[block + 1] as usize]
    }

    /// The two blocks whose unknowns a jump contains, first that of [`JumpTerm::here`]; `None` for a side without
    /// unknowns.
    pub fn blocks_of(&self, jump: usize) -> [Option<u32>; 2] {
        let block = |unknown: fn(&JumpTerm<T>) -> u32| {
            let mut unknowns = self.terms_of(jump).iter().map(unknown);
            let found = unknowns.find(|&i| i != JumpTerm::<T>::NO_UNKNOWN);
            found.map(|i| i / self.block_size as u32)
        };
        [block(|t| t.here), block(|t| t.there)]
    }
}

impl Jumps<f64> {
    /// The jumps with rounded weights of their terms.
    #[must_use]
    pub(super) fn in_precision<T: Real>(&self) -> Jumps<T> {
        let term =
            |t: &JumpTerm<f64>| JumpTerm { here: t.here, there: t.there, weight: T::lit(t.weight) };
        Jumps {
            block_size: self.block_size,
            term_starts: self.term_starts.clone(),
            terms: collect(self.terms.len(), |k| term(&self.terms[k])),
            side_starts: self.side_starts.clone(),
            sides: self.sides.clone(),
        }
    }
}
