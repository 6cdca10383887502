//! From lists to a mesh: every check that lets later code do without.

use super::{BoundaryPart, Mesh, MeshError};
use crate::real::{Point, Real};

/// A facet and the boundary part it is said to belong to: its `D` vertices in any order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TaggedFacet<const D: usize> {
    /// The vertices.
    pub vertices: [u32; D],
    /// The part.
    pub part: BoundaryPart,
}

impl<T: Real, const D: usize> Mesh<T, D> {
    /// A mesh from vertices, cells (`D + 1` vertices each, in any order) and the parts of its
    /// boundary facets.
    ///
    /// Vertices that no cell uses are dropped and the others renumbered in their order. Cells keep
    /// their order.
    ///
    /// # Errors
    /// Every [`MeshError`] but [`MeshError::UnsupportedComponent`], which depends on the problem:
    /// see [`Mesh::check_supported`].
    pub fn new(
        vertices: Vec<Point<f64, D>>,
        cells: Vec<u32>,
        boundary: &[TaggedFacet<D>],
    ) -> Result<Self, MeshError> {
        let _ = (vertices, cells, boundary);
        todo!("validation")
    }
}
