//! Conditions on the stated multiplier and contact set.

use super::evaluator::{Evaluator, TOUCHING};
use super::violation::Violation;
use crate::real::Point;

/// The condition on the stated contact set.
const CONTACT_SET: &str = "contact inside the stated contact set and nowhere else";

/// Error allowed in a multiplier on the boundary, relative to the scale of the flux.
const EXACT: f64 = 1e-8;
/// Size of the indicator on the free boundary that counts as zero, relative to its largest value.
const ZERO: f64 = 1e-9;

impl<const D: usize> Evaluator<'_, D> {
    /// Conditions on multiplier and contact set at a point of the domain, where the multiplier of the
    /// solution is known up to `allowed`.
    pub(super) fn check_stated_inside(
        &self,
        x: &Point<D>,
        multiplier: f64,
        allowed: f64,
    ) -> Result<(), Violation> {
        if !self.problem.has_obstacle() {
            return Ok(());
        }
        let gap = self.above_lower(x).min(self.below_upper(x));
        self.check_stated(x, gap, multiplier, allowed)
    }

    /// Conditions on multiplier and contact set at a point of the contact boundary.
    pub(super) fn check_stated_on_boundary(
        &self,
        x: &Point<D>,
        above: f64,
        outflow: f64,
    ) -> Result<(), Violation> {
        self.check_stated(x, above, outflow, EXACT * self.scales.flux)
    }

    /// The multiplier is the one stated. Inside the contact set a bound is active; outside the gap is positive and the
    /// multiplier vanishes.
    fn check_stated(
        &self,
        x: &Point<D>,
        gap: f64,
        multiplier: f64,
        allowed: f64,
    ) -> Result<(), Violation> {
        if let Some(stated) = &self.exact.multiplier {
            self.require(
                "stated multiplier equal to that of the solution",
                x,
                (multiplier - stated(x)).abs(),
                allowed,
            )?;
        }
        let Some(contact) = &self.exact.contact else { return Ok(()) };
        let indicator = (contact.indicator)(x);
        if indicator > 0.0 {
            return self.require(CONTACT_SET, x, gap, TOUCHING * self.scales.value);
        }
        if indicator < 0.0 {
            self.require(CONTACT_SET, x, multiplier.abs(), allowed)?;
            self.require(CONTACT_SET, x, f64::from(u8::from(gap <= 0.0)), 0.0)?;
        }
        let is_none = f64::from(u8::from(indicator.is_nan()));
        self.require("indicator finite", x, is_none, 0.0)
    }

    /// The indicator vanishes on the stated free boundary.
    pub(super) fn check_free_boundary(&self, points: &[Point<D>]) -> Result<(), Violation> {
        let Some(contact) = &self.exact.contact else { return Ok(()) };
        let largest = points.iter().map(|x| (contact.indicator)(x).abs()).fold(0.0, f64::max);
        for x in &contact.free_boundary {
            let value = (contact.indicator)(x).abs();
            self.require("free boundary between contact and no contact", x, value, ZERO * largest)?;
        }
        Ok(())
    }
}
