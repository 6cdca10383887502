//! The jumps of each block of a penalised matrix.

use super::jump_term::JumpTerm;
use crate::memory::in_large_pages;

/// For each block of unknowns the jumps that contain some of them, ascending: whoever computes the rows of a block by
/// itself reads these jumps.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JumpsOfBlocks {
    /// Start of each block's jumps in `jumps`, and their number at the end.
    starts: Vec<u32>,
    jumps: Vec<u32>,
}

impl JumpsOfBlocks {
    /// The lists for `n_blocks` blocks of `block_size` unknowns, and for jumps given by the starts of their terms and
    /// by their terms. Terms of unknowns that no block has are left out.
    #[must_use]
    pub fn new<T>(
        (n_blocks, block_size): (usize, usize),
        term_starts: &[u32],
        terms: &[JumpTerm<T>],
    ) -> Self {
        let visit = |add: &mut dyn FnMut(usize, u32)| {
            for (jump, range) in (0..).zip(term_starts.windows(2)) {
                let terms = &terms[range[0] as usize..range[1] as usize];
                // all unknowns on one side of a jump belong to one block
                for side in [|t: &JumpTerm<T>| t.here, |t: &JumpTerm<T>| t.there] {
                    let blocks = terms.iter().map(|t| side(t) as usize / block_size);
                    if let Some(block) = blocks.min().filter(|&block| block < n_blocks) {
                        add(block, jump);
                    }
                }
            }
        };
        let mut starts = vec![0_u32; n_blocks + 1];
        visit(&mut |block, _| starts[block + 1] += 1);
        (0..n_blocks).for_each(|k| starts[k + 1] += starts[k]);
        let mut next = starts.clone();
        let mut jumps = in_large_pages(vec![0; starts[n_blocks] as usize]);
        visit(&mut |block, jump| {
            let at = &mut next[block];
            jumps[*at as usize] = jump;
            *at += 1;
        });
        Self { starts, jumps }
    }

    /// The jumps of a block.
    #[inline(always)]
    pub fn of(&self, block: usize) -> &[u32] {
        &self.jumps[self.starts[block] as usize..self.starts[block + 1] as usize]
    }

    /// The number of all entries of the lists.
    pub(super) fn len(&self) -> usize {
        self.jumps.len()
    }

    /// Whether there is a list for each block, of existing jumps.
    pub(super) fn is_well_formed(&self, n_blocks: usize, n_jumps: usize) -> bool {
        self.starts.len() == n_blocks + 1
            && self.starts[0] == 0
            && self.starts.windows(2).all(|w| w[0] <= w[1])
            && self.starts[n_blocks] as usize == self.jumps.len()
            && self.jumps.iter().all(|&jump| (jump as usize) < n_jumps)
    }
}
