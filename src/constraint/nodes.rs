//! Bounds at all nodes.

use super::constraint_set::{BoundBy, ConstraintSet};
use crate::element::{Entity, Node};
use crate::theory::Setting;

/// Every [`Node`] of the element is bound: the set in force where nothing else is said.
///
/// Obstacles bind values at points, and a facet mean by the obstacle at the barycentre of the facet. Reports call the
/// set `vertices` or `facet-means` where the element has no other nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Nodes;

impl ConstraintSet for Nodes {
    fn name(&self) -> &str {
        "nodes"
    }
    fn name_on(&self, nodes: &[Node]) -> &str {
        if nodes.iter().all(|node| matches!(node.entity(), Entity::Vertex(_))) {
            "vertices"
        } else if nodes.iter().all(Node::is_facet_mean) {
            "facet-means"
        } else {
            self.name()
        }
    }
    fn in_domain(&self, node: &Node, _: usize) -> Option<BoundBy> {
        Some(if node.is_facet_mean() { BoundBy::Value } else { BoundBy::Functional })
    }
    fn keeps_orders(&self, _: &Setting) -> bool {
        true
    }
}
