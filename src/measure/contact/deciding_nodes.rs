//! Which nodes of a cell or facet decide whether it is in contact.

use crate::assemble::space::Space;
use crate::quadrature::{Rule, facet_to_cell};

/// A mean of a basis function counts as positive above this.
const POSITIVE: f64 = 1e-9;

impl<const D: usize> Space<'_, D> {
    /// A list for each facet, by its number, and at `D + 1` one for the cell: of the nodes that the constraint set binds
    /// those whose basis functions have a positive mean over the facet or the cell, or all if there is none.
    ///
    /// A quadratic basis function of a vertex has a mean of zero over a triangle and a negative one over a
    /// tetrahedron: within the contact set the nodal multiplier of the vertex is zero or has the wrong
    /// sign, so that the vertex is inactive there.
    pub(super) fn deciding_nodes(&self) -> Vec<Vec<usize>> {
        let positive = |points: Vec<([f64; 4], f64)>, bounded: Vec<usize>| {
            let mean = |i: usize| -> f64 {
                points.iter().map(|(point, weight)| weight * self.basis_at(point).values[i]).sum()
            };
            let chosen: Vec<usize> =
                bounded.iter().copied().filter(|&i| mean(i) > POSITIVE).collect();
            if chosen.is_empty() { bounded } else { chosen }
        };
        let in_cell = Rule::new(D, self.basis_degree);
        let in_cell = in_cell.iter().map(|(point, weight)| (*point, weight)).collect();
        let on_facet = |local: usize| {
            let rule = Rule::new(D - 1, self.basis_degree);
            let points = rule.iter().map(|(point, weight)| (facet_to_cell(point, local), weight));
            positive(points.collect(), self.bounded_nodes_on(local).map(|(i, _)| i).collect())
        };
        let in_cell = positive(in_cell, self.bounded_nodes().map(|(i, _)| i).collect());
        (0..D + 1).map(on_facet).chain([in_cell]).collect()
    }
}
