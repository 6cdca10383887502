//! Orders of elimination by nested dissection of points of space.
//!
//! The unknowns of a matrix are cut in two by a plane across an axis, where the fewest lie at it; a
//! least set of them that separates the two comes last; the two are dealt with in the same way
//! (A. George, SIAM J. Numer. Anal. 10 (1973), 345-363; planes as in J. R. Gilbert, G. L. Miller,
//! S.-H. Teng, SIAM J. Sci. Comput. 19 (1998), 2091-2110, least separators as in A. Pothen, C.-J. Fan,
//! ACM Trans. Math. Softw. 16 (1990), 303-324).

mod graph;
mod leaf;
mod separator;

use std::cmp::Ordering;
use std::ops::Range;

use crate::algebra::{SparseMatrix, barycentre};
use graph::Graph;
use leaf::Leaf;
use separator::{Cutter, SEPARATOR};

/// Parts of up to this many nodes are not cut but ordered by least degree. Between 16 and 100 fill
/// differs by two per cent; with 32 the order is found fastest.
const UNCUT: usize = 32;

/// A matrix whose unknowns are at points of space.
pub(crate) struct Cloud<'k> {
    kept: &'k [u32],
    graph: Graph,
    points: Vec<[f32; 3]>,
}

/// A part that is still to be cut: a range of the order, and the name its nodes have.
struct Part {
    range: Range<usize>,
    name: u32,
}

impl<'k> Cloud<'k> {
    /// The rows and columns `kept` (ascending) of a symmetric matrix, and a point for each of all
    /// rows.
    pub fn new<T>(matrix: &SparseMatrix<T>, kept: &'k [u32], points: &[[f32; 3]]) -> Self {
        let graph = Graph::new(matrix, kept);
        let point = |node: u32| barycentre(graph.unknowns(node).map(|k| points[kept[k] as usize]));
        let points = (0..graph.size() as u32).map(point).collect();
        Self { kept, graph, points }
    }

    /// Number of unknowns that do not share their row with the one before.
    pub fn different(&self) -> usize {
        self.graph.size()
    }

    /// The axes along which points differ.
    pub fn axes(&self) -> Vec<usize> {
        let differ = |k: &usize| self.points.iter().any(|x| x[*k] != self.points[0][*k]);
        (0..3).filter(differ).collect()
    }

    /// The unknowns in the order of elimination.
    pub fn order(&self) -> Vec<u32> {
        let mut nodes = self.axes().into_iter().map(|axis| self.along(axis)).collect::<Vec<_>>();
        if nodes.is_empty() {
            nodes.push((0..self.graph.size() as u32).collect());
        }
        let ordered = dissect(&self.graph, nodes);
        let unknowns = ordered.into_iter().flat_map(|node| self.graph.unknowns(node));
        unknowns.map(|k| self.kept[k]).collect()
    }

    /// The nodes in their order along an axis, in planes across it along the others.
    fn along(&self, axis: usize) -> Vec<u32> {
        let mut nodes: Vec<u32> = (0..self.points.len() as u32).collect();
        nodes.sort_by(|&a, &b| {
            let [a, b] = [a, b].map(|node| self.points[node as usize]);
            let axes = [axis, (axis + 1) % 3, (axis + 2) % 3];
            axes.iter().fold(Ordering::Equal, |order, &k| order.then(a[k].total_cmp(&b[k])))
        });
        nodes
    }
}

/// Orders nodes that are given in their order along each axis.
fn dissect(graph: &Graph, mut axes: Vec<Vec<u32>>) -> Vec<u32> {
    let n = graph.size();
    let mut cutter = Cutter::new(graph);
    let mut parts = vec![Part { range: 0..n, name: 0 }];
    let mut names = 1;
    let mut leaves = Vec::new();
    let mut later = [Vec::with_capacity(n), Vec::new()];
    while let Some(Part { range, name }) = parts.pop() {
        let along: Vec<&[u32]> = axes.iter().map(|nodes| &nodes[range.clone()]).collect();
        let cut = if range.len() > UNCUT { cutter.best(&along, name) } else { None };
        let Some(cut) = cut else {
            leaves.push(range);
            continue;
        };
        let new = [names, names + 1];
        names += 2;
        cutter.divide(along[cut.axis], cut, new);
        let mut middle = range.clone();
        for nodes in &mut axes {
            middle = sift(&mut nodes[range.clone()], &cutter, new[0], &mut later);
        }
        let [from, to] = [middle.start, middle.end].map(|k| range.start + k);
        parts.push(Part { range: range.start..from, name: new[0] });
        parts.push(Part { range: from..to, name: new[1] });
    }
    let mut order = axes.swap_remove(0);
    let mut leaf = Leaf::new(n);
    leaves.into_iter().for_each(|range| leaf.order(graph, &mut order[range]));
    order
}

/// Puts the nodes of one part first, separators last, all else in their order; returns where the
/// other part lies.
fn sift(
    nodes: &mut [u32],
    cutter: &Cutter<'_>,
    first: u32,
    later: &mut [Vec<u32>; 2],
) -> Range<usize> {
    let [second, separator] = later;
    let mut kept = 0;
    for k in 0..nodes.len() {
        let node = nodes[k];
        match cutter.part(node) {
            part if part == first => {
                nodes[kept] = node;
                kept += 1;
            }
            SEPARATOR => separator.push(node),
            _ => second.push(node),
        }
    }
    let middle = kept..kept + second.len();
    let rest = second.drain(..).chain(separator.drain(..));
    nodes[kept..].iter_mut().zip(rest).for_each(|(place, node)| *place = node);
    middle
}
