//! Numbers of vertices in the order of cells.

use super::boundary::BoundaryFacet;
use super::simplicial::Mesh;
use crate::real::Real;

impl<T: Real, const D: usize> Mesh<T, D> {
    /// The same cells with the vertices in the order in which cells name them first, and the new numbers of the
    /// vertices.
    pub(crate) fn in_order_of_cells(&self) -> (Self, Vec<u32>) {
        const NONE: u32 = u32::MAX;
        let mut numbers = vec![NONE; self.vertices.len()];
        let mut vertices = Vec::with_capacity(self.vertices.len());
        for &v in &self.cells {
            let number = &mut numbers[v as usize];
            if *number == NONE {
                *number = vertices.len() as u32;
                vertices.push(self.vertices[v as usize]);
            }
        }
        let mut cells: Vec<u32> = self.cells.iter().map(|&v| numbers[v as usize]).collect();
        cells.chunks_exact_mut(D + 1).for_each(<[u32]>::sort_unstable);
        let renumbered = |facet: &BoundaryFacet| {
            let cell = self.cell(facet.cell as usize);
            let opposite = numbers[cell[facet.local as usize] as usize];
            let before = cell.iter().filter(|&&v| numbers[v as usize] < opposite).count();
            BoundaryFacet { local: before as u8, ..*facet }
        };
        let mut boundary: Vec<BoundaryFacet> = self.boundary.iter().map(renumbered).collect();
        BoundaryFacet::sort(&mut boundary);
        let (groups, cell_regions) = (self.groups.clone(), self.cell_regions.clone());
        let is_supported = self.is_supported;
        (Self { vertices, cells, boundary, is_supported, groups, cell_regions }, numbers)
    }
}
