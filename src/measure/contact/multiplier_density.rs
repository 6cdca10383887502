//! The multiplier as a density at vertices.

use super::entity::{ContactEntity, Place};
use super::exact_contact::ExactContact;
use crate::algebra::Inequality;
use crate::assemble::space::Space;
use crate::inequality::Solution;
use crate::real::Real;

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The errors of the density in L1 and lumped L2 against the exact multiplier on these entities, which
    /// [`Space::exact_contact`] has tested with hat functions; none if all vertices lie on the Dirichlet part.
    pub(super) fn multiplier_errors(
        &self,
        entities: &[ContactEntity],
        exact: &[Vec<ExactContact>],
        inequality: &Inequality<T>,
        solution: &Solution<T>,
    ) -> Option<[f64; 2]> {
        let weights = self.hat_integrals(entities);
        let mut multipliers = self.vertex_multipliers(inequality, solution, &|_| true)?;
        for (entity, exact) in entities.iter().zip(exact.iter().flatten()) {
            let (measure, cell) = (self.measure_of(*entity), self.mesh.cell(entity.cell));
            for (k, local) in entity.corners::<D>().enumerate() {
                multipliers[cell[local] as usize] -= measure * exact.tested[k];
            }
        }
        let given = self.dirichlet_groups();
        let counted = |v: &usize| weights[*v] > 0.0 && given[*v].is_none();
        let vertices = || (0..weights.len()).filter(counted);
        let squares: f64 = vertices().map(|v| multipliers[v] * multipliers[v] / weights[v]).sum();
        let sum: f64 = vertices().map(|v| multipliers[v].abs()).sum();
        vertices().next().map(|_| [sum, squares.sqrt()])
    }

    /// Nodal multipliers at vertices: those of the unknowns that count, each divided equally among the vertices around
    /// its node. None where rounding leaves no digit.
    pub(crate) fn vertex_multipliers(
        &self,
        inequality: &Inequality<T>,
        solution: &Solution<T>,
        counts: &dyn Fn(usize) -> bool,
    ) -> Option<Vec<f64>> {
        let mut multipliers = vec![0.0; self.mesh.vertices().len()];
        let of_unknowns = self.nodal_multipliers(inequality, solution)?;
        let counted = of_unknowns.iter().enumerate();
        for (unknown, multiplier) in counted.filter(|(i, value)| **value != 0.0 && counts(*i)) {
            let around = inequality.supports[unknown].vertices();
            let share = multiplier / around.len() as f64;
            around.iter().for_each(|&v| multipliers[v as usize] += share);
        }
        Some(multipliers)
    }

    /// The density of the multiplier on cells or on facets: the mean over their vertices of the nodal
    /// multipliers of the unknowns that count over the integrals of the hat functions on these places. Empty where rounding
    /// leaves no digit.
    pub(crate) fn mean_densities(
        &self,
        places: &[Place],
        inequality: &Inequality<T>,
        solution: &Solution<T>,
        counts: &dyn Fn(usize) -> bool,
    ) -> Vec<f64> {
        // other parts of a mesh may have places
        if places.is_empty() && inequality.distribution().is_none() {
            return Vec::new();
        }
        let entities: Vec<ContactEntity> =
            places.iter().map(|&(cell, facet)| ContactEntity { cell, facet }).collect();
        let vertex = |entity: ContactEntity, k: usize| self.mesh.cell(entity.cell)[k] as usize;
        let Some(mut densities) = self.vertex_multipliers(inequality, solution, counts) else {
            return Vec::new();
        };
        let hats = self.hat_integrals(&entities);
        densities.iter_mut().zip(hats).for_each(|(density, hat)| *density /= hat);
        let mean = |entity: ContactEntity| {
            let sum: f64 = entity.corners::<D>().map(|k| densities[vertex(entity, k)]).sum();
            sum / (entity.dimension::<D>() + 1) as f64
        };
        entities.into_iter().map(mean).collect()
    }
}
