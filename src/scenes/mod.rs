//! The catalogue: named inequalities, most with an exact solution.
//!
//! A scene is one function in one file that returns a [`Scene`]; the derivation of its solution
//! stands in its doc comment. It is registered by one line in [`catalogue`].

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
    pub fn side(mut self, axis: usize, end: usize, part: BoundaryPart) -> Self {
        self.sides[axis][end] = part;
        self
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

/// Parameters a scene may take from the user; a scene without them ignores none silently: see
/// [`Entry::takes`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parameters {
    /// Length scale of the domain.
    pub scale: Option<f64>,
    /// Ratio of coefficients.
    pub contrast: Option<f64>,
    /// Size of the load.
    pub load: Option<f64>,
}
