//! The inverse of one block of a [`StaticCondensation`] with its jump multipliers.

use nalgebra::DMatrix;

use super::error::FactorError;
use super::static_condensation::StaticCondensation;
use crate::real::Real;

/// The largest weight of a block whose means over sides are linearly dependent because unknowns are fixed, divided by
/// `k / eps`: `k` is the least positive diagonal entry of the stiffness of the block, `eps` machine epsilon. Larger
/// weights are reduced to this limit.
const MAX_WEIGHT: f64 = 1e-3;

/// The largest shift, divided by `k / sqrt(eps)` with `k` and `eps` of [`MAX_WEIGHT`], with which an unknown counts as
/// free in the rank of the means. A larger shift acts like Dirichlet data.
const MAX_SHIFT_BY_ROOT: f64 = 4.0;

impl<T: Real> StaticCondensation<'_, T> {
    /// Whether the means over the sides of a block are linearly independent as functions of the unknowns for which
    /// `is_variable` is true: whether their Gram matrix has a Cholesky factor, and no mean is the combination of others
    /// but for rounding.
    pub(super) fn has_independent_means(
        &self,
        block: usize,
        is_variable: impl Fn(usize) -> bool,
    ) -> bool {
        let (n, sides) = (self.penalised.block_size(), self.sides(block));
        let coefficients = DMatrix::from_fn(n, sides.len(), |k, l| match block * n + k {
            i if is_variable(i) => self.mean_coefficient(sides[l], i),
            _ => 0.0,
        });
        let factor = coefficients.tr_mul(&coefficients).cholesky();
        let least = T::EPSILON.sqrt().sqrt();
        factor.is_some_and(|factor| factor.l_dirty().diagonal().iter().all(|&d| d > least))
    }

    /// Sets `inverse` to the inverse of a block with its jump multipliers; returns the number of free
    /// unknowns of the block.
    ///
    /// # Errors
    /// [`FactorError::Singular`] or [`FactorError::NotPositive`].
    pub(super) fn invert_block(
        &self,
        block: usize,
        is_free: &[bool],
        shift: &[f64],
        inverse: &mut Vec<f64>,
    ) -> Result<usize, FactorError> {
        let (size, sides) = (self.penalised.block_size(), self.sides(block));
        let stiffness = |i: usize, j: usize| self.penalised.blocks[i * size + j % size].to_f64();
        let n_free = self.free(block, is_free).count();
        let n = n_free + sides.len();
        // The stiffness is divided, and the reciprocal weights are multiplied, by its largest diagonal entry.
        let diagonal = || self.free(block, is_free).map(|i| stiffness(i, i));
        let largest = diagonal().fold(0.0, f64::max);
        let least = diagonal().filter(|&d| d > 0.0).fold(largest, f64::min);
        let unit = if largest > 0.0 { largest } else { 1.0 };
        let max_shift = least * MAX_SHIFT_BY_ROOT / T::EPSILON.sqrt();
        let is_variable =
            |i: usize| is_free[i] && shift.get(i).is_none_or(|&shift| shift <= max_shift);
        self.fill_block((block, n_free), is_free, shift, unit, inverse);
        let limit = least * MAX_WEIGHT / T::EPSILON;
        let may_need_limit = n_free > 0
            && (block * size..(block + 1) * size).any(|i| !is_variable(i))
            && sides.iter().any(|&side| self.side_weight(side) > limit);
        let has_dependent_means = may_need_limit && !self.has_independent_means(block, is_variable);
        let max_weight = if has_dependent_means { limit } else { f64::INFINITY };
        for (l, &side) in (n_free..).zip(sides) {
            inverse[l * n + l] = -unit / self.side_weight(side).min(max_weight);
        }
        let factors = DMatrix::from_row_slice(n, n, inverse).lu();
        let is_positive = factors.determinant() > 0.0;
        // of a symmetric matrix: rows are columns
        let inverted = factors.try_inverse().filter(|matrix| matrix.iter().all(|a| a.is_finite()));
        inverse.copy_from_slice(inverted.ok_or(FactorError::Singular)?.as_slice());
        // With a positive definite stiffness there are as many negative eigenvalues as sides.
        if is_positive != (sides.len() % 2 == 0) {
            return Err(FactorError::NotPositive);
        }
        for k in 0..n {
            for l in 0..n {
                let entry = &mut inverse[k * n + l];
                match (k < n_free, l < n_free) {
                    (true, true) => *entry /= unit,
                    (false, false) => *entry *= unit,
                    _ => {}
                }
            }
        }
        Ok(n_free)
    }

    /// Sets `matrix` to `[[(K + D) / unit, B^T], [B, 0]]` of a block with `n_free` free unknowns: `D` is the shift, and
    /// `B` contains the means over sides.
    fn fill_block(
        &self,
        (block, n_free): (usize, usize),
        is_free: &[bool],
        shift: &[f64],
        unit: f64,
        matrix: &mut Vec<f64>,
    ) {
        let (size, sides) = (self.penalised.block_size(), self.sides(block));
        let stiffness = |i: usize, j: usize| self.penalised.blocks[i * size + j % size].to_f64();
        let n = n_free + sides.len();
        matrix.clear();
        matrix.resize(n * n, 0.0);
        for (k, i) in self.free(block, is_free).enumerate() {
            for (l, j) in self.free(block, is_free).enumerate() {
                matrix[k * n + l] = stiffness(i, j) / unit;
            }
            if let Some(&shift) = shift.get(i) {
                matrix[k * n + k] += shift / unit;
            }
            for (l, &side) in (n_free..).zip(sides) {
                let coefficient = self.mean_coefficient(side, i);
                matrix[k * n + l] = coefficient;
                matrix[l * n + k] = coefficient;
            }
        }
    }
}
