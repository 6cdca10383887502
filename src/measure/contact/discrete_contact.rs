//! The discrete contact set.

use crate::mesh::HalfFacet;

/// The discrete contact set and multiplier, in terms that do not depend on the unknowns of a
/// scheme.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct DiscreteContact {
    /// Cells in contact with an obstacle as a whole.
    pub cells: Vec<usize>,
    /// Facets of the contact boundary in contact as a whole: cell, and number in the cell.
    pub facets: Vec<HalfFacet>,
    /// Density of the multiplier at every vertex: the nodal multiplier over the integral of the hat
    /// function of the vertex, over the domain or the contact boundary. None where there is no such
    /// integral, on the Dirichlet boundary and where rounding leaves no digit; empty without a constraint.
    pub density: Vec<Option<f64>>,
}
