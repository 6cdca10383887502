//! Conditions on the stated multiplier and contact set.

use super::evaluator::{Evaluator, TOUCHING};
use super::violation::{Condition, Violation};
use crate::real::Point;

/// Error allowed in a multiplier on the boundary, relative to the scale of the flux.
const EXACT: f64 = 1e-8;
/// Size of the indicator on the free boundary that counts as zero, relative to its largest value.
const ZERO: f64 = 1e-9;

/// Conditions on multiplier and contact set at a point of the domain, where the multiplier of the
/// solution is known up to `allowed`.
pub(super) fn check_inside<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    x: &Point<D>,
    multiplier: f64,
    allowed: f64,
) -> Result<(), Violation> {
    if !evaluator.problem.has_obstacle() {
        return Ok(());
    }
    check_multiplier(evaluator, x, multiplier, allowed)?;
    check_contact(
        evaluator,
        x,
        evaluator.above_lower(x).min(evaluator.below_upper(x)),
        multiplier,
        allowed,
    )
}

/// Conditions on multiplier and contact set at a point of the contact boundary.
pub(super) fn check_on_boundary<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    x: &Point<D>,
    above: f64,
    outflow: f64,
) -> Result<(), Violation> {
    let allowed = EXACT * evaluator.scales.flux;
    check_multiplier(evaluator, x, outflow, allowed)?;
    check_contact(evaluator, x, above, outflow, allowed)
}

fn check_multiplier<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    x: &Point<D>,
    found: f64,
    allowed: f64,
) -> Result<(), Violation> {
    match &evaluator.exact.multiplier {
        Some(stated) => {
            evaluator.require(Condition::Multiplier, x, (found - stated(x)).abs(), allowed)
        }
        None => Ok(()),
    }
}

/// Inside the contact set a bound is active; outside the gap is positive and the multiplier vanishes.
fn check_contact<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    x: &Point<D>,
    gap: f64,
    multiplier: f64,
    allowed: f64,
) -> Result<(), Violation> {
    let Some(contact) = &evaluator.exact.contact else { return Ok(()) };
    let indicator = (contact.indicator)(x);
    if indicator > 0.0 {
        return evaluator.require(Condition::ContactSet, x, gap, TOUCHING * evaluator.scales.value);
    }
    if indicator < 0.0 {
        evaluator.require(Condition::ContactSet, x, multiplier.abs(), allowed)?;
        evaluator.require(Condition::ContactSet, x, f64::from(u8::from(gap <= 0.0)), 0.0)?;
    }
    evaluator.require(
        Condition::Finite("indicator"),
        x,
        f64::from(u8::from(indicator.is_nan())),
        0.0,
    )
}

/// The indicator vanishes on the stated free boundary.
pub(super) fn check_free_boundary<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    points: &[Point<D>],
) -> Result<(), Violation> {
    let Some(contact) = &evaluator.exact.contact else { return Ok(()) };
    let largest = points.iter().map(|x| (contact.indicator)(x).abs()).fold(0.0, f64::max);
    for x in &contact.free_boundary {
        let value = (contact.indicator)(x).abs();
        evaluator.require(Condition::FreeBoundary, x, value, ZERO * largest)?;
    }
    Ok(())
}
