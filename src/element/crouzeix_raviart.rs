//! The Crouzeix-Raviart element.

use super::definition::{Element, Layout};
use super::node::Node;

/// Piecewise linears with continuous means over facets.
///
/// Basis `phi_i = 1 - D lambda_i`: its mean is one over the facet opposite vertex `i` and zero over
/// the others. In one dimension this is P1 with the two unknowns exchanged.
///
/// Source: M. Crouzeix, P.-A. Raviart, RAIRO 7 (1973), 33-75.
#[derive(Clone, Copy, Debug, Default)]
pub struct CrouzeixRaviart;

impl<const D: usize> Element<D> for CrouzeixRaviart {
    fn degree(&self) -> usize {
        1
    }
    fn layout(&self) -> Layout {
        Layout { vertex: 0, edge: 0, facet: 1, cell: 0 }
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        for (value, &l) in out[..=D].iter_mut().zip(lambda) {
            *value = 1.0 - (D as f64) * l;
        }
    }
    fn derivatives(&self, _: &[f64], out: &mut [[f64; 4]]) {
        for (i, row) in out[..=D].iter_mut().enumerate() {
            *row = [0.0; 4];
            row[i] = -(D as f64);
        }
    }
    fn node(&self, i: usize) -> Node {
        Node::facet_mean(i)
    }
}
