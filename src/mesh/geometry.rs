//! Geometry.
/// stub
pub struct CellGeometry;
