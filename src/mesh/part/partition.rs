//! Which part of a mesh each cell belongs to.

use crate::mesh::error::MeshError;
use crate::mesh::renumber::order_along_curve;
use crate::mesh::simplicial::Mesh;

impl<const D: usize> Mesh<D> {
    /// The number of the part of each cell, for a number of parts with equally many cells, up to one: stretches of the
    /// Hilbert curve through the barycentres. It depends on nothing but the mesh, so that processes that have the same
    /// mesh find the same parts.
    ///
    /// # Errors
    /// `MeshErrorKind::Parameter` for no parts, and for more parts than cells.
    pub fn partition(&self, parts: usize) -> Result<Vec<u32>, MeshError> {
        let n_cells = self.n_cells();
        if parts == 0 || parts > n_cells {
            let allowed = format!("1 to {n_cells}, the number of cells");
            return Err(MeshError::parameter("number of parts", parts, allowed));
        }
        let barycentres: Vec<[f64; D]> = (0..n_cells).map(|c| self.barycentre(c).into()).collect();
        let mut part_of = vec![0; n_cells];
        for (position, cell) in (0_u64..).zip(order_along_curve(&barycentres)) {
            part_of[cell as usize] = (position * parts as u64 / n_cells as u64) as u32;
        }
        Ok(part_of)
    }
}
