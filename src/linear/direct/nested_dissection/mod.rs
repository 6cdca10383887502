//! Geometric nested dissection.
//!
//! A plane perpendicular to a coordinate axis divides the nodes of a graph into two parts; a minimum
//! vertex separator of the two parts is eliminated last; both parts are ordered recursively.
//! Sources: A. George, SIAM J. Numer. Anal. 10 (1973), 345-363; planes: J. R. Gilbert, G. L.
//! Miller, S.-H. Teng, SIAM J. Sci. Comput. 19 (1998), 2091-2110; separators: A. Pothen, C.-J. Fan,
//! ACM Trans. Math. Softw. 16 (1990), 303-324.
//!
//! `compressed_graph`: the graph. `bisection`: planes and separators. `minimum_degree`: the order
//! within small parts.

mod bisection;
mod compressed_graph;
mod minimum_degree;

use std::cmp::Ordering;
use std::ops::Range;

use crate::algebra::{SparseMatrix, barycentre};
use bisection::{Bisector, SEPARATOR};
use compressed_graph::CompressedGraph;
use minimum_degree::MinimumDegree;

/// Largest number of nodes of a part that is ordered by minimum degree instead of dissection. The fill of the factor
/// differs by two per cent between the sizes 16 and 100; the time to compute the order is least for 32.
const LEAF_SIZE: usize = 32;

/// The compressed graph of a symmetric submatrix, with a point for each node.
pub(crate) struct GeometricGraph<'f> {
    /// The rows and columns of the submatrix, ascending.
    free: &'f [u32],
    graph: CompressedGraph,
    /// The point of each node.
    points: Vec<[f32; 3]>,
}

/// A part of the graph to be divided: a range of positions in the order, and the label of its nodes.
struct Part {
    range: Range<usize>,
    label: u32,
}

impl<'f> GeometricGraph<'f> {
    /// The graph of the rows and columns `free` (ascending) of a matrix whose row `i` has the point
    /// `points[i]`. The point of a node is the barycentre of the points of its unknowns.
    ///
    /// # Panics
    /// If `free` contains a row that the matrix or `points` does not have.
    pub fn new<T>(matrix: &SparseMatrix<T>, free: &'f [u32], points: &[[f32; 3]]) -> Self {
        let graph = CompressedGraph::new(matrix, free);
        let point = |node: u32| barycentre(graph.unknowns(node).map(|k| points[free[k] as usize]));
        let points = (0..graph.n_nodes() as u32).map(point).collect();
        Self { free, graph, points }
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.graph.n_nodes()
    }

    /// The axes along which not all points have the same coordinate.
    pub fn varying_axes(&self) -> Vec<usize> {
        let varies = |k: &usize| self.points.iter().any(|x| x[*k] != self.points[0][*k]);
        (0..3).filter(varies).collect()
    }

    /// The unknowns in the order of elimination.
    pub fn elimination_order(&self) -> Vec<u32> {
        let axes = self.varying_axes();
        let mut sorted = axes.into_iter().map(|axis| self.sorted_along(axis)).collect::<Vec<_>>();
        if sorted.is_empty() {
            sorted.push((0..self.graph.n_nodes() as u32).collect());
        }
        let ordered = dissect(&self.graph, sorted);
        let unknowns = ordered.into_iter().flat_map(|node| self.graph.unknowns(node));
        unknowns.map(|k| self.free[k]).collect()
    }

    /// The nodes sorted by their coordinate along `axis`, then by the two others.
    fn sorted_along(&self, axis: usize) -> Vec<u32> {
        let mut nodes: Vec<u32> = (0..self.points.len() as u32).collect();
        nodes.sort_by(|&a, &b| {
            let [a, b] = [a, b].map(|node| self.points[node as usize]);
            let axes = [axis, (axis + 1) % 3, (axis + 2) % 3];
            axes.iter().fold(Ordering::Equal, |order, &k| order.then(a[k].total_cmp(&b[k])))
        });
        nodes
    }
}

/// The order of elimination of all nodes. `sorted` are the nodes sorted along each axis, for at
/// least one axis.
fn dissect(graph: &CompressedGraph, mut sorted: Vec<Vec<u32>>) -> Vec<u32> {
    let n = graph.n_nodes();
    let mut bisector = Bisector::new(graph);
    let mut parts = vec![Part { range: 0..n, label: 0 }];
    let mut n_labels = 1;
    let mut leaves = Vec::new();
    let mut buffers = [Vec::with_capacity(n), Vec::new()];
    while let Some(Part { range, label }) = parts.pop() {
        let along: Vec<&[u32]> = sorted.iter().map(|nodes| &nodes[range.clone()]).collect();
        let plane = if range.len() > LEAF_SIZE { bisector.best_plane(&along, label) } else { None };
        let Some(plane) = plane else {
            leaves.push(range);
            continue;
        };
        let labels = [n_labels, n_labels + 1];
        n_labels += 2;
        bisector.bisect(along[plane.axis], plane, labels);
        let mut second = range.clone();
        for nodes in &mut sorted {
            second = partition(&mut nodes[range.clone()], &bisector, labels[0], &mut buffers);
        }
        let [start, end] = [second.start, second.end].map(|k| range.start + k);
        parts.push(Part { range: range.start..start, label: labels[0] });
        parts.push(Part { range: start..end, label: labels[1] });
    }
    let mut order = sorted.swap_remove(0);
    let mut minimum_degree = MinimumDegree::new(n);
    leaves.into_iter().for_each(|range| minimum_degree.order(graph, &mut order[range]));
    order
}

/// Partitions nodes stably into the first part, whose label is `first`, the second part and the
/// separator; returns the range of the second part in `nodes`. `buffers` is workspace, empty before
/// and after.
fn partition(
    nodes: &mut [u32],
    bisector: &Bisector<'_>,
    first: u32,
    buffers: &mut [Vec<u32>; 2],
) -> Range<usize> {
    let [second, separator] = buffers;
    let mut n_first = 0;
    for k in 0..nodes.len() {
        let node = nodes[k];
        match bisector.label(node) {
            label if label == first => {
                nodes[n_first] = node;
                n_first += 1;
            }
            SEPARATOR => separator.push(node),
            _ => second.push(node),
        }
    }
    let second_range = n_first..n_first + second.len();
    let rest = second.drain(..).chain(separator.drain(..));
    nodes[n_first..].iter_mut().zip(rest).for_each(|(out, node)| *out = node);
    second_range
}
