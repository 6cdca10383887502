//! A numerical test of a scene's derivation, for every author of a scene.
//!
//! ```
//! use unilateral::scenes::{check_scene, radial};
//!
//! check_scene(&radial::<2>(1.0), 200).unwrap();
//! ```

mod boundary;
mod data;
mod differences;
mod interfaces;
mod interior;
mod probe;
mod samples;
mod stated;

use std::fmt;

use super::Scene;
use probe::Probe;

/// What a scene must fulfil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Condition {
    /// The datum of this name is a finite number.
    Finite(&'static str),
    /// The coefficient is positive, the reaction not negative; the number is the offending value.
    Ellipticity,
    /// A lower bound stays below the upper bound, and Dirichlet data lie between the bounds.
    Admissible,
    /// A contact side has a gap.
    GapGiven,
    /// The stated gradient is the derivative of the stated value.
    Gradient,
    /// The value has no jump.
    Continuity,
    /// The normal flux jumps only where an obstacle holds the kink: there the multiplier is a
    /// measure on a line or surface.
    Kink,
    /// `u >= psi_lower`.
    LowerObstacle,
    /// `u <= psi_upper`.
    UpperObstacle,
    /// `-div(alpha grad u) + c u = f` where no obstacle is touched.
    Equation,
    /// `-div(alpha grad u) + c u - f` is not negative where only the lower obstacle is touched, not
    /// positive where only the upper one is.
    MultiplierSign,
    /// Enough sample points lie where the second derivatives can be told by differences.
    Resolution,
    /// Value and gradient on the boundary are their limits from inside, and rounding errors of the
    /// point do not change them.
    BoundaryLimit,
    /// Dirichlet data are the solution.
    Dirichlet,
    /// Neumann data are the flux of the solution.
    Neumann,
    /// `u >= g` on the contact part.
    Gap,
    /// `alpha du/dn >= 0` on the contact part.
    ContactFlux,
    /// `u = g` or `alpha du/dn = 0` on the contact part.
    ContactComplementarity,
    /// The stated multiplier is `-div(alpha grad u) + c u - f`, or `alpha du/dn` on the contact
    /// part.
    Multiplier,
    /// A bound is touched inside the stated contact set and not outside, where there is no
    /// multiplier either.
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
            Self::Gap => "u >= g on the contact part",
            Self::ContactFlux => "alpha du/dn >= 0 on the contact part",
            Self::ContactComplementarity => "u = g or alpha du/dn = 0 on the contact part",
            Self::Multiplier => "stated multiplier equal to that of the solution",
            Self::ContactSet => "contact inside the stated contact set and nowhere else",
            Self::FreeBoundary => "free boundary between contact and no contact",
        })
    }
}

/// The first condition found to fail: which, where, and by how much.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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
    /// The amount that would pass for rounding and truncation.
    pub allowed: f64,
}

/// Tests that data and exact solution of a scene fit together, at `samples` quasi-random points of
/// its domain and as many of each side. The points are the same in every run.
///
/// In this order: all data are finite (also at the corners, at the origin and on a lattice that
/// meshes share); bounds are in order; and, where an exact solution is stated,
///
/// * its gradient is that of its value, by fourth-order central differences;
/// * value and flux have no jumps along the segments between successive points, except kinks that
///   an obstacle holds with a force of the right sign;
/// * it respects the obstacles, its multiplier `-div(alpha grad u) + c u - f` vanishes where none
///   is touched and has the sign of the one that is;
/// * it takes the boundary data, and fulfils the Signorini conditions on contact sides;
/// * multiplier and contact set are those of the solution, where they are stated.
///
/// Differences use steps from a thousandth of the shortest side downwards until three successive
/// ones agree; a point where none do lies on an interface or a singularity and is passed over. If
/// more than a quarter of the points are, that is [`Condition::Resolution`].
///
/// Tolerances are relative to the largest values met, `1e-6` for the multiplier and the gradient
/// and `1e-8` for the rest. Not seen are errors confined to regions that hold no sample.
///
/// # Errors
///
/// The first [`Violation`] found.
pub fn check_scene<const D: usize>(scene: &Scene<D>, samples: usize) -> Result<(), Violation> {
    let samples = samples.max(2);
    let inside = samples::inside(&scene.domain, samples);
    data::check(scene, &inside, samples)?;
    let Some(exact) = &scene.problem.exact else { return Ok(()) };
    let probe = Probe::new(scene, exact, &inside);
    interior::check_gradient(&probe, &inside)?;
    interfaces::check(&probe, &inside)?;
    interior::check_obstacles(&probe, &inside)?;
    interior::check_multiplier(&probe, &inside)?;
    boundary::check(&probe, samples)?;
    stated::check_free_boundary(&probe, &inside)
}
