//! Friction: the kinks of unknowns on the boundary, and its energy.

use std::collections::BTreeMap;

use super::{Space, checks};
use crate::algebra::{Bound, Inequality};
use crate::constraint::offered;
use crate::error::Error;
use crate::mesh::{BoundaryCondition, HalfFacet};
use crate::quadrature::facet_to_cell;

/// A weight below this share of the integral of the threshold is rounding.
const ROUNDING: f64 = 1e-12;

impl<const D: usize> Space<'_, D> {
    /// Adds the kinks of friction: for each unknown of the constraint set on the boundary with friction the integral of
    /// the threshold times its basis function is the slope of `|u|`.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`]; [`Error::CoefficientNotPositive`] for a threshold that is negative at a point of a rule;
    /// [`Error::NothingToBound`] where a weight is negative, or that of a function that the constraint set does not bind is
    /// not zero.
    pub fn add_friction(&self, inequality: &mut Inequality<f64>) -> Result<(), Error> {
        if !self.data.friction.is_given() {
            return Ok(());
        }
        let mut slopes: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
        let one = self.constants();
        for (facet, group) in self.facets_of_forces() {
            for (i, weight) in self.friction_weights(facet, group)? {
                let place = -self.body_constants.of_cell(facet.0) * one[i];
                slopes.entry(self.dofs.of(facet.0, i)).or_insert((0.0, place)).0 += weight;
            }
        }
        for (unknown, (slope, place)) in slopes {
            // a fixed unknown has no function of its value
            if slope > 0.0 && !matches!(inequality.bounds[unknown], Bound::Fixed(_)) {
                inequality.add_kink(unknown as u32, slope, place);
            }
        }
        Ok(())
    }

    /// The facets that can be in contact, with the numbers of their groups: of the contact boundary, and then with friction,
    /// where contact is stick.
    pub fn facets_of_forces(&self) -> impl Iterator<Item = (HalfFacet, usize)> {
        let of_friction = self.grouped_facets_of(BoundaryCondition::Neumann);
        let of_friction = of_friction.filter(|(_, group)| self.data.friction.of(*group).is_some());
        self.grouped_facets_of(BoundaryCondition::Contact).chain(of_friction)
    }

    /// The integrals of the threshold times the basis functions that the constraint set binds on a facet; none without
    /// friction there.
    pub fn friction_weights(
        &self,
        facet: HalfFacet,
        group: usize,
    ) -> Result<Vec<(usize, f64)>, Error> {
        if self.data.friction.of(group).is_none() {
            return Ok(Vec::new());
        }
        let nodes: Vec<usize> = self.nodes_on(facet.1).collect();
        // of each node the integrals of its basis function, and of the threshold times it
        let mut weights = vec![[0.0; 2]; nodes.len()];
        let (measure, mut size) = (self.facet_measure(facet), 0.0);
        let mut rule = self.facet_rule.weights.iter();
        self.visit_friction(facet, group, &mut |point, weight| {
            let of_point = measure * rule.next().expect("the rule has a weight a point");
            let basis = self.basis_at(point);
            for (&i, [plain, weighted]) in nodes.iter().zip(&mut weights) {
                *plain += of_point * basis.values[i];
                *weighted += weight * basis.values[i];
            }
            size += weight;
        })?;
        let bound: Vec<usize> = self.bounded_nodes_on(facet.1).map(|(i, _)| i).collect();
        let mut found = Vec::new();
        for (i, [plain, weight]) in nodes.into_iter().zip(weights) {
            let is_rounding = weight.abs() <= ROUNDING * size;
            // the weight of a node may vanish where the threshold does
            let has_weight = plain > ROUNDING * measure && (weight > 0.0 || is_rounding);
            if bound.contains(&i) && has_weight {
                found.push((i, weight.max(0.0)));
            } else if !is_rounding || bound.contains(&i) {
                let set = self.problem.constraint_set().name_on(&self.nodes);
                let mut others = offered(&self.element, true);
                others.retain(|name| name != set);
                return Err(Error::NothingToBound(format!(
                    "friction needs a weight at each of its {set} that is not negative, the integral of the threshold times the basis function, and of the latter a positive one: choose another set, {}",
                    others.join(" or ")
                )));
            }
        }
        Ok(found)
    }

    /// Visits the points of the rule on a facet with friction: in the cell, with weight, measure and threshold multiplied.
    pub fn visit_friction(
        &self,
        (cell, local): HalfFacet,
        group: usize,
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) -> Result<(), Error> {
        let Some(threshold) = self.data.friction.of(group) else { return Ok(()) };
        let measure = self.facet_measure((cell, local));
        for (point, weight) in self.facet_rule.iter() {
            let x = self.facet_point(point, cell, local);
            let datum = "threshold of friction";
            let value = checks::not_negative(self.at(threshold, cell, &x), datum, &x, cell)?;
            visit(&facet_to_cell(point, local), weight * measure * value);
        }
        Ok(())
    }

    /// `int g |u|` over the boundary with friction, of the cells that count.
    pub fn friction_energy(&self, u: &[f64], counts: &dyn Fn(usize) -> bool) -> Result<f64, Error> {
        let mut energy = 0.0;
        if self.data.friction.is_given() {
            for (facet, group) in self.grouped_facets_of(BoundaryCondition::Neumann) {
                if counts(facet.0) {
                    let local = self.local_values(facet.0, u);
                    let constant = self.body_constants.of_cell(facet.0);
                    self.visit_friction(facet, group, &mut |point, weight| {
                        energy += weight * (self.basis_at(point).value(&local) + constant).abs();
                    })?;
                }
            }
        }
        Ok(energy)
    }
}
