//! Linear Lagrange elements.

use super::basis::Basis;
use super::broken::Broken;
use super::crouzeix_raviart::CrouzeixRaviart;
use super::node::Node;
use super::reference_element::{ElementVisitor, Layout, ReferenceElement};
use crate::real::Real;

/// Continuous piecewise linears: the basis functions are the barycentric coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub struct P1;

impl<T: Real, const D: usize> ReferenceElement<T, D> for P1 {
    const N: usize = D + 1;
    const DEGREE: usize = 1;
    const LAYOUT: Layout = Layout { vertex: 1, edge: 0, facet: 0, cell: 0 };
    const COMPILED: bool = true;

    #[inline(always)]
    fn values(lambda: &[T], out: &mut [T]) {
        out[..=D].copy_from_slice(&lambda[..=D]);
    }
    #[inline(always)]
    fn derivatives(_: &[T], out: &mut [[T; 4]]) {
        for (i, row) in out[..=D].iter_mut().enumerate() {
            *row = [T::lit(0.0); 4];
            row[i] = T::lit(1.0);
        }
    }
    fn node(i: usize) -> Node {
        Node::vertex(i)
    }
    fn broken_in_basis<V: ElementVisitor<T, D>>(basis: Basis, visitor: V) -> Option<V::Output> {
        (basis == Basis::FacetMeans).then(|| visitor.visit::<Broken<CrouzeixRaviart>>())
    }
}
