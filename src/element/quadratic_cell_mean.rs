//! Quadratics in a basis that has the mean over the cell among its unknowns.

use super::definition::{Element, Layout};
use super::node::Node;

/// Discontinuous quadratics with the nodes of `E`, which is [`P2`](super::P2), except that the mean over the cell replaces the
/// value at the midpoint of the last edge.
///
/// The mean is `sum_i m_i v_i` over the nodes of `E`, with `m = (2 - D) / ((D + 1)(D + 2))` at
/// vertices and `4 / ((D + 1)(D + 2))` at midpoints: Simpson's rule in one dimension, the mean of
/// the three midpoints in two. With the functions `phi` of `E` and `e` the last edge the basis is
/// `phi_i - m_i / m_e phi_e`, and `phi_e / m_e` for the mean. The replaced node is a midpoint because
/// in two dimensions `m = 0` at vertices.
///
/// The space is that of [`Broken<E>`](super::Broken).
#[derive(Clone, Copy, Debug, Default)]
pub struct QuadraticCellMean<E>(pub E);

/// The mean of function `i` of quadratic Lagrange elements over the cell.
const fn mean(dimension: usize, i: usize) -> f64 {
    let numerator = if i <= dimension { 2.0 - dimension as f64 } else { 4.0 };
    numerator / ((dimension + 1) * (dimension + 2)) as f64
}

/// The number of the last edge's function.
const fn last(dimension: usize) -> usize {
    (dimension + 1) * (dimension + 2) / 2 - 1
}

impl<const D: usize, E: Element<D>> Element<D> for QuadraticCellMean<E> {
    fn degree(&self) -> usize {
        2
    }
    fn layout(&self) -> Layout {
        Layout::in_cells(last(D) + 1)
    }
    fn node(&self, i: usize) -> Node {
        if i == last(D) { Node::cell_mean() } else { self.0.node(i) }
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        self.0.values(lambda, out);
        let last = last(D);
        let of_mean = out[last] / mean(D, last);
        for (i, value) in out[..last].iter_mut().enumerate() {
            *value -= mean(D, i) * of_mean;
        }
        out[last] = of_mean;
    }
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]) {
        self.0.derivatives(lambda, out);
        let last = last(D);
        let of_mean = out[last].map(|slope| slope / mean(D, last));
        for (i, row) in out[..last].iter_mut().enumerate() {
            for (slope, &of_mean) in row.iter_mut().zip(&of_mean) {
                *slope -= mean(D, i) * of_mean;
            }
        }
        out[last] = of_mean;
    }
}
