//! Linear Lagrange elements.

use super::basis::Basis;
use super::broken::Broken;
use super::crouzeix_raviart::CrouzeixRaviart;
use super::node::Node;
use super::reference_element::{ElementVisitor, Layout, ReferenceElement};

/// Continuous piecewise linears: the basis functions are the barycentric coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub struct P1;

impl<const D: usize> ReferenceElement<D> for P1 {
    const N: usize = D + 1;
    const DEGREE: usize = 1;
    const LAYOUT: Layout = Layout { vertex: 1, edge: 0, facet: 0, cell: 0 };

    #[inline(always)]
    fn values(lambda: &[f64], out: &mut [f64]) {
        out[..=D].copy_from_slice(&lambda[..=D]);
    }
    #[inline(always)]
    fn derivatives(_: &[f64], out: &mut [[f64; 4]]) {
        for (i, row) in out[..=D].iter_mut().enumerate() {
            *row = [0.0; 4];
            row[i] = 1.0;
        }
    }
    fn node(i: usize) -> Node {
        Node::vertex(i)
    }
    fn broken_in_basis<V: ElementVisitor<D>>(basis: Basis, visitor: V) -> Option<V::Output> {
        (basis == Basis::FacetMeans).then(|| visitor.visit::<Broken<CrouzeixRaviart>>())
    }
}
