//! The catalogue: named inequalities, most with an exact solution.
//!
//! A scene is one function in one file that returns a [`Scene`]; the derivation of its solution
//! stands in its doc comment, and [`check_scene`] tests that derivation numerically. It is
//! registered by one line in [`catalogue`]; a scene that is not registered works as well, for a
//! [`Scene`] is a plain value.

mod ball;
pub mod check;
mod free_boundary;
mod halfplane;
mod hertz;
mod radial;
mod registry;
mod signorini;
mod signorini_harmonic;

pub use ball::ball_2d;
pub use check::check_scene;
pub use hertz::hertz_2d;
pub use radial::radial;
pub use registry::{AnyScene, Entry, Takes, by_name, catalogue};
pub use signorini::signorini_2d;
pub use signorini_harmonic::signorini_harmonic;

use crate::mesh::BoundaryPart;
use crate::problem::Problem;
use crate::real::Point;

/// An axis-parallel box and the part of the boundary each of its sides belongs to.
#[derive(Clone, Debug)]
pub struct BoxDomain<const D: usize> {
    /// Lowest corner.
    pub lower: Point<f64, D>,
    /// Highest corner.
    pub upper: Point<f64, D>,
    /// Part of the sides `x_k = lower_k` and `x_k = upper_k`, for each axis `k`.
    pub sides: [[BoundaryPart; 2]; D],
}

impl<const D: usize> BoxDomain<D> {
    /// The box with Dirichlet data on every side.
    pub fn dirichlet(lower: Point<f64, D>, upper: Point<f64, D>) -> Self {
        Self { lower, upper, sides: [[BoundaryPart::Dirichlet; 2]; D] }
    }
    /// The same box with another part on one side (`end` 0 for the lower, 1 for the upper one).
    #[must_use]
    pub fn side(mut self, axis: usize, end: usize, part: BoundaryPart) -> Self {
        self.sides[axis][end] = part;
        self
    }
    /// The box of Signorini scenes: `(-1,1)^(D-1) x (0,1)`, contact where the last coordinate is
    /// zero, Dirichlet data on the other sides.
    pub fn above_contact() -> Self {
        let mut lower = Point::repeat(-1.0);
        lower[D - 1] = 0.0;
        Self::dirichlet(lower, Point::repeat(1.0)).side(D - 1, 0, BoundaryPart::Contact)
    }
}

/// Regularity of the exact solution, from which theory predicts orders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regularity {
    /// The solution lies in `H^s` for every `s` below this number.
    pub sobolev: f64,
    /// Gap and multiplier do not vanish together on a set of positive measure.
    pub strictly_complementary: bool,
}

/// A named inequality on a domain.
pub struct Scene<const D: usize> {
    /// The name users type.
    pub name: String,
    /// One line for lists.
    pub summary: &'static str,
    /// The built-in domain.
    pub domain: BoxDomain<D>,
    /// The data.
    pub problem: Problem<D>,
    /// What is known of the solution's regularity.
    pub regularity: Regularity,
}

/// Parameters a scene may take from the user. None is ignored silently: [`Entry::make`] refuses
/// what [`Entry::takes`] does not list.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parameters {
    /// Length scale of the domain.
    pub scale: Option<f64>,
    /// Ratio of coefficients.
    pub contrast: Option<f64>,
    /// Size of the load.
    pub load: Option<f64>,
}
