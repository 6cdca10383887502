//! Quadratic Lagrange elements.

use std::sync::Arc;

use super::basis::Basis;
use super::bernstein::BernsteinP2;
use super::broken::Broken;
use super::definition::{Element, Layout};
use super::node::Node;
use crate::mesh::edge_vertices;

/// Continuous piecewise quadratics: the values at the vertices, then those at the midpoints of the
/// edges in the order of [`Layout::edge`].
///
/// Basis `l_i (2 l_i - 1)` and `4 l_i l_j`, with `l` the barycentric coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub struct P2;

impl<const D: usize> Element<D> for P2 {
    fn degree(&self) -> usize {
        2
    }
    fn layout(&self) -> Layout {
        Layout { vertex: 1, edge: 1, facet: 0, cell: 0 }
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        for (value, &l) in out[..=D].iter_mut().zip(lambda) {
            *value = l * (2.0 * l - 1.0);
        }
        for (value, &[i, j]) in out[D + 1..].iter_mut().zip(edge_vertices(D)) {
            *value = 4.0 * lambda[i] * lambda[j];
        }
    }
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]) {
        for (i, row) in out[..=D].iter_mut().enumerate() {
            *row = [0.0; 4];
            row[i] = 4.0 * lambda[i] - 1.0;
        }
        for (row, &[i, j]) in out[D + 1..].iter_mut().zip(edge_vertices(D)) {
            *row = [0.0; 4];
            row[i] = 4.0 * lambda[j];
            row[j] = 4.0 * lambda[i];
        }
    }
    fn node(&self, i: usize) -> Node {
        if i <= D { Node::vertex(i) } else { Node::midpoint(i - D - 1) }
    }
    fn in_basis(&self, basis: Basis, is_broken: bool) -> Option<Arc<dyn Element<D>>> {
        match (basis, is_broken) {
            (Basis::Bernstein, true) => Some(Arc::new(Broken(BernsteinP2))),
            (Basis::Bernstein, false) => Some(Arc::new(BernsteinP2)),
            _ => None,
        }
    }
}
