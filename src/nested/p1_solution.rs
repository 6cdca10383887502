//! A conforming P1 function from which a solve starts.

use crate::algebra::Contact;
use crate::linear::CoarseSpaces;

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
