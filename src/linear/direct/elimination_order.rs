//! An order of elimination that serves a matrix and its submatrices.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;

use super::error::{FactorError, out_of_memory};
use super::symbolic_factor::transpose_view;
use crate::algebra::{NO_INDEX, SparseMatrix, Submatrix};
use crate::real::Real;

/// An order of elimination for the unknowns of a symmetric matrix, and by restriction for each subset
/// of them: approximate minimum degree (P. R. Amestoy, T. A. Davis, I. S. Duff, SIAM J. Matrix Anal.
/// Appl. 17 (1996), 886-905). An active set method computes it once for all active sets.
#[derive(Clone, Debug)]
pub(crate) struct EliminationOrder {
    unknowns: Vec<u32>,
}

impl EliminationOrder {
    /// The order for the unknowns `free` (ascending) of a matrix. Only the lower triangle is read.
    ///
    /// # Errors
    /// [`FactorError::OutOfMemory`].
    ///
    /// # Panics
    /// If `free` contains a row that the matrix does not have.
    pub fn new<T: Real>(matrix: &SparseMatrix<T>, free: &[u32]) -> Result<Self, FactorError> {
        let lower = Submatrix::lower_triangle(matrix, free);
        let pattern = transpose_view(&lower);
        let n = free.len();
        let (mut order, mut inverse) = (vec![0_u32; n], vec![0_u32; n]);
        let scratch = amd::order_scratch::<u32>(n, lower.columns.len());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
        let (stack, control) = (MemStack::new(&mut memory), amd::Control::default());
        amd::order(&mut order, &mut inverse, pattern.symbolic(), control, stack)
            .map_err(out_of_memory)?;
        Ok(Self { unknowns: order.into_iter().map(|k| free[k as usize]).collect() })
    }

    /// The restriction of the order to the unknowns `free` of a matrix with `size` rows: positions in
    /// `free` in the order of elimination. Unknowns of `free` that are not in the order come last.
    ///
    /// # Panics
    /// If `free` contains an unknown that is not less than `size`.
    pub fn restricted_to(&self, free: &[u32], size: usize) -> Vec<u32> {
        let mut positions = vec![NO_INDEX; size];
        free.iter().enumerate().for_each(|(k, &i)| positions[i as usize] = k as u32);
        let take = |&i: &u32| positions.get_mut(i as usize).map(|k| std::mem::replace(k, NO_INDEX));
        let all = self.unknowns.iter().chain(free).filter_map(take);
        all.filter(|&k| k != NO_INDEX).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::direct::Factors;

    /// Whatever an order knows of other unknowns, its restriction has each free one once, those that it does not know
    /// last; and the factors are those of the same matrix.
    #[test]
    fn the_restriction_of_an_order_is_a_permutation() {
        let matrix = SparseMatrix::<f64>::second_differences(9);
        let order = EliminationOrder::new(&matrix, &[1, 2, 3, 5, 7]).unwrap();
        let free = [0, 2, 3, 7, 8];
        let positions = order.restricted_to(&free, 9);
        let mut sorted = positions.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2, 3, 4]);
        assert_eq!(positions[3..], [0, 4]);
        let right = [1.0, -2.0, 3.0, 5.0, 0.5];
        let (mut x, mut y) = (right, right);
        Factors::in_order(&matrix, &free, &order, &[]).unwrap().solve_in_place(&mut x, 1);
        Factors::new(&matrix, true, &free).unwrap().solve_in_place(&mut y, 1);
        for (x, y) in x.iter().zip(&y) {
            assert!((x - y).abs() <= 1e-14, "{x} {y}");
        }
        assert!(order.restricted_to(&[], 9).is_empty());
    }
}
