//! The penalty on jumps of facet means of discontinuous linear functions, by sides of facets.

use super::NO_INDEX;
use super::mean_jumps::MeanJumps;
use super::penalised_matrix::PenalisedMatrix;
use crate::memory::in_large_pages;
use crate::parallel::vectors::for_each_chunk_of_two;
use crate::real::Real;

/// The penalty `M^T S M` of a [`PenalisedMatrix`] with [`MeanJumps`].
///
/// The bilinear form `v . M^T S M u` is the sum over facets of `penalty * [u] * [v]`. The jump `[u]` is the mean of
/// `u` over one side minus the mean over the opposite side; on a facet with Dirichlet data it is the mean over the
/// only side.
pub(crate) struct SidePenalties<T> {
    /// Number of unknowns of a cell.
    pub cell_size: usize,
    /// True if the unknowns are means over sides, false if the unknowns are vertex values.
    pub are_means: bool,
    /// By side, the opposite side of the same facet; [`NO_INDEX`] on the boundary.
    pub opposite: Vec<u32>,
    /// By side, the penalty of the jump over its facet, or of the mean on a facet with Dirichlet data; else zero.
    pub penalty: Vec<T>,
}

impl<T: Real> SidePenalties<T> {
    /// The penalties of a matrix; `None` if it has no [`MeanJumps`].
    pub fn new(penalised: &PenalisedMatrix<T>) -> Option<Self> {
        let MeanJumps { are_means, sides } = penalised.mean_jumps.as_ref()?;
        let (n, size) = (penalised.size(), penalised.block_size());
        let mut opposite = in_large_pages(vec![0; n]);
        let mut penalty = in_large_pages(vec![T::lit(0.0); n]);
        for_each_chunk_of_two(&mut opposite, &mut penalty, size, |range, opposite, penalty| {
            opposite.fill(NO_INDEX);
            for block in range.start / size..range.end / size {
                for side in penalised.jumps.sides_of(block) {
                    let jump = side.jump();
                    let [one, other] = sides[jump];
                    let (own, beyond) = if side.is_here() { (one, other) } else { (other, one) };
                    let terms = penalised.terms_of(jump).iter();
                    let mean = terms.fold(T::lit(0.0), |sum, t| sum + t.weight);
                    let own = own as usize - range.start;
                    opposite[own] = beyond;
                    penalty[own] = penalised.weights[jump] * mean * mean;
                }
            }
        });
        Some(Self { cell_size: size, are_means: *are_means, opposite, penalty })
    }

    /// Whether the jump over the facet of a side, or the mean on a facet with Dirichlet data, is penalised.
    pub fn has_jump(&self, side: usize) -> bool {
        self.penalty[side] != T::lit(0.0)
    }
}
