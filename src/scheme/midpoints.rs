//! The same scheme with its bounds at midpoints of edges.

use super::{BoundedNodes, DirichletBy, Scheme, Setting};
use crate::mesh::Mesh;
use crate::real::Real;
use crate::study::ExpectedOrders;

/// A scheme on quadratics that imposes the inequality at the midpoints of edges only, of a contact
/// boundary in one dimension at its vertices. For other elements, which have no such nodes, an
/// inequality is refused.
///
/// Space, form and Dirichlet data are those of the scheme inside; only the constraint set differs.
/// Its orders are proven for obstacles in two dimensions, where the mean over a triangle is that of
/// the three midpoints (F. Brezzi, W. W. Hager, P.-A. Raviart, Numer. Math. 28 (1977), 431-443;
/// L.-H. Wang, Numer. Math. 92 (2002), 771-778). All other orders under an inequality are measured.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoints<S>(pub S);

impl<T: Real, const D: usize, S: Scheme<T, D>> Scheme<T, D> for Midpoints<S> {
    type Element = S::Element;
    type Facet = S::Facet;
    const DIRICHLET: DirichletBy = S::DIRICHLET;
    const BOUNDED: BoundedNodes = BoundedNodes::Midpoints;

    fn name(&self) -> &str {
        self.0.name()
    }
    fn facet(&self, mesh: &Mesh<T, D>) -> S::Facet {
        self.0.facet(mesh)
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        if setting.contact || (setting.obstacle && setting.dimension != 2) {
            return ExpectedOrders::default();
        }
        self.0.expected_orders(setting)
    }
}
