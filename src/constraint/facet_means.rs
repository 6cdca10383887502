//! Bounds on facet means.

use super::constraint_set::{BoundBy, ConstraintSet};
use crate::element::{Basis, Node};

/// The means over the facets of each cell are bound: by an obstacle at the barycentre of the facet,
/// by a Signorini condition against the mean of the gap.
///
/// Broken linears change to the basis of Crouzeix and Raviart; space, form and Dirichlet data stay.
/// No order is proven for broken linears with this set under an inequality; it is measured. The
/// matrix of WOPSIP in this basis has no positive entry off the diagonal on non-obtuse meshes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FacetMeans;

impl ConstraintSet for FacetMeans {
    fn name(&self) -> &str {
        "facet-means"
    }
    fn basis(&self) -> Option<Basis> {
        Some(Basis::FacetMeans)
    }
    fn in_domain(&self, node: &Node, _: usize) -> Option<BoundBy> {
        node.is_facet_mean().then_some(BoundBy::Value)
    }
}
