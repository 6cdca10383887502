//! Mesh entities that can be in contact, and the solution that says whether they are.

use crate::algebra::Inequality;
use crate::inequality::Solution;

/// An inequality and its solution.
pub(in crate::measure) type SolvedInequality<'s> = (&'s Inequality<f64>, &'s Solution<f64>);

/// A mesh entity that can be in contact: a cell under an obstacle, or a facet of the contact
/// boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ContactEntity {
    pub cell: usize,
    /// Number of the facet in the cell.
    pub facet: Option<usize>,
}

impl ContactEntity {
    /// The vertices of the entity, as numbers in the cell.
    pub fn corners<const D: usize>(self) -> impl Iterator<Item = usize> + Clone {
        (0..D + 1).filter(move |&k| Some(k) != self.facet)
    }
    /// The dimension of the entity.
    pub fn dimension<const D: usize>(self) -> usize {
        D - usize::from(self.facet.is_some())
    }
}
