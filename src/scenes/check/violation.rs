//! The conditions of a scene, and the report of one that fails.

use std::fmt;

use crate::readable_debug::debug_by_display;
use crate::real::Point;

/// A condition on a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Condition {
    /// The datum of this name is a finite number.
    Finite(&'static str),
    /// The coefficient is positive, the reaction not negative; [`Violation::by`] is the value found.
    Ellipticity,
    /// A lower bound stays below the upper bound, and Dirichlet data lie between the bounds.
    Admissible,
    /// A contact side has a gap.
    GapGiven,
    /// The stated gradient is the derivative of the stated value.
    Gradient,
    /// The value has no jump.
    Continuity,
    /// The normal flux jumps only where an obstacle is active: there the multiplier is a measure on a
    /// line or surface.
    Kink,
    /// `u >= psi_lower`.
    LowerObstacle,
    /// `u <= psi_upper`.
    UpperObstacle,
    /// `-div(alpha grad u) + c u = f` where no obstacle is active.
    Equation,
    /// `-div(alpha grad u) + c u - f` is not negative where only the lower obstacle is active, not
    /// positive where only the upper obstacle is active.
    MultiplierSign,
    /// Differences approximate second derivatives at enough sample points.
    Resolution,
    /// Value and gradient on the boundary are their limits from inside, and rounding errors of the
    /// point do not change them.
    BoundaryLimit,
    /// Dirichlet data are the solution.
    Dirichlet,
    /// Neumann data are the flux of the solution.
    Neumann,
    /// `u >= g` on the contact boundary.
    Gap,
    /// `alpha du/dn >= 0` on the contact boundary.
    ContactFlux,
    /// `u = g` or `alpha du/dn = 0` on the contact boundary.
    ContactComplementarity,
    /// The stated multiplier is `-div(alpha grad u) + c u - f`, or `alpha du/dn` on the contact
    /// boundary.
    Multiplier,
    /// A bound is active inside the stated contact set; outside, no bound is active and the multiplier
    /// vanishes.
    ContactSet,
    /// Stated points of the free boundary are zeros of the contact set's indicator.
    FreeBoundary,
}

impl fmt::Display for Condition {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Finite(datum) => return write!(out, "{datum} finite"),
            Self::Ellipticity => "coefficient positive and reaction not negative",
            Self::Admissible => "bounds in order and Dirichlet data between them",
            Self::GapGiven => "a gap for the contact side",
            Self::Gradient => "gradient equal to the derivative of the value",
            Self::Continuity => "value continuous",
            Self::Kink => "flux continuous where no obstacle holds a kink",
            Self::LowerObstacle => "solution above the lower obstacle",
            Self::UpperObstacle => "solution below the upper obstacle",
            Self::Equation => "-div(alpha grad u) + c u = f off contact",
            Self::MultiplierSign => "sign of the multiplier on contact",
            Self::Resolution => "second derivatives that differences can resolve",
            Self::BoundaryLimit => "value and gradient continuous up to and across the boundary",
            Self::Dirichlet => "Dirichlet data equal to the solution",
            Self::Neumann => "Neumann data equal to the flux of the solution",
            Self::Gap => "u >= g on the contact boundary",
            Self::ContactFlux => "alpha du/dn >= 0 on the contact boundary",
            Self::ContactComplementarity => "u = g or alpha du/dn = 0 on the contact boundary",
            Self::Multiplier => "stated multiplier equal to that of the solution",
            Self::ContactSet => "contact inside the stated contact set and nowhere else",
            Self::FreeBoundary => "free boundary between contact and no contact",
        })
    }
}

/// The first condition that fails, the point, and the amount. `Debug` prints the message.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[error("scene {scene}: not fulfilled: {condition}; at {at:?} off by {by:e}, allowed {allowed:e}")]
pub struct Violation {
    /// Name of the scene.
    pub scene: String,
    /// The condition.
    pub condition: Condition,
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
        condition: Condition,
        at: &Point<D>,
        by: f64,
        allowed: f64,
    ) -> Self {
        let at = at.iter().copied().collect();
        Self { scene: scene.to_owned(), condition, at, by, allowed }
    }
}
