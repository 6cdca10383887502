//! Static condensation of systems with the matrix `K + M^T S M`, `K` block diagonal.
//!
//! The penalty `s (m - n)^2` of the means `m`, `n` over the two sides of a facet is the minimum
//! over `a` of `2 s (m - a)^2 + 2 s (n - a)^2`. With one unknown `a` for each facet between two
//! blocks, the *facet mean*, blocks are coupled through facet means only. Elimination of a block
//! with its jump multipliers `p` inverts the quasidefinite matrix
//!
//! ```text
//! [ K  M^T  ] [ u ]   [ r     ]
//! [ M  -1/w ] [ p ] = [ a + t ]
//! ```
//!
//! in which the weights `w` (`2 s`, or `s` on a facet with one block) are not added to stiffnesses; `r`
//! and `t` are the right-hand sides, `a` the facet means. The Schur complement on facet means is,
//! up to `O(1/s)`, the matrix of Crouzeix-Raviart elements: on triangles it has half as many
//! unknowns as `K`, and its condition number is `O(h^-2)` for all weights.
//!
//! If the means over the sides of a block are linearly dependent functions of its free unknowns, the block inverse
//! contains sums of weights and stiffnesses. There are two cases:
//!
//! * The means are dependent although all unknowns are free: a quadratic function vanishes at both Gauss points of
//!   every edge. There is no condensation then.
//! * The means are dependent in a few blocks only, because unknowns are fixed. The weights of these blocks are then
//!   replaced by an upper limit; iterative refinement by the caller restores the solution for the true weights.
//!
//! Source: static condensation of hybridised methods, B. Cockburn, J. Gopalakrishnan, R. Lazarov, SIAM
//! J. Numer. Anal. 47 (2009), 1319-1365.

use std::sync::OnceLock;

use super::error::FactorError;
use super::factors::Factors;
use super::symbolic_factor::{SymbolicFactor, symbolic_factor};
use crate::algebra::{JumpSide, NO_INDEX, PenalisedMatrix, SparseMatrix};
use crate::parallel::once;
use crate::real::Real;

/// The static condensation of a matrix for all sets of free unknowns: the facet means of jumps, and the matrix that is
/// factored.
pub(crate) struct StaticCondensation<'a, T> {
    pub(super) penalised: &'a PenalisedMatrix<T>,
    /// The facet mean of each jump; [`NO_INDEX`] if the jump has one side only.
    means: Vec<u32>,
    /// The lower triangle of the Schur complement on facet means, all values zero.
    pattern: SparseMatrix<T>,
    /// The pattern of the factor of the Schur complement, after the first factorisation.
    symbolic: OnceLock<SymbolicFactor>,
}

/// The factors of a matrix `K + M^T S M`.
pub(crate) struct CondensedFactors<T> {
    pub(super) inverses: BlockInverses,
    pub(super) schur_complement: Factors<T>,
}

/// The inverses of all blocks with their jump multipliers, by rows: free unknowns of the block, then jump multipliers.
pub(crate) struct BlockInverses {
    pub(super) entries: Vec<f64>,
    /// Start of each block's inverse in `entries`, and its length at the end.
    pub(super) starts: Vec<usize>,
}

impl<'a, T: Real> StaticCondensation<'a, T> {
    /// The condensation of a matrix; none if the means over the sides of a block are dependent functions.
    pub fn new(penalised: &'a PenalisedMatrix<T>) -> Option<Self> {
        let mut n_means = 0;
        let mean = |jump: usize| {
            let is_shared = penalised.jumps.blocks_of(jump).iter().all(Option::is_some);
            let mean = if is_shared { n_means } else { NO_INDEX };
            n_means += u32::from(is_shared);
            mean
        };
        let means = (0..penalised.n_jumps()).map(mean).collect();
        let pattern = SparseMatrix::by_rows(0..0, |_, _, _| {});
        let mut condensation = Self { penalised, means, pattern, symbolic: OnceLock::new() };
        let is_independent = |block: usize| condensation.has_independent_means(block, |_| true);
        if !(0..condensation.n_blocks()).all(is_independent) {
            return None;
        }
        condensation.pattern = condensation.lower_pattern(n_means as usize);
        Some(condensation)
    }

