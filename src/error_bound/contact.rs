//! The forces on contact facets.

use crate::algebra::{Contact, Inequality};
use crate::assemble::space::Space;
use crate::mesh::BoundaryPart;
use crate::real::Real;

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
    pub(super) fn contact_forces(
        &self,
        inequality: &Inequality<T>,
        contact: &[Contact],
        residual: &[f64],
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
                let is_in_contact = contact.get(unknown) != Some(&Contact::Inactive);
                if inequality.bounds[unknown].is_inequality() && is_in_contact {
                    shared[unknown] += measure;
                    forces.push(NodeForce { cell, local, node, value: measure });
                }
            }
        }
        for force in &mut forces {
            let unknown = self.dofs.of(force.cell, force.node);
            force.value *= (-residual[unknown]).max(0.0) / shared[unknown];
        }
        forces
    }
}
