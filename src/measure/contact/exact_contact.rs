//! Exact multiplier and contact set on the entities of a mesh.

use std::ops::Range;
use std::slice::from_ref;

use super::entity::ContactEntity;
use crate::assemble::cut_simplices::{CutRule, in_space};
use crate::assemble::space::{Space, checks};
use crate::error::Error;
use crate::parallel::cells;
use crate::problem::Exact;

/// Degree of the rule on a simplex, or on the pieces into which the free boundary cuts it.
const DEGREE: usize = 5;

/// The exact solution of an inequality on an entity.
#[derive(Clone, Copy, Default)]
pub(super) struct ExactContact {
    /// For each corner of the entity the mean over the entity of the multiplier times the hat function of the corner;
    /// zero without a multiplier, and out of contact.
    pub tested: [f64; 4],
    /// The share of the entity out of contact, and the share in contact. Without a contact set the first is one.
    pub shares: [f64; 2],
}

impl<const D: usize> Space<'_, D> {
    /// The exact multiplier and contact set on each of these entities, at the same points.
    pub(super) fn exact_contact(
        &self,
        exact: &Exact<D>,
        entities: &[ContactEntity],
    ) -> Result<Vec<ExactContact>, Error> {
        // all entities are facets, or all are cells
        let Some(first) = entities.first() else { return Ok(Vec::new()) };
        let rule = CutRule::new(first.dimension::<D>(), DEGREE);
        let chunks = cells::map(entities.len(), &|range: Range<usize>| {
            let on_entity = |&entity: &ContactEntity| self.exact_contact_on(exact, entity, &rule);
            entities[range].iter().map(on_entity).collect::<Result<Vec<_>, _>>()
        });
        Ok(chunks.into_iter().collect::<Result<Vec<_>, _>>()?.concat())
    }

    fn exact_contact_on(
        &self,
        exact: &Exact<D>,
        entity: ContactEntity,
        rule: &CutRule,
    ) -> Result<ExactContact, Error> {
        let corners = self.corner_points(entity);
        let level = exact.contact.as_ref().map(|set| &set.indicator);
        let mut found = ExactContact::default();
        let mut outcome = Ok(());
        rule.visit(&corners, level.map_or(&[], from_ref), &mut |hats, weight| {
            let x = in_space(hats, &corners);
            let is_in_contact = level.is_some_and(|level| level(&x) > 0.0);
            found.shares[usize::from(is_in_contact)] += weight;
            // by complementarity there is no multiplier out of contact
            let acts = is_in_contact || level.is_none();
            let Some(multiplier) = exact.multiplier.as_ref().filter(|_| acts) else { return };
            let density = multiplier(&x);
            if outcome.is_ok() {
                outcome = checks::finite(density, "exact multiplier", &x, entity.cell).map(|_| ());
            }
            found.tested.iter_mut().zip(hats).for_each(|(sum, hat)| *sum += weight * density * hat);
        });
        outcome.map(|()| found)
    }
}
