//! The conforming linear functions that multigrid works on.

use std::sync::Arc;

use super::coarse_level::{CoarseLevel, P1Level};

/// The conforming linear functions near an inequality.
#[derive(Clone, Debug, Default)]
pub enum CoarseSpaces<T> {
    /// None known; they are then made from the matrix and the supports of its unknowns alone.
    #[default]
    Unknown,
    /// The unknowns are themselves the vertex values; these are coarser ones.
    CoarseLevel(CoarseLevel<T>),
    /// Those on the same mesh.
    Same(Arc<P1Level<T>>),
}
