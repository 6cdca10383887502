//! The form of an over-penalised discontinuous linear element on its facet mean functions.
//!
//! The facet mean function of a side is the linear function on the cell of the side with mean one on its facet
//! and mean zero on the other facets of the cell: the Crouzeix-Raviart basis. Sides have the indices of
//! [`SidePenalties`](crate::algebra::SidePenalties).

use crate::algebra::PenalisedMatrix;
use crate::real::Real;

/// The value at a vertex of the facet mean function of a facet, in a cell of `cell_size` vertices; facet `i` is
/// opposite to vertex `i`.
#[inline(always)]
pub(super) fn facet_mean_function<T: Real>(cell_size: usize, vertex: usize, facet: usize) -> T {
    T::lit(if vertex == facet { 2.0 - cell_size as f64 } else { 1.0 })
}

/// The stiffness form of the facet mean functions of two sides of a cell; `are_means` is that of
/// [`SidePenalties`](crate::algebra::SidePenalties).
pub(super) fn stiffness<T: Real>(
    penalised: &PenalisedMatrix<T>,
    [one, other]: [usize; 2],
    are_means: bool,
) -> T {
    let size = penalised.block_size();
    let first = one / size * size;
    let entry = |i: usize, j: usize| penalised.blocks[(first + i) * size + j];
    let (one, other) = (one - first, other - first);
    if are_means {
        return entry(one, other);
    }
    let mut sum = T::lit(0.0);
    for i in 0..size {
        for j in 0..size {
            let weight: T =
                facet_mean_function::<T>(size, i, one) * facet_mean_function::<T>(size, j, other);
            sum += weight * entry(i, j);
        }
    }
    sum
}
