//! The forces on contact facets.

use crate::algebra::{Contact, Inequality};
use crate::assemble::space::{Place, Space};
use crate::mesh::BoundaryPart;
use crate::quadrature::facet_to_cell;
use crate::real::{Real, point_f64};

/// The part of the contact force of a node that acts on one of its contact facets.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeForce {
    /// The cell of the facet.
    pub cell: usize,
    /// The number of the facet in the cell, which is that of the opposite vertex.
    pub local: usize,
    /// The unknown, by its number in the cell.
    pub node: usize,
    /// The force, not negative.
    pub value: f64,
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The contact forces: that of each node in contact, divided among its contact facets by their measures.
    /// A node of a quadratic that Dirichlet data pin at the end of a contact part has no force of its own: the
    /// part of the flux of the discrete function `u` stands for it, and any number would do.
    pub(super) fn contact_forces(
        &self,
        inequality: &Inequality<T>,
        contact: &[Contact],
        residual: &[f64],
        u: &[T],
    ) -> Vec<NodeForce> {
        let mut forces: Vec<NodeForce> = Vec::new();
        let mut shared = vec![0.0; if self.problem.has_gap() { residual.len() } else { 0 }];
        for ((cell, local), group) in self.grouped_facets_of(BoundaryPart::Contact) {
            if self.data.gap.of(group).is_none() {
                continue;
            }
            let measure = self.mesh.geometry(cell).facet_measure(local).to_f64();
            for (node, _) in self.bounded_nodes_on(local) {
                let unknown = self.dofs.of(cell, node);
                if inequality.bounds[unknown].is_inequality() {
                    if contact.get(unknown) != Some(&Contact::Inactive) {
                        shared[unknown] += measure;
                        forces.push(NodeForce { cell, local, node, value: measure });
                    }
                } else if self.pins && self.degree == 2 {
                    let value = self.flux_at_node((cell, local), node, u).max(0.0);
                    forces.push(NodeForce { cell, local, node, value });
                }
            }
        }
        for force in &mut forces {
            let unknown = self.dofs.of(force.cell, force.node);
            if inequality.bounds[unknown].is_inequality() {
                force.value *= (-residual[unknown]).max(0.0) / shared[unknown];
            }
        }
        forces
    }

    /// The integral over a facet of `alpha grad u . n` times a basis function.
    fn flux_at_node(&self, (cell, local): Place, node: usize, u: &[T]) -> f64 {
        let geometry = self.mesh.geometry(cell);
        let (values, normal) = (self.local_values(cell, u), point_f64(&geometry.normal(local)));
        let scale = geometry.facet_measure(local).to_f64() * self.alpha(cell).to_f64();
        let mut sum = 0.0;
        for (point, weight) in self.facet_rule.iter() {
            let basis = self.basis_at(&facet_to_cell(point, local));
            for k in 0..=D {
                let slope: f64 = values.iter().zip(&basis.derivatives).map(|(u, d)| u * d[k]).sum();
                let along = point_f64(geometry.gradient(k)).dot(&normal);
                sum += weight * scale * slope * along * basis.values[node];
            }
        }
        sum
    }
}
