//! Conditions inside the domain: gradient, obstacles, equation and multiplier.

use super::differences::settled_derivative;
use super::probe::Probe;
use super::{Condition, Violation, stated};
use crate::real::Point;

/// Error allowed in a derivative by differences, relative to its scale.
const DERIVATIVE: f64 = 1e-6;
/// Agreement asked of successive differences; below the error allowed, so that truncation cannot
/// decide.
const SETTLED: f64 = 1e-7;
/// Distance to an obstacle that counts as contact, relative to the value.
pub(super) const TOUCHING: f64 = 1e-8;
/// Largest differencing stencil, relative to the shortest side.
const REACH: f64 = 2e-3;

/// The stated gradient is the derivative of the value.
pub(super) fn check_gradient<const D: usize>(
    probe: &Probe<'_, D>,
    points: &[Point<f64, D>],
) -> Result<(), Violation> {
    let slope = probe.scales.slope;
    let mut skipped = Skipped::default();
    for x in points {
        let stated = probe.gradient(x);
        for axis in 0..D {
            let along = |t: f64| probe.value(&shifted(x, axis, t));
            match settled_derivative(along, reach(probe, x), SETTLED * slope) {
                Some(found) => {
                    let error = (found - stated[axis]).abs();
                    probe.require(Condition::Gradient, x, error, DERIVATIVE * slope)?;
                }
                None => skipped.note(x),
            }
        }
    }
    skipped.check(probe, D * points.len())
}

/// `psi_lower <= u <= psi_upper`.
pub(super) fn check_obstacles<const D: usize>(
    probe: &Probe<'_, D>,
    points: &[Point<f64, D>],
) -> Result<(), Violation> {
    let allowed = TOUCHING * probe.scales.value;
    for x in points {
        probe.require(Condition::LowerObstacle, x, -probe.above_lower(x), allowed)?;
        probe.require(Condition::UpperObstacle, x, -probe.below_upper(x), allowed)?;
    }
    Ok(())
}

/// The multiplier vanishes off contact and has the sign of the obstacle touched; between two
/// obstacles that meet it is free.
pub(super) fn check_multiplier<const D: usize>(
    probe: &Probe<'_, D>,
    points: &[Point<f64, D>],
) -> Result<(), Violation> {
    let touching = TOUCHING * probe.scales.value;
    let allowed = DERIVATIVE * probe.scales.force;
    let mut skipped = Skipped::default();
    for x in points {
        let Some(multiplier) = multiplier(probe, x) else {
            skipped.note(x);
            continue;
        };
        let (condition, by) =
            match (probe.above_lower(x) <= touching, probe.below_upper(x) <= touching) {
                (false, false) => (Condition::Equation, multiplier.abs()),
                (true, false) => (Condition::MultiplierSign, -multiplier),
                (false, true) => (Condition::MultiplierSign, multiplier),
                (true, true) => (Condition::MultiplierSign, 0.0),
            };
        probe.require(condition, x, by, allowed)?;
        stated::check_inside(probe, x, multiplier, allowed)?;
    }
    skipped.check(probe, points.len())
}

/// `-div(alpha grad u) + c u - f`, where differences of the flux settle.
fn multiplier<const D: usize>(probe: &Probe<'_, D>, x: &Point<f64, D>) -> Option<f64> {
    let tolerance = SETTLED * probe.scales.force;
    let reach = reach(probe, x);
    let mut divergence = 0.0;
    for axis in 0..D {
        let along = |t: f64| probe.flux(&shifted(x, axis, t))[axis];
        divergence += settled_derivative(along, reach, tolerance)?;
    }
    Some(-divergence + probe.reaction(x) * probe.value(x) - probe.source(x))
}

fn shifted<const D: usize>(x: &Point<f64, D>, axis: usize, by: f64) -> Point<f64, D> {
    let mut x = *x;
    x[axis] += by;
    x
}

/// Largest stencil that stays inside the domain, where alone a scene need be defined.
fn reach<const D: usize>(probe: &Probe<'_, D>, x: &Point<f64, D>) -> f64 {
    (REACH * probe.scales.length).min(0.9 * probe.scene.domain.depth(x))
}

/// Derivatives that did not settle.
#[derive(Default)]
struct Skipped {
    count: usize,
    last: Vec<f64>,
}

impl Skipped {
    fn note<const D: usize>(&mut self, x: &Point<f64, D>) {
        self.count += 1;
        self.last = x.iter().copied().collect();
    }
    fn check<const D: usize>(self, probe: &Probe<'_, D>, total: usize) -> Result<(), Violation> {
        let (by, allowed) = (self.count as f64, (total / 4) as f64);
        let last = Point::from_iterator(self.last.into_iter().chain([f64::NAN; D]));
        probe.require(Condition::Resolution, &last, by, allowed)
    }
}
