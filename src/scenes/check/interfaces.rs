//! Jumps of the value, and kinks, found by bisection along segments.

use super::evaluator::{Evaluator, TOUCHING};
use super::samples::sees;
use super::violation::{Condition, Violation};
use crate::mesh::Domain;
use crate::real::Point;

/// Length to which segments are bisected, relative to the shortest side.
const SHORT: f64 = 1e-9;
/// Change of the value over so short a segment that counts as a jump, relative to slope times
/// length.
const JUMP: f64 = 1e-7;
/// Change of the flux that counts as a kink, relative to its scale. A singularity like `r^{1/2}` at
/// the distance of the segment's length changes it by `SHORT^{1/2} = 3e-5`.
const KINK: f64 = 1e-3;

/// The value has no jump on segments between successive points, and no kink except where an obstacle is
/// active.
pub(super) fn check<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    domain: &Domain<D>,
    points: &[Point<D>],
) -> Result<(), Violation> {
    for pair in points.windows(2).filter(|pair| sees(domain, &pair[0], &pair[1])) {
        check_value(evaluator, pair[0], pair[1])?;
        check_flux(evaluator, pair[0], pair[1])?;
    }
    Ok(())
}

/// Bisects towards the half in which the difference of values deviates more from the gradient.
fn check_value<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    a: Point<D>,
    b: Point<D>,
) -> Result<(), Violation> {
    let (a, b) = bisect(evaluator.scales.length, a, b, |a, b| {
        let mean = (evaluator.gradient(a) + evaluator.gradient(b)) / 2.0;
        (evaluator.value(b) - evaluator.value(a) - mean.dot(&(b - a))).abs()
    });
    let jump = (evaluator.value(&b) - evaluator.value(&a)).abs();
    let allowed = JUMP * evaluator.scales.slope * evaluator.scales.length;
    evaluator.require(Condition::Continuity, &a, jump, allowed)
}

/// Bisects towards the half in which the flux changes more.
///
/// If the flux along the segment drops by `j` across an interface, the multiplier has there a density
/// per unit area that is a positive multiple of `j`: for `j > 0` due to the lower obstacle. Where the
/// coefficient jumps the tangential flux jumps without a multiplier; then only the flux along the jump
/// of the gradient is tested, which is normal to the interface since the value is continuous.
fn check_flux<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    a: Point<D>,
    b: Point<D>,
) -> Result<(), Violation> {
    let (a, b) = bisect(evaluator.scales.length, a, b, |a, b| {
        (evaluator.flux(b) - evaluator.flux(a)).norm()
    });
    let mut across = (b - a).normalize();
    if evaluator.coefficient(&a) != evaluator.coefficient(&b) {
        let jump = evaluator.gradient(&b) - evaluator.gradient(&a);
        if jump.norm() <= KINK * evaluator.scales.slope {
            return Ok(());
        }
        across = jump.normalize() * jump.dot(&across).signum();
    }
    let rise = (evaluator.flux(&b) - evaluator.flux(&a)).dot(&across);
    let distance = if rise > 0.0 { evaluator.below_upper(&a) } else { evaluator.above_lower(&a) };
    let touching = TOUCHING * evaluator.scales.slope * evaluator.scales.length;
    if distance <= touching {
        return Ok(());
    }
    evaluator.require(Condition::Kink, &a, rise.abs(), KINK * evaluator.scales.flux)
}

fn bisect<const D: usize>(
    length: f64,
    mut a: Point<D>,
    mut b: Point<D>,
    change: impl Fn(&Point<D>, &Point<D>) -> f64,
) -> (Point<D>, Point<D>) {
    while (b - a).norm() > SHORT * length {
        let middle = (a + b) / 2.0;
        if change(&a, &middle) >= change(&middle, &b) { b = middle } else { a = middle }
    }
    (a, b)
}
