//! Kinks of the convex functions of unknowns: friction.

mod turning;

/// A kink of the convex function `slope |x - place|` of an unknown.
///
/// The place is the bound of the unknown: [`Bound::Lower`](super::Bound::Lower) where the load has the slope of the
/// function above the place, `-slope`, [`Bound::Upper`](super::Bound::Upper) where it has that below, `slope`.
/// [`Inequality::turn`](super::Inequality::turn) goes from one to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kink<T> {
    /// The unknown.
    pub unknown: u32,
    /// The slope, positive.
    pub slope: T,
}
