//! Jumps of facet means, by sides of facets.

use super::NO_INDEX;

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
    /// Whether each of `n_jumps` jumps has its sides, no side has two jumps, and cells have as many unknowns as facets
    /// in two or three dimensions.
    pub(super) fn is_well_formed(&self, n_jumps: usize, size: usize, cell_size: usize) -> bool {
        let mut has_jump = vec![false; size];
        let mut is_new = |side: u32| {
            let known = has_jump.get_mut(side as usize);
            known.is_some_and(|known| !std::mem::replace(known, true))
        };
        (3..=4).contains(&cell_size)
            && self.sides.len() == n_jumps
            && self
                .sides
                .iter()
                .all(|&[one, opposite]| is_new(one) && (opposite == NO_INDEX || is_new(opposite)))
    }
}
