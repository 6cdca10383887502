//! Conditions inside the domain: gradient, obstacles, equation and multiplier.

use super::differences::settled_derivative;
use super::evaluator::{Evaluator, TOUCHING};
use super::stated;
use super::violation::{Condition, Violation};
use crate::real::Point;

/// Error allowed in a derivative by differences, relative to its scale.
const DERIVATIVE: f64 = 1e-6;
/// Largest difference of successive differences that agree, relative to the scale of the derivative;
/// below [`DERIVATIVE`], so that truncation errors are below the error allowed.
const SETTLED: f64 = 1e-7;
/// Largest differencing stencil, relative to the shortest side.
const REACH: f64 = 2e-3;

/// The stated gradient is the derivative of the value.
pub(super) fn check_gradient<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    points: &[Point<D>],
    depth: &dyn Fn(&Point<D>) -> f64,
) -> Result<(), Violation> {
    let slope = evaluator.scales.slope;
    let mut skipped = Skipped::default();
    for x in points {
        let reach = reach(evaluator, depth(x));
        let stated = evaluator.gradient(x);
        for axis in 0..D {
            let along = |t: f64| evaluator.value(&shifted(x, axis, t));
            match settled_derivative(along, reach, SETTLED * slope) {
                Some(found) => {
                    let error = (found - stated[axis]).abs();
                    evaluator.require(Condition::Gradient, x, error, DERIVATIVE * slope)?;
                }
                None => skipped.note(x),
            }
        }
    }
    skipped.check(evaluator, D * points.len())
}

/// `psi_lower <= u <= psi_upper`.
pub(super) fn check_obstacles<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    points: &[Point<D>],
) -> Result<(), Violation> {
    let allowed = TOUCHING * evaluator.scales.value;
    for x in points {
        evaluator.require(Condition::LowerObstacle, x, -evaluator.above_lower(x), allowed)?;
        evaluator.require(Condition::UpperObstacle, x, -evaluator.below_upper(x), allowed)?;
    }
    Ok(())
}

/// The multiplier vanishes off contact and has the sign of the active obstacle; where both obstacles are
/// active its sign is free.
pub(super) fn check_multiplier<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    points: &[Point<D>],
    depth: &dyn Fn(&Point<D>) -> f64,
) -> Result<(), Violation> {
    let mut skipped = Skipped::default();
    for x in points {
        if !check_multiplier_at(evaluator, x, depth(x))? {
            skipped.note(x);
        }
    }
    skipped.check(evaluator, points.len())
}

/// Checks the multiplier at a point of this distance from the boundary. Returns whether it is known there.
pub(super) fn check_multiplier_at<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    x: &Point<D>,
    depth: f64,
) -> Result<bool, Violation> {
    let touching = TOUCHING * evaluator.scales.value;
    let allowed = DERIVATIVE * evaluator.scales.force;
    let Some(multiplier) = multiplier(evaluator, x, depth) else { return Ok(false) };
    let (condition, by) =
        match (evaluator.above_lower(x) <= touching, evaluator.below_upper(x) <= touching) {
            (false, false) => (Condition::Equation, multiplier.abs()),
            (true, false) => (Condition::MultiplierSign, -multiplier),
            (false, true) => (Condition::MultiplierSign, multiplier),
            (true, true) => (Condition::MultiplierSign, 0.0),
        };
    evaluator.require(condition, x, by, allowed)?;
    stated::check_inside(evaluator, x, multiplier, allowed)?;
    Ok(true)
}

/// `-div(alpha grad u) + c u - f`; none where differences of the flux do not settle.
fn multiplier<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    x: &Point<D>,
    depth: f64,
) -> Option<f64> {
    let tolerance = SETTLED * evaluator.scales.force;
    let reach = reach(evaluator, depth);
    let mut divergence = 0.0;
    for axis in 0..D {
        let along = |t: f64| evaluator.flux(&shifted(x, axis, t))[axis];
        divergence += settled_derivative(along, reach, tolerance)?;
    }
    Some(-divergence + evaluator.reaction(x) * evaluator.value(x) - evaluator.source(x))
}

fn shifted<const D: usize>(x: &Point<D>, axis: usize, by: f64) -> Point<D> {
    let mut x = *x;
    x[axis] += by;
    x
}

/// Largest stencil inside the domain: outside a scene may be undefined.
fn reach<const D: usize>(evaluator: &Evaluator<'_, D>, depth: f64) -> f64 {
    (REACH * evaluator.scales.length).min(0.9 * depth)
}

/// Number of derivatives that did not settle, and the last point of one.
#[derive(Default)]
struct Skipped {
    count: usize,
    last: Vec<f64>,
}

impl Skipped {
    fn note<const D: usize>(&mut self, x: &Point<D>) {
        self.count += 1;
        self.last = x.iter().copied().collect();
    }
    fn check<const D: usize>(
        self,
        evaluator: &Evaluator<'_, D>,
        total: usize,
    ) -> Result<(), Violation> {
        let (by, allowed) = (self.count as f64, (total / 4) as f64);
        let last = Point::from_iterator(self.last.into_iter().chain([f64::NAN; D]));
        evaluator.require(Condition::Resolution, &last, by, allowed)
    }
}
