//! Other bases of a broken space.

/// A basis of a broken polynomial space, by the functionals that it has among its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Basis {
    /// The means over the facets of the cell.
    FacetMeans,
    /// The mean over the cell.
    CellMean,
}
