//! Families of quadrature rules.

use std::fmt::Debug;

use super::rule::Rule;

/// A family of quadrature rules on simplices: which rule integrates data of a given degree.
///
/// A family of one's own is a type with these two functions; its rules come from
/// [`Rule::from_points`]. [`check_quadrature`](crate::kit::check_quadrature) tests its rules.
pub trait Quadrature: Debug + Send + Sync {
    /// The name of the family.
    fn name(&self) -> &str;
    /// The rule on the simplex of this dimension that is exact for polynomials of this degree. A family
    /// of another purpose, as [`VertexRule`], states what its rules are exact for.
    ///
    /// # Errors
    /// [`QuadratureError`] if the family has no such rule.
    fn rule(&self, dimension: usize, degree: usize) -> Result<Rule, QuadratureError>;
}

/// Why there is no rule.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QuadratureError {
    /// A family has no rule of a degree.
    #[error(
        "quadrature family {family} has no rule of degree {degree} in dimension {dimension}: ask for degree {largest} at most, or choose another family"
    )]
    NoRule {
        /// Name of the family.
        family: String,
        /// Dimension of the simplex.
        dimension: usize,
        /// The degree asked for.
        degree: usize,
        /// The largest degree of a rule that the family has in this dimension.
        largest: usize,
    },
    /// The numbers of points and weights differ, or there are none.
    #[error("{points} points have {weights} weights: a rule has one weight for each point")]
    Lengths {
        /// Number of points.
        points: usize,
        /// Number of weights.
        weights: usize,
    },
    /// A number of a rule is not finite, barycentric coordinates of a point do not sum to one, or
    /// entries beyond the dimension are not zero.
    #[error(
        "point {point} with weight {weight} and coordinates {coordinates:?} is none of a rule in dimension {dimension}: barycentric coordinates are finite and sum to one, entries beyond the dimension are zero, weights are finite"
    )]
    Point {
        /// Number of the point.
        point: usize,
        /// Its coordinates.
        coordinates: [f64; 4],
        /// Its weight.
        weight: f64,
        /// Dimension of the simplex.
        dimension: usize,
    },
    /// The weights do not sum to one.
    #[error("the weights of a rule sum to {sum}: divide them by their sum")]
    Weights {
        /// Their sum.
        sum: f64,
    },
}

/// The rules of [`Rule::new`]: few points on the medians for degrees up to two, above conical products
/// of Gauss-Jacobi rules; of every degree, with positive weights and points inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConicalProduct;

impl Quadrature for ConicalProduct {
    fn name(&self) -> &str {
        "conical"
    }
    fn rule(&self, dimension: usize, degree: usize) -> Result<Rule, QuadratureError> {
        Ok(Rule::new(dimension, degree))
    }
}

/// The rule with the vertices of the simplex as points and equal weights, whatever the degree asked
/// for; it is exact for degree one.
///
/// For a reaction term with P1 it is mass lumping: the reaction matrix is diagonal, so that the
/// matrix of a mesh without obtuse angles (in the plane of a Delaunay mesh) is an M-matrix for every
/// reaction that is not negative.
///
/// Source: V. Thomée, Galerkin Finite Element Methods for Parabolic Problems, 2nd ed., 2006, chapter 15.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VertexRule;

impl Quadrature for VertexRule {
    fn name(&self) -> &str {
        "vertices"
    }
    fn rule(&self, dimension: usize, _: usize) -> Result<Rule, QuadratureError> {
        let vertex = |k: usize| std::array::from_fn(|i| f64::from(u8::from(i == k)));
        let n = dimension + 1;
        Ok(Rule { points: (0..n).map(vertex).collect(), weights: vec![1.0 / n as f64; n] })
    }
}
