//! What a scene states of its multiplier and contact set.

use super::interior::TOUCHING;
use super::probe::Probe;
use super::{Condition, Violation};
use crate::real::Point;

/// Error allowed in a multiplier on the boundary, relative to the scale of the flux.
const EXACT: f64 = 1e-8;
/// Size of the indicator on the free boundary that counts as zero, relative to its largest value.
const ZERO: f64 = 1e-9;

/// Multiplier and contact set of obstacles at a point where the multiplier of the solution is known
/// up to `allowed`.
pub(super) fn check_inside<const D: usize>(
    probe: &Probe<'_, D>,
    x: &Point<f64, D>,
    multiplier: f64,
    allowed: f64,
) -> Result<(), Violation> {
    if !probe.scene.problem.has_obstacle() {
        return Ok(());
    }
    check_multiplier(probe, x, multiplier, allowed)?;
    check_contact(probe, x, probe.above_lower(x).min(probe.below_upper(x)), multiplier, allowed)
}

/// The same for a Signorini condition at a point of the contact part.
pub(super) fn check_on_boundary<const D: usize>(
    probe: &Probe<'_, D>,
    x: &Point<f64, D>,
    above: f64,
    outflow: f64,
) -> Result<(), Violation> {
    let allowed = EXACT * probe.scales.flux;
    check_multiplier(probe, x, outflow, allowed)?;
    check_contact(probe, x, above, outflow, allowed)
}

fn check_multiplier<const D: usize>(
    probe: &Probe<'_, D>,
    x: &Point<f64, D>,
    found: f64,
    allowed: f64,
) -> Result<(), Violation> {
    match &probe.exact.multiplier {
        Some(stated) => probe.require(Condition::Multiplier, x, (found - stated(x)).abs(), allowed),
        None => Ok(()),
    }
}

/// Inside the contact set a bound is touched; outside there is a gap, however small, and no
/// multiplier.
fn check_contact<const D: usize>(
    probe: &Probe<'_, D>,
    x: &Point<f64, D>,
    gap: f64,
    multiplier: f64,
    allowed: f64,
) -> Result<(), Violation> {
    let Some(contact) = &probe.exact.contact else { return Ok(()) };
    let indicator = (contact.indicator)(x);
    if indicator > 0.0 {
        return probe.require(Condition::ContactSet, x, gap, TOUCHING * probe.scales.value);
    }
    if indicator < 0.0 {
        probe.require(Condition::ContactSet, x, multiplier.abs(), allowed)?;
        probe.require(Condition::ContactSet, x, f64::from(u8::from(gap <= 0.0)), 0.0)?;
    }
    probe.require(Condition::Finite("indicator"), x, f64::from(u8::from(indicator.is_nan())), 0.0)
}

/// The indicator vanishes on the stated free boundary.
pub(super) fn check_free_boundary<const D: usize>(
    probe: &Probe<'_, D>,
    points: &[Point<f64, D>],
) -> Result<(), Violation> {
    let Some(contact) = &probe.exact.contact else { return Ok(()) };
    let largest = points.iter().map(|x| (contact.indicator)(x).abs()).fold(0.0, f64::max);
    for x in &contact.free_boundary {
        let value = (contact.indicator)(x).abs();
        probe.require(Condition::FreeBoundary, x, value, ZERO * largest)?;
    }
    Ok(())
}
