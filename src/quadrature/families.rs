//! Families of quadrature rules.

use std::fmt::Debug;

use super::error::QuadratureError;
use super::rule::{Rule, check_dimension, vertex_point};

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

/// The rules of [`Rule::new`]: few points on the medians for degrees up to two, above conical products
/// of Gauss-Jacobi rules; of every degree up to [`Rule::LARGEST_DEGREE`], with positive weights and points inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConicalProduct;

impl Quadrature for ConicalProduct {
    fn name(&self) -> &str {
        "conical"
    }
    fn rule(&self, dimension: usize, degree: usize) -> Result<Rule, QuadratureError> {
        Rule::of_family(self.name(), dimension, degree)
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
        check_dimension(dimension)?;
        let n = dimension + 1;
        Ok(Rule { points: (0..n).map(vertex_point).collect(), weights: vec![1.0 / n as f64; n] })
    }
}
