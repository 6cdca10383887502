//! Degrees of the quadrature rules for data.

/// Degrees of the quadrature rules for data, beyond what the forms need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DataQuadrature {
    /// Degree of the cell rule for loads that vary.
    pub cell: usize,
    /// Degree of the facet rule for Dirichlet and Neumann data.
    pub facet: usize,
}

impl Default for DataQuadrature {
    /// Loads to degree 5, which leaves an error of higher order than linear and quadratic elements
    /// have; boundary data to degree 15, because there are few boundary facets and the weak
    /// Dirichlet data of an over-penalised scheme weigh much.
    fn default() -> Self {
        Self { cell: 5, facet: 15 }
    }
}
