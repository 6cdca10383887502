//! Evaluation of the data and the exact solution of a scene, and their scales.

use super::violation::Violation;
use crate::problem::{Exact, Problem};
use crate::real::Point;

/// Distance to an obstacle that counts as contact, relative to the value.
pub(super) const TOUCHING: f64 = 1e-8;

/// Largest absolute values at the sample points; tolerances are multiples of them.
#[derive(Clone, Copy)]
pub(super) struct Scales {
    /// Shortest side of the domain, or radius of a disc.
    pub length: f64,
    /// Largest value.
    pub value: f64,
    /// Largest gradient, or largest value over the length if that is larger.
    pub slope: f64,
    /// Largest `alpha grad u`, or largest coefficient times value over the length if that is larger.
    pub flux: f64,
    /// The largest of load, reaction times value, and flux over length.
    pub force: f64,
}

impl Scales {
    /// Scales of none, to be compared with others.
    pub const NONE: Self = Self { length: 0.0, value: 0.0, slope: 0.0, flux: 0.0, force: 0.0 };
    /// The larger ones of each.
    pub fn max(self, other: Self) -> Self {
        Self {
            length: self.length.max(other.length),
            value: self.value.max(other.value),
            slope: self.slope.max(other.slope),
            flux: self.flux.max(other.flux),
            force: self.force.max(other.force),
        }
    }
}

/// A problem with its exact solution and scales.
pub(super) struct Evaluator<'a, const D: usize> {
    /// The name of the scene.
    pub name: &'a str,
    pub problem: &'a Problem<D>,
    pub exact: &'a Exact<D>,
    pub scales: Scales,
}

impl<'a, const D: usize> Evaluator<'a, D> {
    /// With the scales at these points of a domain of this length.
    pub fn new(
        name: &'a str,
        (problem, exact): (&'a Problem<D>, &'a Exact<D>),
        length: f64,
        points: &[Point<D>],
    ) -> Self {
        let scales = Scales { length, value: 0.0, slope: 0.0, flux: 0.0, force: 0.0 };
        let mut evaluator = Self { name, problem, exact, scales };
        let largest = |size: &dyn Fn(&Point<D>) -> f64| {
            points.iter().map(|x| size(x).abs()).fold(0.0, f64::max)
        };
        let coefficient = largest(&|x| evaluator.coefficient(x));
        let value = largest(&|x| evaluator.value(x));
        let slope = largest(&|x| evaluator.gradient(x).norm()).max(value / length);
        let flux = largest(&|x| evaluator.flux(x).norm()).max(coefficient * value / length);
        let force = largest(&|x| evaluator.source(x))
            .max(largest(&|x| evaluator.reaction(x) * evaluator.value(x)))
            .max(flux / length);
        evaluator.scales = Scales { length, value, slope, flux, force };
        evaluator
    }
    pub fn value(&self, x: &Point<D>) -> f64 {
        self.exact.value.at(x)
    }
    pub fn gradient(&self, x: &Point<D>) -> Point<D> {
        (self.exact.gradient)(x)
    }
    pub fn coefficient(&self, x: &Point<D>) -> f64 {
        self.problem.coefficient.everywhere.as_ref().map_or(1.0, |alpha| alpha.at(x))
    }
    /// `alpha T grad u` with the tensor `T`.
    pub fn flux(&self, x: &Point<D>) -> Point<D> {
        let gradient = self.gradient(x) * self.coefficient(x);
        self.problem.tensor.everywhere.as_ref().map_or(gradient, |tensor| tensor.at(x) * gradient)
    }
    pub fn source(&self, x: &Point<D>) -> f64 {
        self.problem.source.everywhere.as_ref().map_or(0.0, |f| f.at(x))
    }
    pub fn reaction(&self, x: &Point<D>) -> f64 {
        self.problem.reaction.everywhere.as_ref().map_or(0.0, |c| c.at(x))
    }
    /// `u - psi_lower`, infinite without obstacle.
    pub fn above_lower(&self, x: &Point<D>) -> f64 {
        self.problem
            .lower
            .everywhere
            .as_ref()
            .map_or(f64::INFINITY, |psi| self.value(x) - psi.at(x))
    }
    /// `psi_upper - u`, infinite without obstacle.
    pub fn below_upper(&self, x: &Point<D>) -> f64 {
        self.problem
            .upper
            .everywhere
            .as_ref()
            .map_or(f64::INFINITY, |psi| psi.at(x) - self.value(x))
    }
    /// A violation unless `by <= allowed`; a violation if `by` is not a number.
    pub fn require(
        &self,
        condition: &str,
        at: &Point<D>,
        by: f64,
        allowed: f64,
    ) -> Result<(), Violation> {
        if by <= allowed {
            Ok(())
        } else {
            Err(Violation::new(self.name, condition, at, by, allowed))
        }
    }
}
