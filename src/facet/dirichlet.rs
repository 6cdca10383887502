//! The two ways to impose Dirichlet data.

/// How a scheme imposes Dirichlet data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirichletBy {
    /// Unknowns on the Dirichlet boundary are fixed at the data.
    Pinning,
    /// The facet form acts on Dirichlet facets, with the data in place of the other side.
    FacetForm,
}
