//! Constraint sets by name.

use std::sync::Arc;

use super::bernstein::Bernstein;
use super::constraint_set::ConstraintSet;
use super::facet_means::FacetMeans;
use super::midpoints::Midpoints;
use super::nodes::Nodes;

/// The constraint sets of the library by the names users type, with one line each. On linear
/// elements nodes are vertices; both names are the same set.
pub const CONSTRAINT_SETS: [(&str, &str); 5] = [
    ("vertices", "values at vertices (linear elements), all nodes (quadratic ones)"),
    ("nodes", "all nodes of the element: vertices for linear elements"),
    ("facet-means", "means over facets (discontinuous schemes on linears)"),
    ("midpoints", "midpoints of edges only (schemes on quadratics)"),
    ("bernstein", "Bernstein coefficients: bounds hold at every point (schemes on quadratics)"),
];

/// The constraint set of this name.
pub fn constraint_set_by_name(name: &str) -> Option<Arc<dyn ConstraintSet>> {
    match name {
        "vertices" | "nodes" => Some(Arc::new(Nodes)),
        "facet-means" => Some(Arc::new(FacetMeans)),
        "midpoints" => Some(Arc::new(Midpoints)),
        "bernstein" => Some(Arc::new(Bernstein)),
        _ => None,
    }
}
