//! A matrix whose submatrices are factored in one order of elimination.

use std::sync::OnceLock;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;

use super::error::{FactorError, out_of_memory};
use super::factors::Factors;
use super::symbolic_factor::transpose_view;
use crate::algebra::{NO_INDEX, RectangularMatrix, SparseMatrix};
use crate::parallel::once;
use crate::parallel::vectors::positions;
use crate::real::Real;

/// A symmetric matrix with an order of elimination, whose restriction serves each set of free unknowns: approximate
/// minimum degree (P. R. Amestoy, T. A. Davis, I. S. Duff, SIAM J. Matrix Anal. Appl. 17 (1996), 886-905). An active set
/// method computes it once for all active sets.
pub(crate) struct OrderedMatrix<'a, T> {
    matrix: &'a SparseMatrix<T>,
    /// The unknowns for which the order is computed, ascending.
    unknowns: Vec<u32>,
    /// These unknowns in the order of elimination, from the first factorisation on.
    order: OnceLock<Vec<u32>>,
}

impl<'a, T: Real> OrderedMatrix<'a, T> {
    /// The matrix with the order for some of its unknowns, ascending; free unknowns besides these come last. Only the
    /// lower triangle is read.
    pub fn new(matrix: &'a SparseMatrix<T>, unknowns: Vec<u32>) -> Self {
        Self { matrix, unknowns, order: OnceLock::new() }
    }

    /// The Cholesky factor of `A + D` on the unknowns `free` (ascending). `shift` is the nonnegative diagonal of `D`, or
    /// empty for zero.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(&self, free: &[u32], shift: &[f64]) -> Result<Factors<T>, FactorError> {
        let order = match self.order.get() {
            Some(order) => order,
            None => {
                let new = minimum_degree(self.matrix, &self.unknowns)?;
                once(&self.order, || new)
            }
        };
        Factors::in_order(self.matrix, free, restricted(order, free, self.matrix.size()), shift)
    }
}

/// The unknowns `free` (ascending) of a matrix in the order of approximate minimum degree.
///
/// # Errors
/// [`FactorError::OutOfMemory`].
fn minimum_degree<T: Real>(
    matrix: &SparseMatrix<T>,
    free: &[u32],
) -> Result<Vec<u32>, FactorError> {
    let lower = matrix.lower_triangle(free);
    let pattern = transpose_view(&lower);
    let n = free.len();
    let (mut order, mut inverse) = (vec![0_u32; n], vec![0_u32; n]);
    let scratch = amd::order_scratch::<u32>(n, lower.columns.len());
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
    let (stack, control) = (MemStack::new(&mut memory), amd::Control::default());
    amd::order(&mut order, &mut inverse, pattern.symbolic(), control, stack)
        .map_err(out_of_memory)?;
    Ok(order.into_iter().map(|k| free[k as usize]).collect())
}

/// The rows of a symmetric matrix in the order of approximate minimum degree of groups of rows, which is found much faster
/// than that of the rows. `starts` has the first row of each group and the number of rows at the end.
///
/// # Errors
/// [`FactorError::OutOfMemory`].
pub(crate) fn minimum_degree_of_groups<T: Real>(
    matrix: &SparseMatrix<T>,
    starts: &[u32],
) -> Result<Vec<u32>, FactorError> {
    let n_groups = starts.len() - 1;
    let rows_of = |group: usize| starts[group]..starts[group + 1];
    let mut group_of = vec![0; matrix.size()];
    for group in 0..n_groups {
        rows_of(group).for_each(|row| group_of[row as usize] = group as u32);
    }
    let mut last = vec![NO_INDEX; n_groups];
    let RectangularMatrix { starts: row_starts, columns, values } =
        RectangularMatrix::by_rows(0..n_groups, |group, columns, values| {
            let first = columns.len();
            for row in rows_of(group) {
                for &j in matrix.row(row as usize).0 {
                    let other = group_of[j as usize];
                    if std::mem::replace(&mut last[other as usize], group as u32) != group as u32 {
                        columns.push(other);
                        values.push(T::lit(1.0));
                    }
                }
            }
            columns[first..].sort_unstable();
        });
    let groups: Vec<u32> = (0..n_groups as u32).collect();
    let order = minimum_degree(&SparseMatrix { row_starts, columns, values }, &groups)?;
    Ok(order.into_iter().flat_map(|group| rows_of(group as usize)).collect())
}

/// The restriction of an order of unknowns to the unknowns `free` of a matrix with `size` rows: positions in `free` in
/// the order of elimination. Unknowns of `free` that are not in the order come last.
fn restricted(order: &[u32], free: &[u32], size: usize) -> Vec<u32> {
    let mut positions = positions(size, free);
    let take = |&i: &u32| std::mem::replace(&mut positions[i as usize], NO_INDEX);
    order.iter().chain(free).map(take).filter(|&k| k != NO_INDEX).collect()
}
