//! Kinks of the convex functions of unknowns: friction.

mod turning;

use super::bound::Bound;

/// A kink of the convex function `slope |x - place|` of an unknown, which may have bounds of its own beside it.
///
/// Load and bounds of the inequality are those of one side of the kink. The place is a bound of the unknown there, the
/// lower one above the place, the upper one below it; the load has `-slope` above the place, `slope` below it.
/// [`Inequality::turn`](super::Inequality::turn) goes from one side to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kink<T> {
    /// The unknown.
    pub unknown: u32,
    /// The slope, positive.
    pub slope: T,
    /// Where the slope jumps.
    pub place: T,
    /// Whether the inequality has the side above the place.
    pub is_above: bool,
    /// The bounds of the unknown without the kink.
    pub own: Bound<T>,
}
