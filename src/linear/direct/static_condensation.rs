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
//! If the means over the sides of a block are linearly dependent functions of its free unknowns,
//! the block inverse contains sums of weights and stiffnesses. There are two cases:
//!
//! * The means are dependent although all unknowns are free (a quadratic function vanishes at both Gauss points of
//!   every edge). The multipliers of [`NullDirections`] are then further unknowns of the condensed system, which is
//!   quasidefinite. Null directions include those in which jump multipliers do work only on unknowns with a large
//!   shift.
//! * The means are dependent in a few blocks only, because unknowns are fixed. The weights of these blocks are then
//!   replaced by an upper limit; iterative refinement by the caller restores the solution for the true weights.
//!
//! Several null directions that are coupled through facet means can have a combination that does no work on the
//! free unknowns of any block; the pivot of this combination has the size of `1/w`. If weights are so large that the
//! pivot is smaller than rounding errors, all weights are reduced by the same factor, and conjugate gradients restore
//! the solution for the true weights (`weight_correction`).
//!
//! Source: static condensation of hybridised methods, B. Cockburn, J. Gopalakrishnan, R. Lazarov, SIAM
//! J. Numer. Anal. 47 (2009), 1319-1365.

use super::error::FactorError;
use super::factors::Factors;
use super::null_directions::NullDirections;
use super::repeated_cholesky::RepeatedCholesky;
use crate::algebra::{JumpTerm, NO_INDEX, PenalisedMatrix, SparseMatrix, sort_by_column};
use crate::real::Real;

/// Largest ratio of a penalty to the stiffness that is factored if there are null directions, in `f64`. Multipliers
/// that do no work on any free unknown of any block have pivots of the reciprocal size, which are differences of
/// numbers of size one: four digits of these pivots are correct. In another scalar the ratio is scaled by the quotient
/// of the machine epsilons, for the same number of digits.
const MAX_RATIO: f64 = 1e12;

/// The factor by which the divisor of the weights is increased when a matrix with shifts is singular to working
/// precision. With shifts, the eigenvalues in `weight_correction` are spread between one and `1/c`, where `c` is the
/// divisor, which is therefore chosen as small as possible.
const WEIGHT_DIVISOR_STEP: f64 = 16.0;

/// One side of a jump, in the list of its block.
pub(super) struct JumpSide {
    pub jump: u32,
    /// The facet mean of the jump; [`NO_INDEX`] if the jump has one side only.
    pub mean: u32,
    /// The sign of this side in the jump: one for [`JumpTerm::here`], minus one for
    /// [`JumpTerm::there`].
    pub sign: f64,
}

impl JumpSide {
    /// The factor of the right-hand side of the jump in the equation of this side.
    pub fn share(&self) -> f64 {
        if self.mean == NO_INDEX { self.sign } else { 0.5 * self.sign }
    }
}

/// The static condensation of a matrix for all sets of free unknowns: the adjacency of blocks and jumps, and the
/// pattern of the Schur complement.
pub(crate) struct StaticCondensation<'a, T> {
    pub(super) penalised: &'a PenalisedMatrix<T>,
    /// Start of each block's list in `sides`, and its length at the end.
    pub(super) starts: Vec<usize>,
    sides: Vec<JumpSide>,
    /// The lower triangle of the Schur complement on facet means, all values zero.
    pub(super) pattern: SparseMatrix<T>,
    cholesky: RepeatedCholesky,
    /// Whether a block has sides whose means are linearly dependent functions of all unknowns of the block.
    pub(super) has_null_directions: bool,
    /// The largest divisor of the weights: at least one, and one without null directions.
    max_weight_divisor: f64,
}

/// The inverses of all blocks with their jump multipliers, and the factors of the Schur complement.
pub(crate) struct CondensedFactors<T> {
    /// The inverses by rows: free unknowns of the block, then jump multipliers.
    pub(super) inverses: Vec<f64>,
    /// Start of each block's inverse in `inverses`, and its length at the end.
    pub(super) starts: Vec<usize>,
    pub(super) null_directions: NullDirections,
    pub(super) schur_complement: Factors<T>,
    /// The ratio of the true weights to the weights in the factors; at least one.
    pub(super) weight_divisor: f64,
}

/// The inverse of a block with its jump multipliers; before the inversion, the matrix.
#[derive(Default)]
pub(super) struct BlockInverse {
    /// By rows: free unknowns of the block, then jump multipliers.
    pub entries: Vec<f64>,
    /// The factors by which the free unknowns are scaled.
    pub scales: Vec<f64>,
    /// The divisor of the weights.
    pub weight_divisor: f64,
}

