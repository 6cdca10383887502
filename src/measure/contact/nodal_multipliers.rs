//! The multipliers of unknowns that are shown: contact forces where they are known.

use super::entity::SolvedInequality;
use crate::algebra::DofLocation;
use crate::assemble::space::Space;
use crate::inequality::ContactForces;
use crate::mesh::BoundaryCondition;
use crate::parallel::vectors::collect;

impl<const D: usize> Space<'_, D> {
    /// By unknown the force of its active bound, positive where a lower bound pushes upward, or of friction. It is zero
    /// without contact, and at nodes on facets with weakly imposed Dirichlet data: there the entry of `A u - b` contains the
    /// flux through the boundary. None where rounding leaves no digit. On a part of a mesh ghosts have the forces of
    /// their owners, and all parts call it.
    pub(super) fn nodal_multipliers(&self, solved: SolvedInequality<'_>) -> Option<Vec<f64>> {
        let (inequality, solution) = solved;
        let forces = ContactForces::of(inequality, solution);
        let on_data = self.on_weak_data(&inequality.locations);
        let counts = |i: usize| !on_data.get(i).is_some_and(|&is_left_out| is_left_out);
        let have_digits = forces.have_digits(inequality, solution, counts);
        let value = |i: usize| if counts(i) { forces.values[i] } else { 0.0 };
        let mut values = have_digits.then(|| collect(forces.values.len(), value))?;
        // friction acts at slip too
        for (k, kink) in inequality.kinks.iter().enumerate() {
            if counts(kink.unknown as usize) {
                values[kink.unknown as usize] -= inequality.slope_at(k);
            }
        }
        Some(values)
    }

    /// By unknown whether its node is on a facet with weakly imposed Dirichlet data; empty without such data.
    fn on_weak_data(&self, locations: &[DofLocation]) -> Vec<bool> {
        if self.pins || !self.mesh.has_condition(BoundaryCondition::Dirichlet) {
            return Vec::new();
        }
        let mut vertices = vec![false; self.mesh.vertices().len()];
        let mut others: Vec<&[u32]> = Vec::new();
        for (cell, local) in self.facets_of(BoundaryCondition::Dirichlet) {
            for i in self.nodes_on(local) {
                match locations[self.dofs.of(cell, i)].vertices() {
                    &[v] => vertices[v as usize] = true,
                    several => others.push(several),
                }
            }
        }
        others.sort_unstable();
        collect(locations.len(), |i| match locations[i].vertices() {
            &[v] => vertices[v as usize],
            several => others.binary_search(&several).is_ok(),
        })
    }
}
