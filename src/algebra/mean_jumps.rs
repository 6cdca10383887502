//! Jumps of facet means, by sides of facets.

use super::NO_INDEX;
use super::jumps::Jumps;
use crate::parallel::vectors::all;
use crate::real::Real;

/// The jumps of a [`PenalisedMatrix`](super::PenalisedMatrix) of discontinuous linear functions that penalises on each
/// facet the jump of the mean, and no other moment of the jump.
///
/// A facet has one side in each of its cells. Sides have the indices of unknowns: side `i` of a cell belongs to
/// facet `i` of the cell, which is opposite to vertex `i`.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanJumps {
    /// True if the unknowns are means over sides, false if the unknowns are vertex values.
    pub are_means: bool,
    /// By jump, the side over which it has the mean with positive sign, and the opposite one; `u32::MAX` on a facet
    /// with Dirichlet data, where the jump is the mean over the only side.
    pub sides: Vec<[u32; 2]>,
}

impl MeanJumps {
    /// Whether cells have as many unknowns as facets in two or three dimensions, each jump has its sides in the blocks of
    /// its unknowns, and no side has two jumps.
    pub(super) fn is_well_formed<T: Real>(&self, jumps: &Jumps<T>) -> bool {
        let size = jumps.block_size();
        let has_sides = |jump: usize| {
            let [here, there] = jumps.blocks_of(jump).map(|block| block.is_some());
            here && there == (self.sides[jump][1] != NO_INDEX)
        };
        let has_distinct_sides = |block: usize| {
            let mut has_jump = [false; 4];
            jumps.sides_of(block).iter().all(|side| {
                let own = self.sides[side.jump()][usize::from(!side.is_here())] as usize;
                own / size == block && !std::mem::replace(&mut has_jump[own % size], true)
            })
        };
        (3..=4).contains(&size)
            && self.sides.len() == jumps.len()
            && all(jumps.len(), has_sides)
            && all(jumps.n_blocks(), has_distinct_sides)
    }
}
