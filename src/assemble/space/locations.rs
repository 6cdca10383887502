//! The locations of unknowns: for each node, the vertices of a cell whose barycentre is the node.

use super::Space;
use crate::algebra::DofLocation;
use crate::element::Entity;
use crate::memory::in_large_pages;
use crate::parallel::vectors::collect;

impl<const D: usize> Space<'_, D> {
    /// The location of each unknown.
    pub fn locations(&self) -> Vec<DofLocation> {
        let n = self.dofs.size();
        if self.broken {
            let per_cell = self.per_cell() as u32;
            return collect(n, |unknown| {
                let (cell, node) = (unknown as u32 / per_cell, unknown as u32 % per_cell);
                let node = &self.node_vertices[node as usize];
                node.location(Some(cell), self.mesh.cell(cell as usize))
            });
        }
        if self.nodes.iter().all(|node| matches!(node.entity(), Entity::Vertex(_))) {
            // unknowns are numbered like the vertices that own them
            return collect(n, |vertex| DofLocation::new(None, &[vertex as u32]));
        }
        let mut locations = in_large_pages(vec![DofLocation::new(None, &[]); n]);
        for cell in 0..self.mesh.n_cells() {
            let vertices = self.mesh.cell(cell);
            for (i, node) in self.node_vertices.iter().enumerate() {
                locations[self.dofs.of(cell, i)] = node.location(None, vertices);
            }
        }
        locations
    }
}
