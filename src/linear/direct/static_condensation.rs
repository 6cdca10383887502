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
//! in which weights `w` (`2 s`, or `s` on a facet with one block) are not added to stiffnesses; `r`
//! and `t` are the right-hand sides, `a` the facet means. The Schur complement on facet means is,
//! up to `O(1/s)`, the matrix of Crouzeix-Raviart elements: on triangles it has half as many
//! unknowns as `K`, and its condition number is `O(h^-2)` for all weights.
//!
//! Where the means over the sides of a block are linearly dependent functions of its free unknowns,
//! the block inverse contains weights beside stiffnesses. If that is so with all unknowns free (quadratic
//! functions vanish at both Gauss points of every edge), the multipliers of [`NullDirections`] are further
//! unknowns of the condensed system, which is quasidefinite then; directions in which only unknowns with a
//! large shift give way are among them. If it is so in a few blocks only, because of fixed unknowns,
//! weights of these blocks are cut off; iterative refinement by the caller restores the solution for the
//! true weights.
//!
//! Multipliers may do no work on the free unknowns of any block: of several null directions that are coupled through
//! their facet means one combination then has a pivot of the size of `1/w`. Weights so large that this is rounding are
//! all reduced by the same factor, and conjugate gradients restore the solution for the true ones
//! (`weight_correction`).
//!
//! Source: static condensation of hybridised methods, B. Cockburn, J. Gopalakrishnan, R. Lazarov, SIAM
//! J. Numer. Anal. 47 (2009), 1319-1365.

use super::error::FactorError;
use super::factors::Factors;
use super::null_directions::NullDirections;
use super::repeated_cholesky::RepeatedCholesky;
use crate::algebra::dense::{extend_basis, invert_in_place};
use crate::algebra::{JumpTerm, NO_INDEX, PenalisedMatrix, SparseMatrix, sort_by_column};
use crate::real::Real;

/// Largest weight divided by `k / eps`, in a block with dependent means because unknowns are fixed;
/// `k` is the least positive diagonal entry of the stiffness of the block, `eps` machine epsilon.
const MAX_WEIGHT: f64 = 1e-3;

/// Largest shift divided by `k / sqrt(eps)`, `k` and `eps` as for [`MAX_WEIGHT`], of an unknown that is
/// not as good as fixed.
const MAX_SHIFT_BY_ROOT: f64 = 4.0;

/// Largest ratio of a penalty to the stiffness that is factored where there are null directions. Multipliers that do
/// no work on any free unknown of any block have pivots of the reciprocal size, left by differences of numbers of
/// size one: four digits of these pivots remain in `f64`.
const MAX_RATIO: f64 = 1e12;

/// The factor by which weights are reduced once more where a matrix with shifts has no factors. Shifts spread the
/// eigenvalues of `weight_correction` over the range of the reduction, which is therefore kept small.
const REDUCTION_STEP: f64 = 16.0;

/// One side of a jump, in the list of its block.
struct JumpSide {
    jump: u32,
    /// The facet mean of the jump; [`NO_INDEX`] if the jump has one side only.
    mean: u32,
    /// The sign of this side in the jump: one for [`JumpTerm::here`], minus one for
    /// [`JumpTerm::there`].
    sign: f64,
}

impl JumpSide {
    /// The factor of the right-hand side of the jump on this side.
    fn share(&self) -> f64 {
        if self.mean == NO_INDEX { self.sign } else { 0.5 * self.sign }
    }
}

/// The adjacency of blocks and jumps, for all sets of free unknowns.
pub(crate) struct StaticCondensation<'a, T> {
    pub(super) penalised: &'a PenalisedMatrix<T>,
    /// Start of each block's list in `sides`, and its length at the end.
    starts: Vec<usize>,
    sides: Vec<JumpSide>,
    /// The lower triangle of the Schur complement on facet means, all values zero.
    pattern: SparseMatrix<T>,
    cholesky: RepeatedCholesky,
    /// Whether the means over the sides of a block are dependent functions of all its unknowns.
    has_null_directions: bool,
    /// The largest factor by which weights are reduced; at least one.
    max_reduction: f64,
}

