//! The conforming linear functions that multigrid works on.

use std::sync::Arc;

use super::coarse_level::{Coarser, VertexLevel};

/// The conforming linear functions near an inequality.
#[derive(Clone, Debug, Default)]
pub enum Functions<T> {
    /// None known; they are then made from the matrix and the places of its unknowns alone.
    #[default]
    Unknown,
    /// The unknowns are themselves the vertex values; these are coarser ones.
    Coarser(Coarser<T>),
    /// Those on the same mesh.
    Same(Arc<VertexLevel<T>>),
}
