//! Linear Lagrange elements.

use std::sync::Arc;

use super::basis::Basis;
use super::broken::Broken;
use super::crouzeix_raviart::CrouzeixRaviart;
use super::definition::{Element, Layout};
use super::node::Node;

/// Continuous piecewise linears: the basis functions are the barycentric coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub struct P1;

impl<const D: usize> Element<D> for P1 {
    fn degree(&self) -> usize {
        1
    }
    fn layout(&self) -> Layout {
        Layout { vertex: 1, edge: 0, facet: 0, cell: 0 }
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        out[..=D].copy_from_slice(&lambda[..=D]);
    }
    fn derivatives(&self, _: &[f64], out: &mut [[f64; 4]]) {
        for (i, row) in out[..=D].iter_mut().enumerate() {
            *row = [0.0; 4];
            row[i] = 1.0;
        }
    }
    fn node(&self, i: usize) -> Node {
        Node::vertex(i)
    }
    fn in_basis(&self, basis: Basis, is_broken: bool) -> Option<Arc<dyn Element<D>>> {
        let has_means = basis == Basis::FacetMeans && is_broken;
        has_means.then(|| Arc::new(Broken(CrouzeixRaviart)) as _)
    }
}
