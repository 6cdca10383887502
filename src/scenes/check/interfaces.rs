//! Jumps of the value, and kinks, found by bisection along segments.

use super::interior::TOUCHING;
use super::probe::Probe;
use super::samples::sees;
use super::{Condition, Violation};
use crate::real::Point;

/// Length to which segments are bisected, relative to the shortest side.
const SHORT: f64 = 1e-9;
/// Change of the value over so short a segment that counts as a jump, relative to slope times
/// length.
const JUMP: f64 = 1e-7;
/// Change of the flux that counts as a kink, relative to its scale. A singularity like `r^{1/2}` at
/// the distance of the segment's length changes it by `SHORT^{1/2} = 3e-5`.
const KINK: f64 = 1e-3;

/// No jump of the value on segments between successive points, and no kink but where an obstacle
/// holds it.
pub(super) fn check<const D: usize>(
    probe: &Probe<'_, D>,
    points: &[Point<f64, D>],
) -> Result<(), Violation> {
    let domain = &probe.scene.domain;
    for pair in points.windows(2).filter(|pair| sees(domain, &pair[0], &pair[1])) {
        check_value(probe, pair[0], pair[1])?;
        check_flux(probe, pair[0], pair[1])?;
    }
    Ok(())
}

/// Follows the half in which value and gradient disagree more.
fn check_value<const D: usize>(
    probe: &Probe<'_, D>,
    a: Point<f64, D>,
    b: Point<f64, D>,
) -> Result<(), Violation> {
    let (a, b) = bisect(probe.scales.length, a, b, |a, b| {
        let mean = (probe.gradient(a) + probe.gradient(b)) / 2.0;
        (probe.value(b) - probe.value(a) - mean.dot(&(b - a))).abs()
    });
    let jump = (probe.value(&b) - probe.value(&a)).abs();
    let allowed = JUMP * probe.scales.slope * probe.scales.length;
    probe.require(Condition::Continuity, &a, jump, allowed)
}

/// Follows the half in which the flux changes more.
///
/// If the flux along the segment drops by `j` across an interface, the obstacle exerts there a
/// force of a positive multiple of `j` per unit area: upwards from below for `j > 0`. Where the
/// coefficient jumps, the tangential flux does too, without any force; then only the flux along the
/// jump of the gradient counts, which is normal to the interface since the value is continuous.
fn check_flux<const D: usize>(
    probe: &Probe<'_, D>,
    a: Point<f64, D>,
    b: Point<f64, D>,
) -> Result<(), Violation> {
    let (a, b) = bisect(probe.scales.length, a, b, |a, b| (probe.flux(b) - probe.flux(a)).norm());
    let mut across = (b - a).normalize();
    if probe.coefficient(&a) != probe.coefficient(&b) {
        let jump = probe.gradient(&b) - probe.gradient(&a);
        if jump.norm() <= KINK * probe.scales.slope {
            return Ok(());
        }
        across = jump.normalize() * jump.dot(&across).signum();
    }
    let rise = (probe.flux(&b) - probe.flux(&a)).dot(&across);
    let distance = if rise > 0.0 { probe.below_upper(&a) } else { probe.above_lower(&a) };
    let touching = TOUCHING * probe.scales.slope * probe.scales.length;
    if distance <= touching {
        return Ok(());
    }
    probe.require(Condition::Kink, &a, rise.abs(), KINK * probe.scales.flux)
}

fn bisect<const D: usize>(
    length: f64,
    mut a: Point<f64, D>,
    mut b: Point<f64, D>,
    change: impl Fn(&Point<f64, D>, &Point<f64, D>) -> f64,
) -> (Point<f64, D>, Point<f64, D>) {
    while (b - a).norm() > SHORT * length {
        let middle = (a + b) / 2.0;
        if change(&a, &middle) >= change(&middle, &b) { b = middle } else { a = middle }
    }
    (a, b)
}
