//! A scheme with its bounds on facet means.

use super::{DirichletBy, ExpectedOrders, Scheme, Setting};
use crate::element::{Broken, CrouzeixRaviart, P1};
use crate::mesh::Mesh;
use crate::real::Real;

/// A scheme on broken linears, written in the basis of facet means, so that bounds on these means
/// bind single unknowns.
///
/// Space, form and Dirichlet data are those of the scheme inside; only the constraint set differs.
/// No order is proven for this set under an inequality; it is measured. For WOPSIP the matrix in this
/// basis has no positive entry off the diagonal on non-obtuse meshes.
#[derive(Clone, Copy, Debug, Default)]
pub struct FacetMeans<S>(pub S);

impl<T: Real, const D: usize, S> Scheme<T, D> for FacetMeans<S>
where
    S: Scheme<T, D, Element = Broken<P1>>,
{
    type Element = Broken<CrouzeixRaviart>;
    type Facet = S::Facet;
    const DIRICHLET: DirichletBy = S::DIRICHLET;
    const CONSISTENT: bool = S::CONSISTENT;

    fn name(&self) -> &str {
        self.0.name()
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
