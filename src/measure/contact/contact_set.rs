//! The discrete contact set and the density of the multiplier, for pictures.

use super::entity::{ContactEntity, SolvedInequality};
use crate::assemble::space::Space;
use crate::mesh::HalfFacet;

/// The discrete contact set and multiplier, in terms that do not depend on the unknowns of a
/// scheme.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct DiscreteContact {
    /// Cells in contact with an obstacle as a whole.
    pub cells: Vec<usize>,
    /// Facets of the contact boundary in contact as a whole: cell, and number in the cell.
    pub facets: Vec<HalfFacet>,
    /// Density of the multiplier at every vertex: the nodal multiplier over the integral of the hat
    /// function of the vertex, over the domain or the contact boundary. None where there is no such
    /// integral, on the Dirichlet boundary and where rounding leaves no digit; empty without a constraint.
    pub density: Vec<Option<f64>>,
}

impl<const D: usize> Space<'_, D> {
    /// The contact set and density of a solution, with the definitions of
    /// `Discretisation::contact_errors`.
    pub(crate) fn discrete_contact(&self, solved: SolvedInequality<'_>) -> DiscreteContact {
        let mut contact = DiscreteContact::default();
        if !self.problem.is_constrained() {
            return contact;
        }
        let entities = self.entities();
        let touching = self.in_contact(&entities, solved);
        for (entity, _) in entities.iter().zip(touching).filter(|(_, touches)| *touches) {
            match entity.facet {
                None => contact.cells.push(entity.cell),
                Some(local) => contact.facets.push((entity.cell, local)),
            }
        }
        // with both an obstacle and a contact boundary there are two multipliers of different kind
        if self.problem.has_obstacle() && self.problem.acts_on_boundary() {
            return contact;
        }
        let weights = self.hat_integrals(&entities, &self.measures_of(&entities));
        let multipliers = self.vertex_multipliers(solved);
        let given = self.dirichlet_groups();
        let density = |v: usize| {
            let multiplier = multipliers.as_ref().map(|multipliers| multipliers[v]);
            multiplier.filter(|_| weights[v] > 0.0 && given[v].is_none()).map(|m| m / weights[v])
        };
        contact.density = (0..weights.len()).map(density).collect();
        contact
    }

    /// The integral of each hat function over entities with these measures.
    pub(super) fn hat_integrals(&self, entities: &[ContactEntity], measures: &[f64]) -> Vec<f64> {
        let mut integrals = vec![0.0; self.mesh.vertices().len()];
        for (entity, measure) in entities.iter().zip(measures) {
            let share = measure / (entity.dimension::<D>() + 1) as f64;
            for local in entity.corners::<D>() {
                integrals[self.mesh.cell(entity.cell)[local] as usize] += share;
            }
        }
        integrals
    }
}
