//! What schemes read of a mesh as a whole: the box around the mesh, and the mesh size.

use crate::real::Point;

/// The box around a mesh, and the mesh size: all that a scheme derives from a mesh as a whole.
///
/// A part of a mesh has the extent of the whole: the factor of an over-penalty is the same on all parts. The
/// extents of parts that contain every cell [merge](Extent::merge) into that of the whole, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Extent<const D: usize> {
    /// Lower end of the smallest box that contains the mesh; not a number on a refined part of a disc or of a mesh with
    /// a [shape](crate::mesh::Mesh::with_shape), until [`Mesh::with_extent`](crate::mesh::Mesh::with_extent) states it.
    pub lower: Point<D>,
    /// Its upper end.
    pub upper: Point<D>,
    /// The largest cell diameter; not a number on a part that was refined, as before.
    pub mesh_size: f64,
}

impl<const D: usize> Extent<D> {
    /// The extent of the cells of both.
    #[must_use]
    pub fn merge(self, other: Self) -> Self {
        Self {
            lower: self.lower.zip_map(&other.lower, f64::min),
            upper: self.upper.zip_map(&other.upper, f64::max),
            mesh_size: self.mesh_size.max(other.mesh_size),
        }
    }
    /// The diagonal of the box.
    pub fn diameter(&self) -> f64 {
        (self.upper - self.lower).norm()
    }
    /// What is known of a refinement: new vertices lie between old ones.
    pub(in crate::mesh) fn refined(self) -> Self {
        Self { mesh_size: f64::NAN, ..self }
    }
    /// What is known where vertices on the boundary were moved besides: nothing.
    pub(in crate::mesh) fn moved(self) -> Self {
        let unknown = Point::repeat(f64::NAN);
        Self { lower: unknown, upper: unknown, mesh_size: f64::NAN }
    }
}
