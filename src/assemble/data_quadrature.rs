//! The quadrature rules for data.

use crate::quadrature::{ConicalProduct, Quadrature};

/// The quadrature rules for data: degrees, and families of rules. Integrals of the basis alone are
/// exact whatever the rules for data.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct DataQuadrature {
    /// Degree of the cell rule for loads and reactions that vary. Where absent it is `k + b + 3` for an
    /// element that contains the polynomials of degree `k` and has basis functions of degree `b`: five
    /// for linears, seven for quadratics. It is at least `k + b - 1`, below which the rule would limit the
    /// orders.
    pub cell: Option<usize>,
    /// Degree of the facet rule for Dirichlet, Neumann and Robin data, and for the Robin term of the matrix.
    pub facet: usize,
    /// The family of the rules for loads, Dirichlet and Neumann data and means of data.
    pub family: &'static dyn Quadrature,
    /// The family of the rule for the reaction term. It is asked for the degree of products of basis
    /// functions, or for that of the cell rule where this is larger and the reaction varies. With
    /// [`VertexRule`](crate::quadrature::VertexRule) the term is lumped.
    pub reaction: &'static dyn Quadrature,
}

impl Default for DataQuadrature {
    /// Loads to the degree `k + b + 3`, with which doubling the degree changes the errors of linear and
    /// quadratic elements on smooth loads by less than a thousandth on the coarsest meshes;
    /// boundary data to degree 15, because there are few boundary facets and the weak
    /// Dirichlet data of an over-penalised scheme weigh much; all by [`ConicalProduct`].
    fn default() -> Self {
        Self { cell: None, facet: 15, family: &ConicalProduct, reaction: &ConicalProduct }
    }
}

/// Setters, one for each field.
impl DataQuadrature {
    /// Sets the degree of the cell rule.
    #[must_use]
    pub fn cell(self, degree: usize) -> Self {
        Self { cell: Some(degree), ..self }
    }
    /// Sets the degree of the facet rule.
    #[must_use]
    pub fn facet(self, degree: usize) -> Self {
        Self { facet: degree, ..self }
    }
    /// Sets the family of the rules for loads, Dirichlet and Neumann data and means of data.
    #[must_use]
    pub fn family(self, family: &'static dyn Quadrature) -> Self {
        Self { family, ..self }
    }
    /// Sets the family of the rule for the reaction term.
    #[must_use]
    pub fn reaction(self, reaction: &'static dyn Quadrature) -> Self {
        Self { reaction, ..self }
    }
}
