//! Which unknowns meet, those that meet the same ones taken as one.

use std::ops::Range;

use crate::algebra::SparseMatrix;

/// No node: the unknown is not to be ordered.
const NONE: u32 = u32::MAX;

/// The graph of a symmetric matrix on some of its unknowns. Neighbouring unknowns with the same row,
/// as all of a cell in a broken space have, make one node: they are eliminated together whatever the
/// order, and cells are fewer than their unknowns.
pub(crate) struct Graph {
    /// Start of each node's neighbours, and their number at the end.
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    /// Start of each node's unknowns in the list given, and its length at the end.
    unknowns: Vec<u32>,
}

impl Graph {
    /// Of the rows and columns `kept`, ascending; entries on and left of the diagonal are read.
    pub fn new<T>(matrix: &SparseMatrix<T>, kept: &[u32]) -> Self {
        let row = |i: u32| {
            let [start, end] = [0, 1].map(|k| matrix.row_starts[i as usize + k] as usize);
            &matrix.columns[start..end]
        };
        let mut unknowns = Vec::new();
        let mut node_of = vec![NONE; matrix.row_starts.len() - 1];
        for (k, &i) in kept.iter().enumerate() {
            if k == 0 || row(kept[k - 1]) != row(i) {
                unknowns.push(k as u32);
            }
            node_of[i as usize] = unknowns.len() as u32 - 1;
        }
        let n = unknowns.len();
        unknowns.push(kept.len() as u32);
        let edges = |visit: &mut dyn FnMut(u32, u32)| {
            for node in 0..n as u32 {
                let mut last = NONE;
                for &j in row(kept[unknowns[node as usize] as usize]) {
                    let other = node_of[j as usize];
                    if other != last && other < node {
                        visit(node, other);
                        last = other;
                    }
                }
            }
        };
        let mut starts = vec![0_u32; n + 2];
        edges(&mut |node, other| {
            starts[node as usize + 2] += 1;
            starts[other as usize + 2] += 1;
        });
        for k in 0..n {
            starts[k + 2] += starts[k + 1];
        }
        let mut neighbours = vec![0; starts[n + 1] as usize];
        edges(&mut |node, other| {
            for (here, there) in [(node, other), (other, node)] {
                let place = &mut starts[here as usize + 1];
                neighbours[*place as usize] = there;
                *place += 1;
            }
        });
        starts.pop();
        Self { starts, neighbours, unknowns }
    }

    /// Number of nodes.
    pub fn size(&self) -> usize {
        self.starts.len() - 1
    }

    /// The unknowns of a node, as places in the list given.
    pub fn unknowns(&self, node: u32) -> Range<usize> {
        let node = node as usize;
        self.unknowns[node] as usize..self.unknowns[node + 1] as usize
    }

    /// The nodes that meet a node.
    #[inline]
    pub fn neighbours(&self, node: u32) -> &[u32] {
        let node = node as usize;
        &self.neighbours[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}
