//! Bounds at all nodes.

use super::constraint_set::{BoundBy, ConstraintSet};
use crate::element::Node;
use crate::theory::Setting;

/// Every unknown of the element is bound: the set in force where nothing else is said.
///
/// Obstacles bind values at points, a facet mean by the obstacle at the barycentre of the facet, a
/// cell mean by the mean of the obstacle. Reports call the set `vertices` or `facet-means` where the
/// element has no other nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Nodes;

impl ConstraintSet for Nodes {
    fn name(&self) -> &str {
        "nodes"
    }
    fn name_on(&self, nodes: &[Node]) -> &str {
        if nodes.iter().all(|node| matches!(node, Node::Vertex(_))) {
            "vertices"
        } else if nodes.iter().all(|node| matches!(node, Node::FacetMean(_))) {
            "facet-means"
        } else {
            self.name()
        }
    }
    fn in_domain(&self, node: &Node, _: usize) -> Option<BoundBy> {
        Some(if let Node::CellMean = node { BoundBy::Mean } else { BoundBy::Value })
    }
    fn keeps_orders(&self, _: &Setting) -> bool {
        true
    }
}
