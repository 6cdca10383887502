//! The terms of the bound, of one cell or of several cells together.

use crate::algebra::Distribution;
use crate::error_bound::NoBound;

/// The terms of a cell, or of some cells: sums, and least values.
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
    /// The square of the norm of what the solver left: the mean of what the flux leaves of the load where no obstacle
    /// presses in its direction.
    pub unbalanced: f64,
    /// The least value of the coefficient.
    pub least_coefficient: f64,
    /// The least value of the reaction at points, vertices and midpoints of edges.
    pub least_reaction: f64,
    /// A bound from below for a reaction of degree two.
    pub reaction_from_below: f64,
}

impl Totals {
    /// The terms of no cells.
    pub const NONE: Self = Self {
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

    /// The contribution to the square of the bound, without the term of the solver.
    pub fn square(&self) -> f64 {
        self.with_oscillation + self.obstacle + self.contact
    }

    /// The bounds on the error of the function and on that of the discrete function, with the term of the solver.
    pub fn bounds(&self, of_solver: f64) -> [f64; 2] {
        let of_flux = (self.with_oscillation.sqrt() + of_solver).powi(2);
        let complementarity = self.obstacle + self.contact;
        // the radius of the ball around the midpoint that contains the solution, and the distance of the discrete
        // function from the midpoint
        let radius = 0.5 * (of_flux + 2.0 * complementarity).sqrt();
        let discrete = radius + self.from_midpoint.sqrt() + 0.5 * of_solver;
        [(of_flux + complementarity).sqrt(), discrete]
    }

    /// Adds the terms of other cells.
    pub fn add(&mut self, others: &Self) {
        self.mismatch += others.mismatch;
        self.with_oscillation += others.with_oscillation;
        self.from_midpoint += others.from_midpoint;
        self.distance += others.distance;
        self.obstacle += others.obstacle;
        self.contact += others.contact;
        self.unbalanced += others.unbalanced;
        self.least_coefficient = others.least_coefficient.min(self.least_coefficient);
        self.least_reaction = others.least_reaction.min(self.least_reaction);
        self.reaction_from_below = others.reaction_from_below.min(self.reaction_from_below);
    }

    /// The terms of all parts of a mesh; all parts call this function.
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

    /// Whether the solver left something that no reaction bounds.
    pub fn needs_constant(&self) -> bool {
        self.unbalanced != 0.0 && self.reaction_from_below <= 0.0
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
