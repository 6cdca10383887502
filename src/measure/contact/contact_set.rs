//! The discrete contact set, for pictures.

use super::entity::{ContactEntity, SolvedInequality};
use crate::assemble::space::Space;
use crate::mesh::HalfFacet;

/// The discrete contact set, in terms that do not depend on the unknowns of a scheme.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct DiscreteContact {
    /// Cells in contact with an obstacle as a whole.
    pub cells: Vec<usize>,
    /// Facets of the contact boundary in contact as a whole: cell, and number in the cell.
    pub facets: Vec<HalfFacet>,
}

impl<const D: usize> Space<'_, D> {
    /// The contact set of a solution, with the definitions of `Discretisation::contact_errors`.
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
