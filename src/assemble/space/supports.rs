//! The supports of basis functions: for each node, the vertices of a cell whose barycentre is the node.

use super::Space;
use crate::algebra::Support;
use crate::element::Entity;
use crate::memory::in_large_pages;
use crate::parallel::vectors::collect;

impl<const D: usize> Space<'_, D> {
    /// The support of each unknown.
    pub fn supports(&self) -> Vec<Support> {
        let n = self.dofs.size();
        if self.broken {
            let per_cell = self.per_cell() as u32;
            return collect(n, |unknown| {
                let (cell, node) = (unknown as u32 / per_cell, unknown as u32 % per_cell);
                let node = &self.node_vertices[node as usize];
                node.support(Some(cell), self.mesh.cell(cell as usize))
            });
        }
        if self.nodes.iter().all(|node| matches!(node.entity(), Entity::Vertex(_))) {
            // unknowns are numbered like the vertices that own them
            return collect(n, |vertex| Support::new(None, &[vertex as u32]));
        }
        let mut supports = in_large_pages(vec![Support::new(None, &[]); n]);
        for cell in 0..self.mesh.n_cells() {
            let vertices = self.mesh.cell(cell);
            for (i, node) in self.node_vertices.iter().enumerate() {
                supports[self.dofs.of(cell, i)] = node.support(None, vertices);
            }
        }
        supports
    }
}
