//! The compressed graph of a symmetric matrix.

use std::ops::Range;

use crate::algebra::{NO_INDEX, SparseMatrix};

/// The compressed graph of a symmetric submatrix: a node (a supervariable) is a maximal set of unknowns that are
/// consecutive in the list of free ones and whose rows have the same pattern in the whole matrix, for example the
/// unknowns of a cell of discontinuous elements. Two different nodes are adjacent if the matrix couples their
/// unknowns; no node is its own neighbour.
///
/// Rows of the matrix are sorted by column. Rows of assembled matrices contain their diagonal entry, so that unknowns
/// with equal rows are coupled with each other; without stored diagonal entries a node may contain unknowns that are not
/// coupled.
///
/// Unknowns of a node are indistinguishable for minimum degree and dissection; they are eliminated one
/// after the other (C. Ashcraft, SIAM J. Sci. Comput. 16 (1995), 1404-1411).
pub(crate) struct CompressedGraph {
    /// Start of each node's list in `neighbours`, and the length of `neighbours` at the end.
    neighbour_starts: Vec<u32>,
    neighbours: Vec<u32>,
    /// Start of each node's unknowns, as positions in the list of free unknowns, and the length of
    /// that list at the end.
    unknown_starts: Vec<u32>,
}

impl CompressedGraph {
    /// The graph of the rows and columns `free` (ascending) of a matrix. Edges are read from the lower
    /// triangle, from the row of the first unknown of each node.
    ///
    /// # Panics
    /// If `free` contains a row that the matrix does not have.
    pub fn new<T>(matrix: &SparseMatrix<T>, free: &[u32]) -> Self {
        let row = |i: u32| {
            let [start, end] = [0, 1].map(|k| matrix.row_starts[i as usize + k] as usize);
            &matrix.columns[start..end]
        };
        let mut unknown_starts = Vec::new();
        let mut node_of = vec![NO_INDEX; matrix.row_starts.len() - 1];
        for (k, &i) in free.iter().enumerate() {
            if k == 0 || row(free[k - 1]) != row(i) {
                unknown_starts.push(k as u32);
            }
            node_of[i as usize] = unknown_starts.len() as u32 - 1;
        }
        let n = unknown_starts.len();
        unknown_starts.push(free.len() as u32);
        let for_each_edge = |visit: &mut dyn FnMut(u32, u32)| {
            for node in 0..n as u32 {
                let mut last = NO_INDEX;
                for &j in row(free[unknown_starts[node as usize] as usize]) {
                    let other = node_of[j as usize];
                    if other != last && other < node {
                        visit(node, other);
                        last = other;
                    }
                }
            }
        };
        let mut neighbour_starts = vec![0_u32; n + 2];
        for_each_edge(&mut |node, other| {
            neighbour_starts[node as usize + 2] += 1;
            neighbour_starts[other as usize + 2] += 1;
        });
        for k in 0..n {
            neighbour_starts[k + 2] += neighbour_starts[k + 1];
        }
        let mut neighbours = vec![0; neighbour_starts[n + 1] as usize];
        for_each_edge(&mut |node, other| {
            for (from, to) in [(node, other), (other, node)] {
                let next = &mut neighbour_starts[from as usize + 1];
                neighbours[*next as usize] = to;
                *next += 1;
            }
        });
        neighbour_starts.pop();
        Self { neighbour_starts, neighbours, unknown_starts }
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.neighbour_starts.len() - 1
    }

    /// The unknowns of a node, as positions in the list of free unknowns.
    pub fn unknowns(&self, node: u32) -> Range<usize> {
        let node = node as usize;
        self.unknown_starts[node] as usize..self.unknown_starts[node + 1] as usize
    }

    /// The neighbours of a node.
    #[inline]
    pub fn neighbours(&self, node: u32) -> &[u32] {
        let node = node as usize;
        &self.neighbours
            [self.neighbour_starts[node] as usize..self.neighbour_starts[node + 1] as usize]
    }
}
