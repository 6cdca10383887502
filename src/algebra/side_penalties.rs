//! The penalty on jumps of facet means of discontinuous linear functions, by sides of facets.

use super::NO_INDEX;
use super::mean_jumps::MeanJumps;
use super::penalised_matrix::PenalisedMatrix;
use crate::memory::in_large_pages;
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
        let n = penalised.size();
        let mut opposite = in_large_pages(vec![NO_INDEX; n]);
        let mut penalty = in_large_pages(vec![T::lit(0.0); n]);
        for (jump, &[one, other]) in sides.iter().enumerate() {
            let terms = penalised.terms_of(jump).iter();
            let mean = terms.fold(T::lit(0.0), |sum, t| sum + t.weight);
            let of_jump = penalised.weights[jump] * mean * mean;
            penalty[one as usize] = of_jump;
            if other != NO_INDEX {
                penalty[other as usize] = of_jump;
                (opposite[one as usize], opposite[other as usize]) = (other, one);
            }
        }
        let (cell_size, are_means) = (penalised.block_size(), *are_means);
        Some(Self { cell_size, are_means, opposite, penalty })
    }

    /// Whether the jump over the facet of a side, or the mean on a facet with Dirichlet data, is penalised.
    pub fn has_jump(&self, side: usize) -> bool {
        self.penalty[side] != T::lit(0.0)
    }
}
