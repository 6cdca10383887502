//! A scheme with its bounds on cell means.

use super::{BoundedNodes, DirichletBy, ExpectedOrders, Scheme, Setting};
use crate::element::{Broken, P2, QuadraticCellMean};
use crate::mesh::Mesh;
use crate::real::Real;

/// A scheme on broken quadratics, written in a basis that has the mean over the cell among its
/// unknowns, so that a bound on the mean binds a single one; no other is bound. A mean must not pass
/// the mean of the obstacle.
///
/// Space, form and Dirichlet data are those of the scheme inside; only the constraint set differs.
/// No order is proven for this set under an inequality; it is measured. A Signorini condition is
/// refused: no mean over a cell lives on the boundary.
#[derive(Clone, Copy, Debug, Default)]
pub struct CellMeans<S>(pub S);

impl<T: Real, const D: usize, S> Scheme<T, D> for CellMeans<S>
where
    S: Scheme<T, D, Element = Broken<P2>>,
{
    type Element = QuadraticCellMean;
    type Facet = S::Facet;
    const DIRICHLET: DirichletBy = S::DIRICHLET;
    const CONSISTENT: bool = S::CONSISTENT;

    fn name(&self) -> &str {
        self.0.name()
    }
    fn bounded_nodes(&self) -> BoundedNodes {
        BoundedNodes::CellMeans
    }
    fn facet(&self, mesh: &Mesh<T, D>) -> S::Facet {
        self.0.facet(mesh)
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        if setting.is_linear() {
            self.0.expected_orders(setting)
        } else {
            ExpectedOrders::default()
        }
    }
}
