//! Constraint sets: which of an element's unknowns an inequality binds.

use crate::element::{Entity, Node};

/// The constraint set of a scheme: at which nodes of its element the inequality is imposed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoundedNodes {
    /// At every node.
    #[default]
    All,
    /// Of the domain at the midpoints of edges only. Of a contact boundary at the nodes that carry
    /// the mean over a facet, which are midpoints in three dimensions, but vertices too in two
    /// (Simpson's rule) and the vertex itself in one: with midpoints alone the order in the energy
    /// norm is one half, as was measured.
    Midpoints,
    /// On the means over cells only. There is none on the boundary, so that no Signorini condition
    /// can be imposed.
    CellMeans,
}

impl BoundedNodes {
    /// Whether an obstacle binds the unknown of this node.
    pub fn in_domain(self, node: &Node) -> bool {
        match self {
            Self::All => true,
            Self::Midpoints => node.is_midpoint(),
            Self::CellMeans => node.is_mean() && node.entity() == Entity::Cell,
        }
    }
    /// Whether a Signorini condition binds the unknown of this node, which lies on the facet.
    pub fn on_contact(self, node: &Node, dimension: usize) -> bool {
        match self {
            Self::All => true,
            Self::Midpoints => {
                let is_vertex = matches!(node.entity(), Entity::Vertex(_));
                node.is_midpoint() || (dimension < 3 && is_vertex)
            }
            Self::CellMeans => false,
        }
    }
    /// The name of the set for an element of this degree that begins with this node.
    pub fn name(self, degree: usize, first: &Node) -> &'static str {
        match self {
            Self::Midpoints => "midpoints",
            Self::CellMeans => "cell-means",
            Self::All if first.is_mean() => "facet-means",
            Self::All if degree == 1 => "vertices",
            Self::All => "nodes",
        }
    }
}
