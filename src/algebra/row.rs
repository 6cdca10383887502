//! The entries of a sparse row in the making.

use crate::real::Real;

/// Sorts the entries of a row by their columns; generic over the scalar alone, so that the sorting code
/// is not compiled for every caller.
pub(crate) fn sort_by_column<T: Real>(row: &mut [(u32, T)]) {
    row.sort_unstable_by_key(|&(column, _)| column);
}
