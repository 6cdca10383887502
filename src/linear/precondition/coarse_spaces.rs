//! The conforming linear functions that are known for an inequality.

use std::sync::Arc;

use super::coarse_level::{CoarseLevel, P1Level};

/// Spaces of conforming linear functions for multigrid.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub enum CoarseSpaces<T> {
    /// No space is known. Iterative solvers construct one from the matrix and the supports of unknowns.
    #[default]
    Unknown,
    /// The unknowns are the vertex values of conforming linear functions, and the space on the next
    /// coarser mesh is known.
    CoarseLevel(CoarseLevel<T>),
    /// The unknowns are those of another finite element, and the conforming linear functions on the
    /// same mesh are known.
    SameMesh(Arc<P1Level<T>>),
}
