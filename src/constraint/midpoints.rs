//! Bounds at midpoints of edges.

use super::constraint_set::{BoundBy, ConstraintSet};
use crate::element::{Entity, Node};
use crate::theory::Setting;

/// An obstacle binds the midpoints of edges only. A Signorini condition binds the nodes that carry
/// the mean over a facet: midpoints in three dimensions, vertices too in two (Simpson's rule), the
/// vertex in one; with midpoints alone the order in the energy norm is one half, as was measured.
///
/// For quadratics with bounds at all nodes, orders are proven; with this set they remain so for
/// obstacles in two dimensions, where the mean over a triangle is that of the three midpoints
/// (F. Brezzi, W. W. Hager, P.-A. Raviart, Numer. Math. 28 (1977), 431-443; L.-H. Wang, Numer. Math.
/// 92 (2002), 771-778), and for Signorini conditions in one and two, where this is the set of all
/// nodes. Other orders under an inequality are measured: in one dimension it is one, because nothing
/// binds the ends of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Midpoints;

impl ConstraintSet for Midpoints {
    fn name(&self) -> &str {
        "midpoints"
    }
    fn in_domain(&self, node: &Node, _: usize) -> Option<BoundBy> {
        node.is_midpoint().then_some(BoundBy::Value)
    }
    fn on_contact(&self, node: &Node, dimension: usize) -> Option<BoundBy> {
        let is_vertex = matches!(node.entity(), Entity::Vertex(_));
        (node.is_midpoint() || (dimension < 3 && is_vertex)).then_some(BoundBy::Functional)
    }
    fn keeps_orders(&self, setting: &Setting) -> bool {
        !(setting.obstacle && setting.dimension != 2 || setting.contact && setting.dimension == 3)
    }
}
