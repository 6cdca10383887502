//! A scheme with its bounds at midpoints of edges.

use super::{BoundedNodes, DirichletBy, ExpectedOrders, Scheme, Setting};
use crate::mesh::Mesh;
use crate::real::Real;

/// A scheme on quadratics that imposes an obstacle at the midpoints of edges only, and a Signorini
/// condition at the nodes that carry the mean over a facet: midpoints in three dimensions, vertices
/// too in two, the vertex in one. Other elements have no such nodes: with them an inequality is
/// refused.
///
/// Space, form and Dirichlet data are those of the scheme inside; only the constraint set differs.
/// Its orders are proven for obstacles in two dimensions, where the mean over a triangle is that of
/// the three midpoints (F. Brezzi, W. W. Hager, P.-A. Raviart, Numer. Math. 28 (1977), 431-443;
/// L.-H. Wang, Numer. Math. 92 (2002), 771-778), and for Signorini conditions in one and two, where
/// this is the set of all nodes. Other orders under an inequality are measured: in one dimension it
/// is one, because nothing binds the ends of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoints<S>(pub S);

impl<T: Real, const D: usize, S: Scheme<T, D>> Scheme<T, D> for Midpoints<S> {
    type Element = S::Element;
    type Facet = S::Facet;
    const DIRICHLET: DirichletBy = S::DIRICHLET;
    const CONSISTENT: bool = S::CONSISTENT;

    fn name(&self) -> &str {
        self.0.name()
    }
    fn bounded_nodes(&self) -> BoundedNodes {
        BoundedNodes::Midpoints
    }
    fn facet(&self, mesh: &Mesh<T, D>) -> S::Facet {
        self.0.facet(mesh)
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        midpoint_orders(setting, || self.0.expected_orders(setting))
    }
}

/// The orders of a scheme that remain proven if it binds midpoints only.
fn midpoint_orders(setting: &Setting, at_all_nodes: impl Fn() -> ExpectedOrders) -> ExpectedOrders {
    let obstacle = setting.obstacle && setting.dimension != 2;
    let contact = setting.contact && setting.dimension == 3;
    if obstacle || contact { ExpectedOrders::default() } else { at_all_nodes() }
}
