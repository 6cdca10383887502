//! A conforming P1 function from which a solve starts.

use crate::algebra::{Contact, Support};
use crate::linear::CoarseSpaces;
use crate::real::Real;

/// A conforming P1 function from which a solve starts: the solution on the same mesh, or the
/// prolongation of the solution on the next coarser one.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct P1Solution<T> {
    /// The contact state of every vertex.
    pub contact: Vec<Contact>,
    /// The value at every vertex; empty if the solve did not converge.
    pub values: Vec<T>,
    /// The conforming P1 spaces of this and all coarser levels.
    pub coarse_spaces: CoarseSpaces<T>,
    /// Seconds of assembly, solve and prolongation on this level and all coarser ones.
    pub seconds: f64,
    /// Number of levels on which conforming P1 was solved.
    pub levels_solved: usize,
    /// Cycles of monotone multigrid for the start on the coarsest mesh.
    pub start_cycles: usize,
}

impl<T: Real> P1Solution<T> {
    /// The starting contact of unknowns: an unknown starts in contact if more than half of the vertices
    /// of its support are in contact.
    pub(super) fn contact_of(&self, supports: &[Support]) -> Vec<Contact> {
        let state = |support: &Support| {
            let vertices = support.vertices();
            [Contact::Lower, Contact::Upper]
                .into_iter()
                .find(|&side| {
                    let on = vertices.iter().filter(|&&v| self.contact[v as usize] == side).count();
                    2 * on > vertices.len()
                })
                .unwrap_or(Contact::Inactive)
        };
        supports.iter().map(state).collect()
    }

    /// The starting values of unknowns: the means of values over the vertices of each support; none
    /// without values.
    pub(super) fn values_of(&self, supports: &[Support]) -> Option<Vec<T>> {
        let mean = |support: &Support| {
            let vertices = support.vertices();
            let sum = vertices.iter().fold(T::lit(0.0), |s, &v| s + self.values[v as usize]);
            sum / T::lit(vertices.len().max(1) as f64)
        };
        (!self.values.is_empty()).then(|| supports.iter().map(mean).collect())
    }
}
