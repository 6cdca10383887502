//! Bounds on cell means.

use super::constraint_set::{BoundBy, ConstraintSet};
use crate::element::{Basis, Entity, Node};

/// The mean over each cell is bound by the mean of the obstacle, and nothing else is.
///
/// Broken quadratics change to a basis that has the mean among its unknowns; space, form and
/// Dirichlet data stay. No order is proven for this set under an inequality; it is measured. A
/// Signorini condition is refused: no mean over a cell lies on the boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellMeans;

impl ConstraintSet for CellMeans {
    fn name(&self) -> &str {
        "cell-means"
    }
    fn basis(&self) -> Option<Basis> {
        Some(Basis::CellMean)
    }
    fn in_domain(&self, node: &Node, _: usize) -> Option<BoundBy> {
        (node.is_mean() && node.entity() == Entity::Cell).then_some(BoundBy::Functional)
    }
}
