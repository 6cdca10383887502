//! The multiplier as a density at vertices.

use super::entity::{ContactEntity, SolvedInequality};
use super::exact_contact::ExactContact;
use crate::arrays::map_entries;
use crate::assemble::space::Space;

impl<const D: usize> Space<'_, D> {
    /// The errors of the density in L1 and lumped L2 against the exact multiplier on entities with these measures,
    /// which [`Space::exact_contact`] has tested with hat functions; none if all vertices lie on the Dirichlet
    /// boundary.
    pub(super) fn multiplier_errors(
        &self,
        (entities, measures): (&[ContactEntity], &[f64]),
        exact: &[ExactContact],
        solved: SolvedInequality<'_>,
    ) -> [Option<f64>; 2] {
        let weights = self.hat_integrals(entities, measures);
        let Some(mut multipliers) = self.vertex_multipliers(solved) else {
            return [None; 2];
        };
        for ((entity, measure), exact) in entities.iter().zip(measures).zip(exact) {
            let cell = self.mesh.cell(entity.cell);
            for (local, tested) in entity.corners::<D>().zip(exact.tested) {
                multipliers[cell[local] as usize] -= measure * tested;
            }
        }
        self.density_norms(&multipliers, &weights)
    }

    /// The norms in L1 and lumped L2 of a density: `tested` are its integrals against the hat functions of vertices,
    /// `weights` the integrals of these functions. None if no vertex off the Dirichlet boundary has a positive weight.
    pub(super) fn density_norms(&self, tested: &[f64], weights: &[f64]) -> [Option<f64>; 2] {
        let given = self.dirichlet_groups();
        let vertices = || (0..weights.len()).filter(|&v| weights[v] > 0.0 && given[v].is_none());
        let squares: f64 = vertices().map(|v| tested[v] * tested[v] / weights[v]).sum();
        let sum: f64 = vertices().map(|v| tested[v].abs()).sum();
        map_entries([sum, squares.sqrt()], |norm| vertices().next().map(|_| norm))
    }

    /// Nodal multipliers at vertices: that of each unknown divided equally among the vertices around its node. None
    /// where rounding leaves no digit.
    pub(super) fn vertex_multipliers(&self, solved: SolvedInequality<'_>) -> Option<Vec<f64>> {
        let mut multipliers = vec![0.0; self.mesh.vertices().len()];
        let of_unknowns = self.nodal_multipliers(solved)?;
        for (unknown, multiplier) in of_unknowns.iter().enumerate().filter(|(_, m)| **m != 0.0) {
            let around = solved.0.locations[unknown].vertices();
            let share = multiplier / around.len() as f64;
            around.iter().for_each(|&v| multipliers[v as usize] += share);
        }
        Some(multipliers)
    }
}
