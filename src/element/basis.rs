//! Other bases of a space of polynomials.

/// A basis of polynomials on each cell, by the functionals that it has among its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Basis {
    /// The means over the facets of the cell.
    FacetMeans,
    /// The coefficients in the basis of Bernstein.
    Bernstein,
}