impl<'a, T: Real> StaticCondensation<'a, T> {
    /// The condensation of a matrix, without points of its unknowns.
    pub fn new(penalised: &'a PenalisedMatrix<T>) -> Self {
        let n_blocks = penalised.size() / penalised.block_size;
        let blocks_of_jumps: Vec<[Option<u32>; 2]> =
            (0..penalised.n_jumps()).map(|jump| penalised.blocks_of_jump(jump)).collect();
        let mut starts = vec![0; n_blocks + 1];
        for block in blocks_of_jumps.iter().flatten().flatten() {
            starts[*block as usize + 1] += 1;
        }
        for k in 0..n_blocks {
            starts[k + 1] += starts[k];
        }
        let mut next = starts.clone();
        let none = || JumpSide { jump: NO_INDEX, mean: NO_INDEX, sign: 0.0 };
        let mut sides: Vec<JumpSide> = (0..starts[n_blocks]).map(|_| none()).collect();
        let mut n_means = 0;
        for (jump, blocks) in blocks_of_jumps.iter().enumerate() {
            let is_shared = blocks.iter().all(Option::is_some);
            let mean = if is_shared { n_means } else { NO_INDEX };
            for (block, sign) in blocks.iter().zip([1.0, -1.0]) {
                if let Some(block) = block {
                    let position = &mut next[*block as usize];
                    sides[*position] = JumpSide { jump: jump as u32, mean, sign };
                    *position += 1;
                }
            }
            n_means += u32::from(is_shared);
        }
        let cholesky = RepeatedCholesky::default();
        let pattern = empty();
        let mut condensation = Self {
            penalised,
            starts,
            sides,
            pattern,
            cholesky,
            has_null_directions: false,
            max_weight_divisor: 1.0,
        };
        condensation.pattern = condensation.lower_pattern(n_means as usize);
        let mut basis = Vec::new();
        condensation.has_null_directions = (0..n_blocks).any(|block| {
            let n_sides = condensation.sides(block).len();
            condensation.rank_of_means(block, |_| true, &mut basis) < n_sides
        });
        if condensation.has_null_directions {
            let max_ratio = MAX_RATIO * (f64::EPSILON / T::EPSILON);
            condensation.max_weight_divisor = (penalised.largest_ratio() / max_ratio).max(1.0);
        }
        condensation
    }

    /// Uses the points of unknowns for the order of elimination of facet means; `None` if they are
    /// not known.
    #[must_use]
    pub fn with_points(mut self, points: Option<&[[f32; 3]]>) -> Self {
        self.cholesky = RepeatedCholesky::on_jumps(self.penalised, points);
        self
    }

