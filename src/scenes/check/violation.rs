//! The report of a condition that fails.

use crate::readable_debug::debug_by_display;
use crate::real::Point;

/// The first condition that fails, the point, and the amount. `Debug` prints the message.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[error("scene {scene}: not fulfilled: {condition}; at {at:?} off by {by:e}, allowed {allowed:e}")]
pub struct Violation {
    /// Name of the scene.
    pub scene: String,
    /// The condition, in words.
    pub condition: String,
    /// The point.
    pub at: Vec<f64>,
    /// The amount of the violation.
    pub by: f64,
    /// The amount allowed for rounding and truncation errors.
    pub allowed: f64,
}

debug_by_display!(Violation);

impl Violation {
    pub(super) fn new<const D: usize>(
        scene: &str,
        condition: &str,
        at: &Point<D>,
        by: f64,
        allowed: f64,
    ) -> Self {
        let at = at.iter().copied().collect();
        Self { scene: scene.to_owned(), condition: condition.to_owned(), at, by, allowed }
    }
}
