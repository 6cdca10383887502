//! What pictures show of contact: the set found, and the multiplier as a density.

use crate::algebra::Inequality;
use crate::assemble::space::Space;
use crate::inequality::Solution;
use crate::measure::FoundContact;
use crate::real::Real;

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The contact set and density of a solution, as `Discretisation::contact_errors` sees them.
    pub(crate) fn found_contact(
        &self,
        inequality: &Inequality<T>,
        solution: &Solution<T>,
    ) -> FoundContact {
        let mut found = FoundContact::default();
        if !self.problem.is_constrained() {
            return found;
        }
        let carriers = self.carriers();
        let touching = self.in_contact(&carriers, inequality, solution);
        for (carrier, _) in carriers.iter().zip(touching).filter(|(_, touches)| *touches) {
            match carrier.facet {
                None => found.cells.push(carrier.cell),
                Some(local) => found.facets.push((carrier.cell, local)),
            }
        }
        // with both an obstacle and a contact boundary there are two multipliers of different kind
        if self.problem.has_obstacle() && self.problem.gap.is_some() {
            return found;
        }
        let mut weights = vec![0.0; self.mesh.vertices().len()];
        for carrier in carriers {
            let share = self.measure_of(carrier) / (carrier.dimension::<D>() + 1) as f64;
            for local in carrier.corners::<D>() {
                weights[self.mesh.cell(carrier.cell)[local] as usize] += share;
            }
        }
        let forces = self.vertex_forces(inequality, solution);
        let given = self.on_dirichlet_part();
        let density = |v: usize| (weights[v] > 0.0 && !given[v]).then(|| forces[v] / weights[v]);
        found.density = (0..weights.len()).map(density).collect();
        found
    }
}