/// The inverses of all blocks with their jump multipliers, and the factors of the Schur complement.
pub(crate) struct CondensedFactors<T> {
    /// The inverses by rows: free unknowns of the block, then jump multipliers.
    inverses: Vec<f64>,
    /// Start of each block's inverse in `inverses`, and its length at the end.
    starts: Vec<usize>,
    null_directions: NullDirections,
    schur_complement: Factors<T>,
    /// The true weights divided by those that are factored; at least one.
    pub(super) reduction: f64,
}

/// Workspace for the inverse of a block with its jump multipliers.
#[derive(Default)]
struct BlockInverse {
    /// By rows: free unknowns of the block, then jump multipliers.
    entries: Vec<f64>,
    /// The factors by which the free unknowns are scaled.
    scales: Vec<f64>,
    /// The factor by which weights are reduced.
    reduction: f64,
}

impl<'a, T: Real> StaticCondensation<'a, T> {
    /// The condensation of a matrix, without points of its unknowns.
    pub fn new(penalised: &'a PenalisedMatrix<T>) -> Self {
        let n_blocks = penalised.load.len() / penalised.block_size;
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
            max_reduction: 1.0,
        };
        condensation.pattern = condensation.lower_pattern(n_means as usize);
        let mut basis = Vec::new();
        condensation.has_null_directions = (0..n_blocks).any(|block| {
            let n_sides = condensation.sides(block).len();
            condensation.rank_of_means(block, |_| true, &mut basis) < n_sides
        });
        if condensation.has_null_directions {
            condensation.max_reduction = (penalised.largest_ratio() / MAX_RATIO).max(1.0);
        }
        condensation
    }

    /// Whether the means over the sides of a block are dependent functions of all its unknowns, as the
    /// moments of quadratics on a triangle are.
    pub fn has_null_directions(&self) -> bool {
        self.has_null_directions
    }

    /// Uses the points of unknowns for the order of elimination of facet means; `None` if they are
    /// not known.
    #[must_use]
    pub fn with_points(mut self, points: Option<&[[f32; 3]]>) -> Self {
        self.cholesky = RepeatedCholesky::on_jumps(self.penalised, points);
        self
    }

    /// The lower triangle of the Schur complement: facet means of the same block are coupled.
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

    fn sides(&self, block: usize) -> &[JumpSide] {
        &self.sides[self.starts[block]..self.starts[block + 1]]
    }

    /// The free unknowns of a block.
    fn free<'f>(
        &self,
        block: usize,
        is_free: &'f [bool],
    ) -> impl Iterator<Item = usize> + use<'f, T> {
        let n = self.penalised.block_size;
        (block * n..(block + 1) * n).filter(|&i| is_free[i])
    }

    /// The coefficient of an unknown in the mean over a side of a facet; zero if the mean does not
    /// contain it.
    fn mean_coefficient(&self, side: &JumpSide, unknown: usize) -> f64 {
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
    fn side_weight(&self, side: &JumpSide) -> f64 {
        let weight = self.penalised.weights[side.jump as usize].to_f64();
        if side.mean == NO_INDEX { weight } else { 2.0 * weight }
    }

    /// The rank of the means over the sides of a block, as functions of the unknowns `may_move`.
    fn rank_of_means(
        &self,
        block: usize,
        may_move: impl Fn(usize) -> bool,
        basis: &mut Vec<f64>,
    ) -> usize {
        let (n, sides) = (self.penalised.block_size, self.sides(block));
        basis.clear();
        for i in (block * n..(block + 1) * n).filter(|&i| may_move(i)) {
            let means = sides.iter().map(|side| self.mean_coefficient(side, i));
            extend_basis(basis, means, T::EPSILON.sqrt());
        }
        basis.len() / sides.len().max(1)
    }

    /// Inverts the blocks on the free unknowns and factors the Schur complement.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(&self, is_free: &[bool]) -> Result<CondensedFactors<T>, FactorError> {
        self.factor_reduced(is_free, &[], self.max_reduction)
    }

    /// [`StaticCondensation::factor`] for `K + D` in place of `K`; `shift` is the nonnegative
    /// diagonal of `D`, or empty for zero.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor_shifted(
        &self,
        is_free: &[bool],
        shift: &[f64],
    ) -> Result<CondensedFactors<T>, FactorError> {
        let mut reduction = 1.0;
        loop {
            match self.factor_reduced(is_free, shift, reduction) {
                Err(FactorError::Singular) if reduction < self.max_reduction => {
                    reduction = (reduction * REDUCTION_STEP).min(self.max_reduction);
                }
                result => return result,
            }
        }
    }

    /// [`StaticCondensation::factor_shifted`] with weights reduced by a factor.
    ///
    /// # Errors
    /// See [`FactorError`].
    fn factor_reduced(
        &self,
        is_free: &[bool],
        shift: &[f64],
        reduction: f64,
    ) -> Result<CondensedFactors<T>, FactorError> {
        let mut matrix = self.pattern.clone();
        let (mut inverses, mut starts) = (Vec::new(), vec![0]);
        let mut inverse = BlockInverse { reduction, ..BlockInverse::default() };
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
        Ok(CondensedFactors { inverses, starts, null_directions, schur_complement, reduction })
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

    /// Sets `inverse` to the inverse of a block with its jump multipliers; returns the number of free
    /// unknowns of the block.
    ///
    /// # Errors
    /// [`FactorError::Singular`] or [`FactorError::NotPositive`].
    fn invert_block(
        &self,
        block: usize,
        is_free: &[bool],
        shift: &[f64],
        inverse: &mut BlockInverse,
        null_directions: &mut NullDirections,
    ) -> Result<usize, FactorError> {
        let (size, sides) = (self.penalised.block_size, self.sides(block));
        let stiffness = |i: usize, j: usize| self.penalised.blocks[i * size + j % size].to_f64();
        let n_free = self.free(block, is_free).count();
        let n = n_free + sides.len();
        // Jump multipliers are scaled by the largest stiffness.
        let diagonal = || self.free(block, is_free).map(|i| stiffness(i, i));
        let largest = diagonal().fold(0.0, f64::max);
        let least = diagonal().filter(|&d| d > 0.0).fold(largest, f64::min);
        let unit = if largest > 0.0 { largest } else { 1.0 };
        // A shift above this limit acts like a fixed unknown.
        let max_shift = least * MAX_SHIFT_BY_ROOT / T::EPSILON.sqrt();
        let may_move =
            |i: usize| is_free[i] && shift.get(i).is_none_or(|&shift| shift <= max_shift);
        let has_null_directions = self.has_null_directions && n_free > 0;
        self.fill_block((block, n_free), is_free, shift, unit, inverse);
        let BlockInverse { entries: out, scales, reduction } = inverse;
        // The rank decides, and is computed only if some weight exceeds the limit.
        let limit = least * MAX_WEIGHT / T::EPSILON;
        let is_heavy = !has_null_directions
            && n_free > 0
            && (block * size..(block + 1) * size).any(|i| !may_move(i))
            && sides.iter().any(|side| self.side_weight(side) > limit);
        let mut basis = Vec::new();
        let has_dependent_means =
            is_heavy && self.rank_of_means(block, may_move, &mut basis) < sides.len();
        let max_weight = if has_dependent_means { limit } else { f64::INFINITY };
        for (l, side) in (n_free..).zip(sides) {
            out[l * n + l] = -unit / (self.side_weight(side) / *reduction).min(max_weight);
        }
        if has_null_directions {
            let tolerance = T::EPSILON.sqrt();
            null_directions.append(block as u32, out, (n_free, n), unit, tolerance);
        }
        let is_positive = invert_in_place(out, n).ok_or(FactorError::Singular)?;
        // With a positive definite stiffness there are as many negative eigenvalues as jumps.
        if is_positive != (sides.len() % 2 == 0) {
            return Err(FactorError::NotPositive);
        }
        if has_null_directions {
            null_directions.couple(out, (n_free, n), unit, scales);
        }
        for k in 0..n {
            for l in 0..n {
                let entry = &mut out[k * n + l];
                match (k < n_free, l < n_free) {
                    (true, true) => *entry = *entry * scales[k] * scales[l] / unit,
                    (false, false) => *entry *= unit,
                    (true, false) => *entry *= scales[k],
                    (false, true) => *entry *= scales[l],
                }
            }
        }
        Ok(n_free)
    }

    /// Sets `inverse` to the matrix `[[K + D, B^T], [B, 0]]` of a block with `n_free` free unknowns, `D` the
    /// shift, `K + D` divided by `unit`. Where there are null directions, unknowns with a large shift are
    /// scaled to the size of the others.
    fn fill_block(
        &self,
        (block, n_free): (usize, usize),
        is_free: &[bool],
        shift: &[f64],
        unit: f64,
        inverse: &mut BlockInverse,
    ) {
        let (size, sides) = (self.penalised.block_size, self.sides(block));
        let stiffness = |i: usize, j: usize| self.penalised.blocks[i * size + j % size].to_f64();
        let BlockInverse { entries: out, scales, .. } = inverse;
        scales.clear();
        scales.extend(self.free(block, is_free).map(|i| match shift.get(i) {
            Some(&shift) if self.has_null_directions => {
                (unit / (stiffness(i, i) + shift)).min(1.0).sqrt()
            }
            _ => 1.0,
        }));
        let n = n_free + sides.len();
        out.clear();
        out.resize(n * n, 0.0);
        for (k, i) in self.free(block, is_free).enumerate() {
            for (l, j) in self.free(block, is_free).enumerate() {
                out[k * n + l] = scales[k] * scales[l] * stiffness(i, j) / unit;
            }
            if let Some(&shift) = shift.get(i) {
                out[k * n + k] += scales[k] * scales[k] * shift / unit;
            }
            for (l, side) in (n_free..).zip(sides) {
                let coefficient = scales[k] * self.mean_coefficient(side, i);
                out[k * n + l] = coefficient;
                out[l * n + k] = coefficient;
            }
        }
    }

    /// [`StaticCondensation::solve`] with the reduced weights in place of `S`.
    pub(super) fn solve_reduced(
        &self,
        factors: &CondensedFactors<T>,
        is_free: &[bool],
        r: &mut [f64],
        t: &mut [f64],
    ) -> f64 {
        let n_means = self.pattern.size();
        let CondensedFactors { null_directions, .. } = factors;
        let mut load = vec![0.0; n_means];
        let mut local = Vec::new();
        for block in 0..self.starts.len() - 1 {
            self.block_right_side(block, is_free, r, t, &|_| 0.0, &mut local);
            let n_free = local.len() - self.sides(block).len();
            for (k, side) in (n_free..).zip(self.sides(block)) {
                if side.mean != NO_INDEX {
                    load[side.mean as usize] += factors.row_dot(block, k, &local);
                }
            }
        }
        self.append_null_loads(null_directions, is_free, r, t, &mut load);
        let mut means: Vec<T> = load.into_iter().map(T::lit).collect();
        factors.schur_complement.solve_in_place(&mut means, 1);
        let mean = |k: u32| if k == NO_INDEX { 0.0 } else { means[k as usize].to_f64() };
        let jump_right_side = t.to_vec();
        let mut energy = 0.0;
        let mut directions = 0..0;
        for block in 0..self.starts.len() - 1 {
            directions = null_directions.of_block(block, directions.end);
            self.block_right_side(block, is_free, r, &jump_right_side, &mean, &mut local);
            let n = self.penalised.block_size;
            let mut k = 0;
            for i in block * n..(block + 1) * n {
                let response =
                    |q: usize| null_directions.responses(q)[k] * means[n_means + q].to_f64();
                let value = match is_free[i] {
                    true => directions
                        .clone()
                        .map(response)
                        .fold(factors.row_dot(block, k, &local), |s, x| s + x),
                    false => 0.0,
                };
                energy += value * r[i];
                r[i] = value;
                k += usize::from(is_free[i]);
            }
            for (k, side) in (k..).zip(self.sides(block)) {
                // The multipliers of the two sides of a facet are equal.
                if side.sign > 0.0 || side.mean == NO_INDEX {
                    let multiplier = side.sign * factors.row_dot(block, k, &local);
                    energy -= multiplier * jump_right_side[side.jump as usize];
                    t[side.jump as usize] = multiplier;
                }
            }
        }
        for (k, (&block, q)) in null_directions.blocks().iter().zip(&means[n_means..]).enumerate() {
            let sides = self.sides(block as usize).iter().zip(null_directions.entries(k));
            for (side, y) in sides.filter(|(s, _)| s.sign > 0.0 || s.mean == NO_INDEX) {
                let multiplier = -side.sign * y * q.to_f64();
                energy -= multiplier * jump_right_side[side.jump as usize];
                t[side.jump as usize] += multiplier;
            }
        }
        energy
    }

    /// Appends the right-hand sides of the equations of the multipliers of null directions.
    fn append_null_loads(
        &self,
        null_directions: &NullDirections,
        is_free: &[bool],
        r: &[f64],
        t: &[f64],
        load: &mut Vec<f64>,
    ) {
        load.extend(null_directions.blocks().iter().enumerate().map(|(k, &block)| {
            let sides = self.sides(block as usize).iter().zip(null_directions.entries(k));
            let unknowns = self.free(block as usize, is_free).zip(null_directions.responses(k));
            let of_unknowns = unknowns.fold(0.0, |s, (i, g)| s + g * r[i]);
            sides.fold(of_unknowns, |s, (side, y)| s - y * side.share() * t[side.jump as usize])
        }));
    }

    /// The right-hand side of the equations of a block: `r` on its free unknowns, then for each side
    /// the facet mean plus its part of `t`.
    fn block_right_side(
        &self,
        block: usize,
        is_free: &[bool],
        r: &[f64],
        t: &[f64],
        mean: &dyn Fn(u32) -> f64,
        out: &mut Vec<f64>,
    ) {
        out.clear();
        out.extend(self.free(block, is_free).map(|i| r[i]));
        let sides = self.sides(block).iter();
        out.extend(sides.map(|side| mean(side.mean) + side.share() * t[side.jump as usize]));
    }

    /// Sums of the absolute values of terms of the residual `(c - K u - M^T p)_i`: first of the
    /// terms with free unknowns and jump multipliers `p`, then of the terms with fixed unknowns and
    /// of the load.
    pub fn residual_term_sizes(
        &self,
        i: usize,
        u: &dyn Fn(usize) -> f64,
        p: &[T],
        is_fixed: &dyn Fn(usize) -> bool,
    ) -> [f64; 2] {
        let n = self.penalised.block_size;
        let block = i / n;
        let (mut free, mut fixed) = (0.0, self.penalised.load[i].to_f64().abs());
        for j in block * n..(block + 1) * n {
            let size = (self.penalised.blocks[i * n + j % n].to_f64() * u(j)).abs();
            *(if is_fixed(j) { &mut fixed } else { &mut free }) += size;
        }
        for side in self.sides(block) {
            free += (self.mean_coefficient(side, i) * p[side.jump as usize].to_f64()).abs();
        }
        [free, fixed]
    }

    /// The largest absolute value of the unknowns in the block of unknown `i` and in the jumps over its sides.
    pub fn largest_value_near(&self, i: usize, u: impl Fn(usize) -> f64) -> f64 {
        let n = self.penalised.block_size;
        let block = i / n;
        let of_block = (block * n..(block + 1) * n).map(&u).fold(0.0, |m: f64, x| m.max(x.abs()));
        let sides = self.sides(block).iter();
        let terms = sides.flat_map(|side| self.penalised.terms_of(side.jump as usize));
        let unknowns = terms.flat_map(|term| [term.here, term.there]).filter(|&j| j != NO_INDEX);
        unknowns.map(|j| u(j as usize)).fold(of_block, |m, x| m.max(x.abs()))
    }
}

impl<T> CondensedFactors<T> {
    /// Row `k` of a block's inverse times a vector.
    fn row_dot(&self, block: usize, k: usize, x: &[f64]) -> f64 {
        let row = &self.inverses[self.starts[block] + k * x.len()..][..x.len()];
        row.iter().zip(x).fold(0.0, |s, (a, x)| s + a * x)
    }
}

/// The matrix without rows.
fn empty<T>() -> SparseMatrix<T> {
    SparseMatrix { row_starts: vec![0], columns: Vec::new(), values: Vec::new() }
}
