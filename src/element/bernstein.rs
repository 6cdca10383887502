//! Quadratics in the Bernstein basis.

use super::definition::{Element, Layout};
use super::node::Node;
use crate::mesh::edge_vertices;

/// Continuous piecewise quadratics by their Bernstein coefficients: at vertices the values, on edges
/// `2 u(m) - (u(a) + u(b)) / 2` with the ends `a`, `b` and the midpoint `m`, in the order of [`Layout::edge`].
///
/// Basis `l_i^2` and `2 l_i l_j`, with `l` the barycentric coordinates. It is not negative and sums to one, so that
/// a function lies between its least and its largest coefficient.
///
/// The space is that of [`P2`](super::P2).
#[derive(Clone, Copy, Debug, Default)]
pub struct BernsteinP2;

impl<const D: usize> Element<D> for BernsteinP2 {
    fn degree(&self) -> usize {
        2
    }
    fn layout(&self) -> Layout {
        Layout { vertex: 1, edge: 1, facet: 0, cell: 0 }
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        for (value, &l) in out[..=D].iter_mut().zip(lambda) {
            *value = l * l;
        }
        for (value, &[i, j]) in out[D + 1..].iter_mut().zip(edge_vertices(D)) {
            *value = 2.0 * lambda[i] * lambda[j];
        }
    }
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]) {
        for (i, row) in out[..=D].iter_mut().enumerate() {
            *row = [0.0; 4];
            row[i] = 2.0 * lambda[i];
        }
        for (row, &[i, j]) in out[D + 1..].iter_mut().zip(edge_vertices(D)) {
            *row = [0.0; 4];
            row[i] = 2.0 * lambda[j];
            row[j] = 2.0 * lambda[i];
        }
    }
    fn node(&self, i: usize) -> Node {
        match i.checked_sub(D + 1) {
            None => Node::coefficient_of_vertex(i),
            Some(edge) => Node::coefficient_of_edge(edge),
        }
    }
}
