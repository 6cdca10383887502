//! The supports of basis functions: for each node, the vertices of a cell whose barycentre is the node.

use super::Space;
use crate::algebra::Support;
use crate::element::Entity;
use crate::memory::in_large_pages;
use crate::real::Real;

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The support of each unknown.
    pub fn supports(&self) -> Vec<Support> {
        let n = self.dofs.size();
        if self.broken {
            let mut supports = in_large_pages(Vec::with_capacity(n));
            for cell in 0..self.mesh.n_cells() {
                let (owner, vertices) = (Some(cell as u32), self.mesh.cell(cell));
                supports
                    .extend(self.node_vertices.iter().map(|node| node.support(owner, vertices)));
            }
            return supports;
        }
        if self.nodes.iter().all(|node| matches!(node.entity(), Entity::Vertex(_))) {
            // unknowns are numbered like the vertices that own them
            let mut supports = in_large_pages(Vec::with_capacity(n));
            supports.extend((0..n as u32).map(|vertex| Support::new(None, &[vertex])));
            return supports;
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