    /// The lower triangle of the Schur complement, all values zero: facet means of the same block are coupled.
    fn lower_pattern(&self, n_means: usize) -> SparseMatrix<T> {
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); n_means];
        for block in 0..self.n_blocks() {
            let means =
                || self.sides(block).iter().map(|s| self.mean(*s)).filter(|&m| m != NO_INDEX);
            for row in means() {
                rows[row as usize].extend(means().filter(|&m| m <= row));
            }
        }
        SparseMatrix::by_rows(0..n_means, |row, columns, values| {
            let row = &mut rows[row];
            row.sort_unstable();
            row.dedup();
            columns.extend(&*row);
            values.extend(row.iter().map(|_| T::lit(0.0)));
        })
    }

    pub(super) fn n_blocks(&self) -> usize {
        self.penalised.jumps.n_blocks()
    }

    pub(super) fn sides(&self, block: usize) -> &[JumpSide] {
        self.penalised.jumps.sides_of(block)
    }

    /// The facet mean of the jump of a side; [`NO_INDEX`] if the jump has one side only.
    pub(super) fn mean(&self, side: JumpSide) -> u32 {
        self.means[side.jump()]
    }

    /// The factor of the right-hand side of the jump in the equation of a side.
    pub(super) fn share(&self, side: JumpSide) -> f64 {
        if self.mean(side) == NO_INDEX { side.sign() } else { 0.5 * side.sign() }
    }

    /// The free unknowns of a block.
    pub(super) fn free<'f>(
        &self,
        block: usize,
        is_free: &'f [bool],
    ) -> impl Iterator<Item = usize> + use<'f, T> {
        let n = self.penalised.block_size();
        (block * n..(block + 1) * n).filter(|&i| is_free[i])
    }

    /// The coefficient of an unknown in the mean over a side of a facet; zero if the mean does not
    /// contain the unknown.
    pub(super) fn mean_coefficient(&self, side: JumpSide, unknown: usize) -> f64 {
        let terms = self.penalised.terms_of(side.jump());
        let own = terms.iter().find(|t| side.unknown(t) as usize == unknown);
        own.map_or(0.0, |t| t.weight.to_f64())
    }

    /// The weight of the difference between the mean over a side and the facet mean: twice the
    /// weight of the jump; if the jump has one side only, the weight of the jump.
    pub(super) fn side_weight(&self, side: JumpSide) -> f64 {
        let weight = self.penalised.weights[side.jump()].to_f64();
        if self.mean(side) == NO_INDEX { weight } else { 2.0 * weight }
    }

    /// The factors of the matrix with `K + D` in place of `K` on the free unknowns; `shift` is the nonnegative diagonal of
    /// `D`, or empty for zero.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(
        &self,
        is_free: &[bool],
        shift: &[f64],
    ) -> Result<CondensedFactors<T>, FactorError> {
        let (inverses, mut lower) = self.condense(is_free, shift, self.pattern.clone())?;
        let symbolic = match self.symbolic.get() {
            Some(symbolic) => symbolic,
            None => {
                let new = symbolic_factor(&lower)?;
                once(&self.symbolic, || new)
            }
        };
        let schur_complement = Factors::cholesky(&mut lower, symbolic)?;
        Ok(CondensedFactors { inverses, schur_complement })
    }

    /// Inverts the blocks of `K + D` on the free unknowns and adds the Schur complement to `matrix`, which has its
    /// pattern.
    ///
    /// # Errors
    /// See [`FactorError`].
    fn condense(
        &self,
        is_free: &[bool],
        shift: &[f64],
        mut matrix: SparseMatrix<T>,
    ) -> Result<(BlockInverses, SparseMatrix<T>), FactorError> {
        let (mut entries, mut starts) = (Vec::new(), vec![0]);
        let mut inverse = Vec::new();
        for block in 0..self.n_blocks() {
            let n_free = self.invert_block(block, is_free, shift, &mut inverse)?;
            let sides = self.sides(block);
            let n = n_free + sides.len();
            let means = || sides.iter().map(|&side| self.mean(side)).enumerate();
            for (i, row) in means().filter(|&(_, mean)| mean != NO_INDEX) {
                let (columns, values) = matrix.row_mut(row as usize);
                for (j, column) in means().filter(|&(_, mean)| mean <= row) {
                    if let Ok(k) = columns.binary_search(&column) {
                        let entry = -inverse[(n_free + i) * n + n_free + j];
                        values[k] += T::lit(entry);
                    }
                }
            }
            entries.extend_from_slice(&inverse);
            starts.push(entries.len());
        }
        Ok((BlockInverses { entries, starts }, matrix))
    }
}
