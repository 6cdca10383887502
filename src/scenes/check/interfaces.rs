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

impl<const D: usize> Evaluator<'_, D> {
    /// The value has no jump on segments between successive points, and no kink except where an obstacle is
    /// active.
    pub(super) fn check_interfaces(
        &self,
        domain: &Domain<D>,
        points: &[Point<D>],
    ) -> Result<(), Violation> {
        for pair in points.windows(2).filter(|pair| sees(domain, &pair[0], &pair[1])) {
            self.check_value_between(pair[0], pair[1])?;
            self.check_flux_between(pair[0], pair[1])?;
        }
        Ok(())
    }

    /// Bisects towards the half in which the difference of values deviates more from the gradient.
    fn check_value_between(&self, a: Point<D>, b: Point<D>) -> Result<(), Violation> {
        let (a, b) = bisect(self.scales.length, a, b, |a, b| {
            let mean = (self.gradient(a) + self.gradient(b)) / 2.0;
            (self.value(b) - self.value(a) - mean.dot(&(b - a))).abs()
        });
        let jump = (self.value(&b) - self.value(&a)).abs();
        let allowed = JUMP * self.scales.slope * self.scales.length;
        self.require(Condition::Continuity, &a, jump, allowed)
    }

    /// Bisects towards the half in which the flux changes more.
    ///
    /// If the flux along the segment drops by `j` across an interface, the multiplier has there a density
    /// per unit area that is a positive multiple of `j`: for `j > 0` due to the lower obstacle. Where the
    /// coefficient jumps the tangential flux jumps without a multiplier; then only the flux along the jump
    /// of the gradient is tested, which is normal to the interface since the value is continuous.
    fn check_flux_between(&self, a: Point<D>, b: Point<D>) -> Result<(), Violation> {
        let change = |a: &Point<D>, b: &Point<D>| (self.flux(b) - self.flux(a)).norm();
        let (a, b) = bisect(self.scales.length, a, b, change);
        let mut across = (b - a).normalize();
        if self.coefficient(&a) != self.coefficient(&b) {
            let jump = self.gradient(&b) - self.gradient(&a);
            if jump.norm() <= KINK * self.scales.slope {
                return Ok(());
            }
            across = jump.normalize() * jump.dot(&across).signum();
        }
        let rise = (self.flux(&b) - self.flux(&a)).dot(&across);
        let distance = if rise > 0.0 { self.below_upper(&a) } else { self.above_lower(&a) };
        let touching = TOUCHING * self.scales.slope * self.scales.length;
        if distance <= touching {
            return Ok(());
        }
        self.require(Condition::Kink, &a, rise.abs(), KINK * self.scales.flux)
    }
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
