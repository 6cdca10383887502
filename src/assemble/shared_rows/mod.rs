//! Rows of spaces that share unknowns.
//!
//! Without a form on facets each cell adds its matrix to the places in its rows that were noted when
//! the pattern was made: see [`pattern`](pattern::pattern) and [`fill`](fill::fill). With one, which
//! is rare here, rows gather from the matrices of [`patches`].

mod cells;
mod fill;
pub(crate) mod partition;
mod patches;
pub(crate) mod pattern;

use super::Discretisation;
use crate::algebra::SparseMatrix;
use crate::real::Real;
use crate::scheme::Scheme;
pub(crate) use pattern::Places;

/// The pattern, with values zero.
pub(crate) fn pattern<T: Real, const D: usize, S: Scheme<T, D>>(
    discretisation: &Discretisation<'_, T, D, S>,
) -> SparseMatrix<T> {
    if Discretisation::<T, D, S>::COUPLES {
        patches::pattern(discretisation)
    } else {
        pattern::pattern::<T, D, S::Element>(&discretisation.space.dofs)
    }
}

/// The values, on a known pattern.
pub(crate) fn fill<T: Real, const D: usize, S: Scheme<T, D>>(
    discretisation: &Discretisation<'_, T, D, S>,
    matrix: &mut SparseMatrix<T>,
) {
    if Discretisation::<T, D, S>::COUPLES {
        patches::fill(discretisation, matrix);
    } else {
        fill::fill::<T, D, S::Element>(&discretisation.space, matrix);
    }
}