    /// The lower triangle of the Schur complement, all values zero: facet means of the same block are coupled.
    fn lower_pattern(&self, n_means: usize) -> SparseMatrix<T> {
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); n_means];
        for block in 0..self.starts.len() - 1 {
            let means = || self.sides(block).iter().map(|s| s.mean).filter(|&m| m != NO_INDEX);
            for row in means() {
                rows[row as usize].extend(means().filter(|&m| m <= row));
            }
        }
        let mut pattern = empty();
        for mut row in rows {
            row.sort_unstable();
            row.dedup();
            pattern.columns.extend(row);
            pattern.row_starts.push(pattern.columns.len() as u32);
        }
        pattern.values = vec![T::lit(0.0); pattern.columns.len()];
        pattern
    }

    pub(super) fn sides(&self, block: usize) -> &[JumpSide] {
        &self.sides[self.starts[block]..self.starts[block + 1]]
    }

    /// The free unknowns of a block.
    pub(super) fn free<'f>(
        &self,
        block: usize,
        is_free: &'f [bool],
    ) -> impl Iterator<Item = usize> + use<'f, T> {
        let n = self.penalised.block_size;
        (block * n..(block + 1) * n).filter(|&i| is_free[i])
    }

    /// The coefficient of an unknown in the mean over a side of a facet; zero if the mean does not
    /// contain the unknown.
    pub(super) fn mean_coefficient(&self, side: &JumpSide, unknown: usize) -> f64 {
        let is_own = |t: &&JumpTerm<T>| {
            let i = if side.sign > 0.0 { t.here } else { t.there };
            i as usize == unknown
        };
        self.penalised
            .terms_of(side.jump as usize)
            .iter()
            .find(is_own)
            .map_or(0.0, |t| t.weight.to_f64())
    }

    /// The weight of the difference between the mean over a side and the facet mean: twice the
    /// weight of the jump; if the jump has one side only, the weight of the jump.
    pub(super) fn side_weight(&self, side: &JumpSide) -> f64 {
        let weight = self.penalised.weights[side.jump as usize].to_f64();
        if side.mean == NO_INDEX { weight } else { 2.0 * weight }
    }

    /// Inverts the blocks on the free unknowns and factors the Schur complement.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(&self, is_free: &[bool]) -> Result<CondensedFactors<T>, FactorError> {
        self.factor_reduced(is_free, &[], self.max_weight_divisor)
    }

    /// [`StaticCondensation::factor`] for `K + D` in place of `K`; `shift` is the nonnegative diagonal of `D`, or empty
    /// for zero. The weights are reduced by the smallest power of [`WEIGHT_DIVISOR_STEP`] with which the factorisation
    /// succeeds, but at most by the largest divisor.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor_shifted(
        &self,
        is_free: &[bool],
        shift: &[f64],
    ) -> Result<CondensedFactors<T>, FactorError> {
        let mut weight_divisor = 1.0;
        loop {
            match self.factor_reduced(is_free, shift, weight_divisor) {
                Err(FactorError::Singular) if weight_divisor < self.max_weight_divisor => {
                    weight_divisor =
                        (weight_divisor * WEIGHT_DIVISOR_STEP).min(self.max_weight_divisor);
                }
                result => return result,
            }
        }
    }

    /// Inverts the blocks of `K + D` on the free unknowns and factors the Schur complement, with all weights divided by
    /// `weight_divisor`.
    ///
    /// # Errors
    /// See [`FactorError`].
    fn factor_reduced(
        &self,
        is_free: &[bool],
        shift: &[f64],
        weight_divisor: f64,
    ) -> Result<CondensedFactors<T>, FactorError> {
        let mut matrix = self.pattern.clone();
        let (mut inverses, mut starts) = (Vec::new(), vec![0]);
        let mut inverse = BlockInverse { weight_divisor, ..BlockInverse::default() };
        let mut null_directions = NullDirections::new();
        for block in 0..self.starts.len() - 1 {
            let n_free =
                self.invert_block(block, is_free, shift, &mut inverse, &mut null_directions)?;
            let sides = self.sides(block);
            let n = n_free + sides.len();
            for (i, row) in sides.iter().enumerate().filter(|(_, s)| s.mean != NO_INDEX) {
                let columns = matrix.row(row.mean as usize).0.to_vec();
                let start = matrix.row_starts[row.mean as usize] as usize;
                for (j, column) in sides.iter().enumerate().filter(|(_, s)| s.mean <= row.mean) {
                    if let Ok(k) = columns.binary_search(&column.mean) {
                        let entry = -inverse.entries[(n_free + i) * n + n_free + j];
                        matrix.values[start + k] += T::lit(entry);
                    }
                }
            }
            inverses.extend_from_slice(&inverse.entries);
            starts.push(inverses.len());
        }
        let schur_complement = if self.has_null_directions {
            self.append_rows(&mut matrix, &null_directions);
            self.cholesky.factor_quasidefinite(&self.pattern, matrix, null_directions.blocks())?
        } else {
            self.cholesky.factor(matrix)?
        };
        Ok(CondensedFactors { inverses, starts, null_directions, schur_complement, weight_divisor })
    }

    /// Appends the rows of the multipliers of null directions to the lower triangle of the condensed
    /// matrix.
    fn append_rows(&self, matrix: &mut SparseMatrix<T>, null_directions: &NullDirections) {
        let mut row: Vec<(u32, f64)> = Vec::new();
        for (k, &block) in null_directions.blocks().iter().enumerate() {
            let sides = self.sides(block as usize).iter().zip(null_directions.entries(k));
            row.clear();
            row.extend(sides.map(|(side, &y)| (side.mean, y)));
            row.retain(|&(mean, _)| mean != NO_INDEX);
            sort_by_column(&mut row);
            let products = null_directions.products(k);
            let first = (matrix.size() + 1 - products.len()) as u32;
            row.extend((first..).zip(products.iter().copied()));
            matrix.columns.extend(row.iter().map(|(column, _)| column));
            matrix.values.extend(row.iter().map(|&(_, value)| T::lit(value)));
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
    }

    /// Two sums of absolute values of terms of the residual `(c - K u - M^T p)_i`: the sum over the
    /// terms with free unknowns and jump multipliers `p`, and the sum over the terms with fixed unknowns and
    /// the load.
    pub fn residual_term_magnitudes(
        &self,
        (i, load): (usize, T),
        u: &dyn Fn(usize) -> f64,
        p: &[T],
        is_fixed: &dyn Fn(usize) -> bool,
    ) -> [f64; 2] {
        let n = self.penalised.block_size;
        let block = i / n;
        let (mut free, mut fixed) = (0.0, load.to_f64().abs());
        for j in block * n..(block + 1) * n {
            let size = (self.penalised.blocks[i * n + j % n].to_f64() * u(j)).abs();
            *(if is_fixed(j) { &mut fixed } else { &mut free }) += size;
        }
        for side in self.sides(block) {
            free += (self.mean_coefficient(side, i) * p[side.jump as usize].to_f64()).abs();
        }
        [free, fixed]
    }
}

/// The matrix without rows.
fn empty<T>() -> SparseMatrix<T> {
    SparseMatrix { row_starts: vec![0], columns: Vec::new(), values: Vec::new() }
}
