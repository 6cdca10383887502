//! The penalty on jumps of facet means of discontinuous linear functions, by sides of facets.

use super::NO_INDEX;
use super::inequality::Support;
use super::penalised_matrix::{JumpTerm, PenalisedMatrix};
use crate::memory::in_large_pages;
use crate::real::Real;

/// The penalty `M^T S M` of a [`PenalisedMatrix`] of discontinuous linear functions that penalises on each facet
/// the jump of the mean, and no other moment of the jump.
///
/// A facet has one side in each of its cells. Sides have the indices of unknowns: side `i` of a cell belongs to
/// facet `i` of the cell, which is opposite to vertex `i`. The bilinear form `v . M^T S M u` is the sum over facets of
/// `penalty * [u] * [v]`. The jump `[u]` is the mean of `u` over one side minus the mean over the opposite side; on
/// a facet with Dirichlet data it is the mean over the only side.
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
    /// The penalties of a matrix; `None` if the unknowns of the matrix are not those of discontinuous linear
    /// functions in two or three dimensions, or if the matrix penalises another moment of a jump than the mean.
    pub fn new(penalised: &PenalisedMatrix<T>, supports: &[Support]) -> Option<Self> {
        let (n, cell_size) = (penalised.size(), penalised.block_size);
        if !(3..=4).contains(&cell_size) || supports.len() != n || n == 0 {
            return None;
        }
        let are_means = supports[0].vertices().len() == cell_size - 1;
        let length = if are_means { cell_size - 1 } else { 1 };
        if supports.iter().any(|p| p.cell().is_none() || p.vertices().len() != length) {
            return None;
        }
        let mut sides = Self {
            cell_size,
            are_means,
            opposite: in_large_pages(vec![NO_INDEX; n]),
            penalty: in_large_pages(vec![T::lit(0.0); n]),
        };
        for jump in 0..penalised.n_jumps() {
            let terms = penalised.terms_of(jump);
            let here = sides.side(terms, |t| t.here)?;
            let there = sides.side(terms, |t| t.there);
            let mean = terms.iter().fold(T::lit(0.0), |sum, t| sum + t.weight);
            let penalty = penalised.weights[jump] * mean * mean;
            for side in [Some(here), there].into_iter().flatten() {
                // a second jump is a moment of higher degree
                if sides.has_jump(side) {
                    return None;
                }
                sides.penalty[side] = penalty;
            }
            if let Some(there) = there {
                (sides.opposite[here], sides.opposite[there]) = (there as u32, here as u32);
            }
        }
        Some(sides)
    }

    /// Whether the jump over the facet of a side, or the mean on a facet with Dirichlet data, is penalised.
    pub fn has_jump(&self, side: usize) -> bool {
        self.penalty[side] != T::lit(0.0)
    }

    /// The side over which one part of a jump, with the unknowns `unknown` of the terms, is the mean; `None` if
    /// this part is not the mean over a side.
    fn side(&self, terms: &[JumpTerm<T>], unknown: impl Fn(&JumpTerm<T>) -> u32) -> Option<usize> {
        let size = self.cell_size;
        if terms.iter().any(|t| unknown(t) == JumpTerm::<T>::NO_UNKNOWN) {
            return None;
        }
        let mut unknowns = terms.iter().map(|t| unknown(t) as usize);
        if self.are_means {
            return unknowns.next().filter(|_| terms.len() == 1);
        }
        if terms.len() != size - 1 {
            return None;
        }
        // vertex values have equal weights in the mean, up to the rounding of a quadrature rule
        let weight = terms[0].weight.to_f64();
        let is_equal = |t: &JumpTerm<T>| {
            (t.weight.to_f64() - weight).abs() <= T::EPSILON.sqrt() * weight.abs()
        };
        if !terms.iter().all(is_equal) {
            return None;
        }
        // the facet is opposite to the vertex without a term
        let cell = unknowns.next()? / size;
        let has_term = |i: usize| terms.iter().any(|t| unknown(t) as usize == cell * size + i);
        (0..size).find(|&i| !has_term(i)).map(|facet| cell * size + facet)
    }
}
