//! Conditions inside the domain: gradient, obstacles, equation and multiplier.

use super::differences::settled_derivative;
use super::evaluator::{Evaluator, TOUCHING};
use super::violation::Violation;
use crate::real::Point;

/// Error allowed in a derivative by differences, relative to its scale.
const DERIVATIVE: f64 = 1e-6;
/// Largest difference of successive differences that agree, relative to the scale of the derivative;
/// below [`DERIVATIVE`], so that truncation errors are below the error allowed.
const SETTLED: f64 = 1e-7;
/// Largest differencing stencil, relative to the shortest side.
const REACH: f64 = 2e-3;

impl<const D: usize> Evaluator<'_, D> {
    /// The stated gradient is the derivative of the value.
    pub(super) fn check_gradient(
        &self,
        points: &[Point<D>],
        depth: &dyn Fn(&Point<D>) -> f64,
    ) -> Result<(), Violation> {
        let slope = self.scales.slope;
        let mut skipped = Vec::new();
        for x in points {
            let reach = self.reach(depth(x));
            let stated = self.gradient(x);
            for axis in 0..D {
                let along = |t: f64| self.value(&shifted(x, axis, t));
                match settled_derivative(along, reach, SETTLED * slope) {
                    Some(found) => {
                        let error = (found - stated[axis]).abs();
                        self.require(
                            "gradient equal to the derivative of the value",
                            x,
                            error,
                            DERIVATIVE * slope,
                        )?;
                    }
                    None => skipped.push(x),
                }
            }
        }
        self.check_resolution(&skipped, D * points.len())
    }

    /// `psi_lower <= u <= psi_upper`.
    pub(super) fn check_obstacles(&self, points: &[Point<D>]) -> Result<(), Violation> {
        let allowed = TOUCHING * self.scales.value;
        for x in points {
            self.require("solution above the lower obstacle", x, -self.above_lower(x), allowed)?;
            self.require("solution below the upper obstacle", x, -self.below_upper(x), allowed)?;
        }
        Ok(())
    }

    /// The multiplier vanishes off contact and has the sign of the active obstacle; where both obstacles are
    /// active its sign is free.
    pub(super) fn check_multiplier(
        &self,
        points: &[Point<D>],
        depth: &dyn Fn(&Point<D>) -> f64,
    ) -> Result<(), Violation> {
        let mut skipped = Vec::new();
        for x in points {
            if !self.check_multiplier_at(x, depth(x))? {
                skipped.push(x);
            }
        }
        self.check_resolution(&skipped, points.len())
    }

    /// Checks the multiplier at a point of this distance from the boundary. Returns whether it is known there.
    pub(super) fn check_multiplier_at(&self, x: &Point<D>, depth: f64) -> Result<bool, Violation> {
        let touching = TOUCHING * self.scales.value;
        let allowed = DERIVATIVE * self.scales.force;
        let Some(multiplier) = self.multiplier(x, depth) else { return Ok(false) };
        let (condition, by) =
            match (self.above_lower(x) <= touching, self.below_upper(x) <= touching) {
                (false, false) => ("-div(alpha grad u) + c u = f off contact", multiplier.abs()),
                (true, false) => ("sign of the multiplier on contact", -multiplier),
                (false, true) => ("sign of the multiplier on contact", multiplier),
                (true, true) => ("sign of the multiplier on contact", 0.0),
            };
        self.require(condition, x, by, allowed)?;
        self.check_stated_inside(x, multiplier, allowed)?;
        Ok(true)
    }

    /// `-div(alpha grad u) + c u - f`; none where differences of the flux do not settle.
    fn multiplier(&self, x: &Point<D>, depth: f64) -> Option<f64> {
        let tolerance = SETTLED * self.scales.force;
        let reach = self.reach(depth);
        let mut divergence = 0.0;
        for axis in 0..D {
            let along = |t: f64| self.flux(&shifted(x, axis, t))[axis];
            divergence += settled_derivative(along, reach, tolerance)?;
        }
        Some(-divergence + self.reaction(x) * self.value(x) - self.source(x))
    }

    /// The largest extent of a stencil inside the domain, outside of which the data of a scene may be undefined.
    fn reach(&self, depth: f64) -> f64 {
        (REACH * self.scales.length).min(0.9 * depth)
    }

    /// Of so many derivatives no more than a quarter did not settle, at these points.
    fn check_resolution(&self, skipped: &[&Point<D>], total: usize) -> Result<(), Violation> {
        let Some(last) = skipped.last() else { return Ok(()) };
        let (by, allowed) = (skipped.len() as f64, (total / 4) as f64);
        self.require("second derivatives that differences can resolve", last, by, allowed)
    }
}

fn shifted<const D: usize>(x: &Point<D>, axis: usize, by: f64) -> Point<D> {
    let mut x = *x;
    x[axis] += by;
    x
}
