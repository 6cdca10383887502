//! Sums and least values of the terms of cells.

use super::CellTerms;
use crate::algebra::Distribution;
use crate::error_bound::NoBound;

/// Sums over cells, and least values.
#[derive(Clone, Copy, Debug)]
pub(in crate::error_bound) struct Totals {
    /// The square of the mismatch.
    pub mismatch: f64,
    /// The square of the mismatch with the oscillation added.
    pub with_oscillation: f64,
    /// The square of the distance of the discrete function from the midpoint, with half of the oscillation added.
    pub from_midpoint: f64,
    /// The square of the distance of the two functions.
    pub distance: f64,
    /// Twice the complementarity of obstacles.
    pub obstacle: f64,
    /// Twice the complementarity of contact.
    pub contact: f64,
    /// The square of the norm of what the solver left.
    pub unbalanced: f64,
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
            with_oscillation: 0.0,
            from_midpoint: 0.0,
            distance: 0.0,
            obstacle: 0.0,
            contact: 0.0,
            unbalanced: 0.0,
            least_coefficient: f64::INFINITY,
            least_reaction: f64::INFINITY,
            reaction_from_below: f64::INFINITY,
        };
        for t in terms.iter().flatten() {
            totals.mismatch += t.mismatch;
            totals.with_oscillation += t.with_oscillation;
            totals.from_midpoint += t.from_midpoint;
            totals.distance += t.distance;
            totals.obstacle += t.obstacle;
            totals.contact += t.contact;
            totals.unbalanced += t.unbalanced;
            totals.least_coefficient = t.least_coefficient.min(totals.least_coefficient);
            totals.least_reaction = t.least_reaction.min(totals.least_reaction);
            totals.reaction_from_below = t.reaction_from_below.min(totals.reaction_from_below);
        }
        totals
    }

    /// Those of all parts of a mesh; all parts call it.
    pub fn add_over_parts(&mut self, distribution: &dyn Distribution) {
        let mut sums = self.sums().map(|sum| *sum);
        distribution.sum(&mut sums);
        self.sums().into_iter().zip(sums).for_each(|(own, sum)| *own = sum);
        let mut largest =
            [-self.least_coefficient, -self.least_reaction, -self.reaction_from_below];
        distribution.largest(&mut largest);
        [self.least_coefficient, self.least_reaction, self.reaction_from_below] =
            largest.map(|x| -x);
    }

    /// The sums over cells.
    fn sums(&mut self) -> [&mut f64; 7] {
        [
            &mut self.mismatch,
            &mut self.with_oscillation,
            &mut self.from_midpoint,
            &mut self.distance,
            &mut self.obstacle,
            &mut self.contact,
            &mut self.unbalanced,
        ]
    }

    /// The term of the solver, a number `A` with `(rho, e) <= A |||e|||` for what the solver left, `rho`, and all `e`
    /// that vanish on the Dirichlet boundary: the norm of `rho` in L2 times the constant of Friedrichs' inequality or,
    /// where the reaction is positive, by the reaction. None if neither is known and `rho` is not zero.
    pub fn of_solver(&self, friedrichs: Option<f64>) -> Result<Option<f64>, NoBound> {
        if self.least_reaction < 0.0 {
            return Err(NoBound::NegativeReaction);
        }
        let by_gradient = friedrichs.map(|c| c / self.least_coefficient.max(0.0).sqrt());
        let by_value = self.reaction_from_below.max(0.0).sqrt().recip();
        let constant = by_gradient.map_or(by_value, |c| c.min(by_value));
        Ok(match self.unbalanced == 0.0 {
            true => Some(0.0),
            false => Some(constant * self.unbalanced.sqrt()).filter(|a| a.is_finite()),
        })
    }
}
