//! The contact set that a scheme found.

/// The contact set that a scheme found, in terms that do not depend on its unknowns.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FoundContact {
    /// Cells in contact with an obstacle as a whole.
    pub cells: Vec<usize>,
    /// Facets of the contact boundary in contact as a whole: cell, and number in the cell.
    pub facets: Vec<(usize, usize)>,
    /// The multiplier at every vertex: the force there over the integral of the vertex's hat
    /// function, over the domain or the contact boundary. None where there is no such integral and
    /// on the Dirichlet part; empty without a constraint.
    pub density: Vec<Option<f64>>,
}
