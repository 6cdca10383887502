//! Multipliers of quadratics, divided among the cells of each node.
//!
//! Only the sum over the cells of a node is determined: by the equation of the unknown that they share, or, for
//! over-penalties, by the sum of the equations of the copies of the node, in which jumps do not appear.

use crate::algebra::{Bound, Contact};
use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;

impl<const D: usize> Space<'_, D> {
    /// The numbers of the nodes of quadratics, by cell and unknown of the cell: of broken functions those of vertices
    /// and, after them, of edges; none if the unknowns are other ones than values at vertices and midpoints, or
    /// Bernstein coefficients.
    pub(super) fn node_numbers(&self, edges: &[u32]) -> Option<Vec<u32>> {
        let (n, n_cells) = (self.per_cell(), self.mesh.n_cells());
        if !self.has_nodes_of_quadratics() {
            return None;
        }
        let n_vertices = self.mesh.vertices().len() as u32;
        let n_edges = n - (D + 1);
        let number = |(cell, i): (usize, usize)| match i.checked_sub(D + 1) {
            _ if !self.broken => self.dofs.of(cell, i) as u32,
            None => self.mesh.cell(cell)[i],
            Some(edge) => n_vertices + edges[cell * n_edges + edge],
        };
        Some((0..n_cells * n).map(|k| number((k / n, k % n))).collect())
    }

    /// Adds multipliers, by unknown, to what cells have: of a node each cell whose obstacle acts there has the share of
    /// its volume, among those in contact if there are any.
    pub(super) fn add_multipliers(
        &self,
        multipliers: &[f64],
        (bounds, contact, obstacles): (&[Bound<f64>], &[Contact], &ActiveObstacles),
        numbers: &[u32],
        values: &mut [f64],
    ) {
        let n = self.per_cell();
        let volume = |cell: usize| self.mesh.geometry(cell).volume;
        let held: Vec<bool> = self.cells_in_contact(bounds, contact);
        let n_nodes = numbers.iter().max().map_or(0, |&most| most as usize + 1);
        // of broken functions, copies that no obstacle binds have no share
        let acts = |cell: usize, i: usize| {
            let is_bound = || bounds[self.dofs.of(cell, i)].is_inequality();
            obstacles.act_in(cell, i) && (!self.broken || is_bound())
        };
        // the volumes of cells: of all, of those whose obstacle acts, of those in contact among them
        let mut around = vec![[0.0; 3]; n_nodes];
        let rank = |cell: usize, i: usize| match acts(cell, i) {
            true => 1 + usize::from(held[cell]),
            false => 0,
        };
        let mut sums = vec![0.0; n_nodes];
        for (cell, nodes) in numbers.chunks_exact(n).enumerate() {
            let volume = volume(cell);
            for (i, &node) in nodes.iter().enumerate() {
                let (node, unknown) = (node as usize, self.dofs.of(cell, i));
                around[node][rank(cell, i)] += volume;
                // a shared unknown has one multiplier
                let before = if self.broken { sums[node] } else { 0.0 };
                sums[node] = before + multipliers[unknown];
            }
        }
        let of_cells = numbers.chunks_exact(n).zip(values.chunks_exact_mut(n));
        for (cell, (nodes, values)) in of_cells.enumerate() {
            let volume = volume(cell);
            for (i, (&node, value)) in nodes.iter().zip(values).enumerate() {
                let of_ranks = around[node as usize];
                let best = (0..3).rev().find(|&rank| of_ranks[rank] > 0.0).unwrap_or(0);
                if rank(cell, i) == best {
                    *value += volume / of_ranks[best] * sums[node as usize];
                }
            }
        }
    }

    /// For each cell whether no bounded unknown with a basis function of positive mean is free.
    fn cells_in_contact(&self, bounds: &[Bound<f64>], contact: &[Contact]) -> Vec<bool> {
        let decides = self.unknowns_with_positive_mean();
        let is_free = |unknown: usize| {
            bounds[unknown].is_inequality() && contact.get(unknown) == Some(&Contact::Inactive)
        };
        let is_held = |cell| !decides.iter().any(|&i| is_free(self.dofs.of(cell, i)));
        (0..self.mesh.n_cells()).map(is_held).collect()
    }
}
