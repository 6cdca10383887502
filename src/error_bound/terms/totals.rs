//! Sums and least values of the terms of cells.

use super::CellTerms;
use crate::algebra::Distribution;
use crate::error_bound::NoBound;

/// Sums over cells, and least values.
#[derive(Clone, Copy, Debug)]
pub(in crate::error_bound) struct Totals {
    /// The square of the mismatch.
    pub mismatch: f64,
    /// The square of the distance of the two functions.
    pub distance: f64,
    /// Twice the complementarity of contact.
    pub contact: f64,
    /// The least value of the coefficient.
    pub least_coefficient: f64,
    /// The least value of the reaction at points, vertices and midpoints of edges.
    pub least_reaction: f64,
    /// A bound from below for a reaction of degree two.
    pub reaction_from_below: f64,
}

impl Totals {
    /// Those of some cells.
    pub fn of(terms: &[Vec<CellTerms>]) -> Self {
        let mut totals = Self {
            mismatch: 0.0,
            distance: 0.0,
            contact: 0.0,
            least_coefficient: f64::INFINITY,
            least_reaction: f64::INFINITY,
            reaction_from_below: f64::INFINITY,
        };
        for t in terms.iter().flatten() {
            totals.mismatch += t.mismatch;
            totals.distance += t.distance;
            totals.contact += t.contact;
            totals.least_coefficient = t.least_coefficient.min(totals.least_coefficient);
            totals.least_reaction = t.least_reaction.min(totals.least_reaction);
            totals.reaction_from_below = t.reaction_from_below.min(totals.reaction_from_below);
        }
        totals
    }

    /// Those of all parts of a mesh; all parts call it.
    pub fn add_over_parts(&mut self, distribution: &dyn Distribution) {
        let mut sums = [self.mismatch, self.distance, self.contact];
        distribution.sum(&mut sums);
        let mut largest =
            [-self.least_coefficient, -self.least_reaction, -self.reaction_from_below];
        distribution.largest(&mut largest);
        [self.mismatch, self.distance, self.contact] = sums;
        [self.least_coefficient, self.least_reaction, self.reaction_from_below] =
            largest.map(|x| -x);
    }

    /// A number `C` with `|e| <= C |||e|||` for all `e` that vanish on the Dirichlet part, by the constant of Friedrichs'
    /// inequality or, where the reaction is positive, by the reaction; infinite if neither is known.
    pub fn constant(&self, friedrichs: Option<f64>) -> Result<f64, NoBound> {
        if self.least_reaction < 0.0 {
            return Err(NoBound::NegativeReaction);
        }
        let by_gradient = friedrichs.map(|c| c / self.least_coefficient.max(0.0).sqrt());
        let by_value = self.reaction_from_below.max(0.0).sqrt().recip();
        Ok(by_gradient.map_or(by_value, |c| c.min(by_value)))
    }
}
