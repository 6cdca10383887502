//! Exact multiplier and contact set on the entities of a mesh.

use std::ops::Range;

use super::entity::ContactEntity;
use crate::assemble::cut_simplices::{CutRule, in_space};
use crate::assemble::space::{Space, checks};
use crate::error::Error;
use crate::measure::evaluation::Reference;
use crate::measure::kinks::is_far;
use crate::parallel::cells;
use crate::problem::Exact;
use crate::real::Point;

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
    /// Whether the free boundary may meet the entity.
    pub is_near: bool,
}

impl ExactContact {
    /// The exact solution on an entity out of contact.
    pub const FREE: Self = Self { tested: [0.0; 4], shares: [1.0, 0.0], is_near: false };

    fn counts(&self) -> bool {
        self.is_near || self.shares[1] > 0.0 || self.tested != [0.0; 4]
    }
}

impl<const D: usize> Space<'_, D> {
    /// The exact multiplier and contact set on some entities, at the same points: a list for each chunk of entities,
    /// with the positions of those that have a multiplier or a share in contact, or are near the free boundary.
    pub(super) fn exact_contact(
        &self,
        exact: &Exact<D>,
        entities: &[ContactEntity],
    ) -> Result<Vec<Vec<(usize, ExactContact)>>, Error> {
        // all entities are facets, or all are cells
        let Some(first) = entities.first() else { return Ok(Vec::new()) };
        let rule = CutRule::new(first.dimension::<D>(), DEGREE).without_needless_bisections();
        let at_vertices = self.contact_at_vertices(&Reference::Exact(exact));
        let chunks = cells::map(entities.len(), &|range: Range<usize>| {
            let on_entity = |k: usize| {
                let at_corners =
                    at_vertices.as_ref().map(|values| self.at_corners(values, entities[k].cell));
                let found = self.exact_contact_on(exact, entities[k], &rule, at_corners);
                found.map(|found| found.counts().then_some((k, found))).transpose()
            };
            range.filter_map(on_entity).collect::<Result<Vec<_>, _>>()
        });
        chunks.into_iter().collect()
    }

    fn exact_contact_on(
        &self,
        exact: &Exact<D>,
        entity: ContactEntity,
        rule: &CutRule,
        at_corners: Option<[f64; 4]>,
    ) -> Result<ExactContact, Error> {
        let corners = self.corner_points(entity);
        let mut found = ExactContact::default();
        let (mut not_finite, mut is_near) = (None, false);
        let mut add = |hats: &[f64; 4], weight: f64, is_in_contact: &dyn Fn(&Point<D>) -> bool| {
            let x = in_space(hats, &corners);
            let is_in_contact = is_in_contact(&x);
            found.shares[usize::from(is_in_contact)] += weight;
            let Some(multiplier) = &exact.multiplier else { return };
            let density = multiplier(&x);
            if !density.is_finite() {
                not_finite = not_finite.or(Some((density, x)));
            }
            found.tested.iter_mut().zip(hats).for_each(|(sum, hat)| *sum += weight * density * hat);
        };
        let mut add_whole = |is_in_contact: bool| {
            rule.visit_whole(&mut |hats, weight| add(hats, weight, &|_| is_in_contact))
        };
        match &exact.contact {
            None => add_whole(false),
            Some(set) => {
                let level = &set.indicator;
                let own = &corners[..=entity.dimension::<D>()];
                is_near = !is_far(level, own, at_corners);
                let sign = match is_near {
                    true => rule.sign_of_uncut(&corners, level),
                    false => Some(level(&corners[0]) > 0.0),
                };
                match sign {
                    Some(true) => add_whole(true),
                    // by complementarity there is no multiplier
                    Some(false) => found.shares[0] = 1.0,
                    None => {
                        let is_in_contact = |x: &Point<D>| level(x) > 0.0;
                        rule.visit(&corners, level, &mut |hats, weight| {
                            add(hats, weight, &is_in_contact);
                        });
                    }
                }
            }
        }
        if let Some((density, x)) = not_finite {
            checks::finite(density, "exact multiplier", &x, entity.cell)?;
        }
        Ok(ExactContact { is_near, ..found })
    }
}
