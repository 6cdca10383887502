//! The forces on contact facets.

use super::NoBound;
use crate::algebra::{Bound, Contact, Inequality};
use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;
use crate::mesh::{BoundaryCondition, HalfFacet};
use crate::parallel::vectors::collect;
use crate::quadrature::facet_to_cell;

/// A value that Dirichlet data pin is zero up to this share of the largest one.
const VALUE_ROUNDING: f64 = 1e-12;

/// The share of the contact force of a node that acts on one of its contact facets.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeForce {
    /// The cell of the facet.
    pub cell: usize,
    /// The number of the facet in the cell, which is that of the opposite vertex.
    pub local: usize,
    /// The unknown, by its number in the cell.
    pub node: usize,
    /// The force: of contact not negative, of friction of any sign.
    pub value: f64,
}

impl<const D: usize> Space<'_, D> {
    /// The contact forces: that of each node in contact with a gap, divided by measure among those of its contact
    /// facets whose gap binds it and, in the plane, if there are any, all of whose nodes are in contact: the other
    /// facet of a node is open there. In space facets around the end of contact are many, and few of them are in
    /// contact whole. A node of a quadratic that Dirichlet data pin beside nodes in contact has no force of its own:
    /// the flux of the discrete function `u` stands for it, and any number would do.
    pub(super) fn contact_forces(
        &self,
        bounds: &[Bound<f64>],
        contact: &[Contact],
        (residual, obstacles): (&[f64], &ActiveObstacles),
        u: &[f64],
    ) -> Vec<NodeForce> {
        let terms = self.node_terms(&self.facet_rule);
        let mut forces: Vec<NodeForce> = Vec::new();
        // of each unknown the best rank of its facets, and the measure of those
        let mut best = vec![(0, 0.0); if self.problem.has_gap() { residual.len() } else { 0 }];
        let mut ranks = Vec::new();
        // where an obstacle gives the bound the force is that of the obstacle
        let is_in_contact = |unknown: usize| {
            contact.get(unknown) != Some(&Contact::Inactive) && !obstacles.act_at(unknown)
        };
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            if self.data.gap.of(group).is_none() {
                continue;
            }
            let measure = self.facet_measure((cell, local));
            let unknown_of = |node: usize| self.dofs.of(cell, node);
            let is_bound = |unknown: usize| bounds[unknown].is_inequality();
            let (mut n_bound, mut n_touching) = (0, 0);
            for (node, _) in self.bounded_nodes_on(local).filter(|(n, _)| is_bound(unknown_of(*n)))
            {
                n_bound += 1;
                n_touching += usize::from(is_in_contact(unknown_of(node)));
            }
            let (is_closed, is_open) = (n_touching == n_bound, n_bound > 0 && n_touching == 0);
            for (node, by) in self.bounded_nodes_on(local) {
                let unknown = unknown_of(node);
                if is_bound(unknown) {
                    if is_in_contact(unknown) {
                        let bound = bounds[unknown];
                        let is_binding =
                            self.gap_gives(((cell, local), group), (node, by), &terms, bound);
                        let is_end = D < 3 && !is_closed;
                        let rank = 1 + 2 * usize::from(is_binding) + usize::from(!is_end);
                        match &mut best[unknown] {
                            (of_best, all) if *of_best == rank => *all += measure,
                            lower if lower.0 < rank => *lower = (rank, measure),
                            _ => {}
                        }
                        forces.push(NodeForce { cell, local, node, value: measure });
                        ranks.push(rank);
                    }
                } else if self.pins && self.degree == 2 && !is_open {
                    let value = self.flux_at_node((cell, local), node, u).max(0.0);
                    forces.push(NodeForce { cell, local, node, value });
                    ranks.push(0);
                }
            }
        }
        for (force, rank) in forces.iter_mut().zip(ranks).filter(|(_, rank)| *rank > 0) {
            let unknown = self.dofs.of(force.cell, force.node);
            let (of_best, all) = best[unknown];
            let share = if rank == of_best { force.value / all } else { 0.0 };
            force.value = share * (-residual[unknown]).max(0.0);
        }
        forces
    }

    /// The forces of friction: that of each kink, divided by the weights of its unknown among the facets. A node that
    /// Dirichlet data pin has no force of its own: the threshold against its value stands for it, or without a value the
    /// flux of the discrete function `u`, as far as the threshold reaches.
    pub(super) fn friction_forces(
        &self,
        inequality: &Inequality<f64>,
        by_kink: &[f64],
        u: &[f64],
    ) -> Result<Vec<NodeForce>, NoBound> {
        if !self.data.friction.is_given() {
            return Ok(Vec::new());
        }
        let mut forces = Vec::new();
        let one = self.constants();
        let largest = u.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let zero = VALUE_ROUNDING * largest + self.body_constants.rounding();
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Neumann) {
            for (node, weight) in self.friction_weights((cell, local), group)? {
                let unknown = self.dofs.of(cell, node);
                let own = u[unknown] + self.body_constants.of_cell(cell) * one[node];
                let value = match inequality.kink_of(unknown) {
                    Some(k) => by_kink[k] * (weight / inequality.kinks[k].slope),
                    None if own.abs() > zero => -weight * own.signum(),
                    None => self.flux_at_node((cell, local), node, u).clamp(-weight, weight),
                };
                forces.push(NodeForce { cell, local, node, value });
            }
        }
        Ok(forces)
    }

    /// The multipliers of obstacles by unknown: minus the residual, less contact forces.
    pub(super) fn multipliers_of_obstacles(
        &self,
        residual: &[f64],
        forces: &[NodeForce],
    ) -> Vec<f64> {
        let mut multipliers = collect(residual.len(), |i| -residual[i]);
        for force in forces {
            multipliers[self.dofs.of(force.cell, force.node)] -= force.value;
        }
        multipliers
    }

    /// The integral over a facet of `alpha grad u . n` times a basis function.
    fn flux_at_node(&self, (cell, local): HalfFacet, node: usize, u: &[f64]) -> f64 {
        let geometry = self.mesh.geometry(cell);
        let values = self.local_values(cell, u);
        let normal = self.tensor_times(cell, &geometry.normal(local));
        let scale = self.facet_measure((cell, local)) * self.alpha(cell);
        let mut sum = 0.0;
        for (point, weight) in self.facet_rule.iter() {
            let basis = self.basis_at(&facet_to_cell(point, local));
            for k in 0..=D {
                let slope: f64 = values.iter().zip(&basis.derivatives).map(|(u, d)| u * d[k]).sum();
                let along = geometry.gradient(k).dot(&normal);
                sum += weight * scale * slope * along * basis.values[node];
            }
        }
        sum
    }
}
