//! The compressed graph of a symmetric matrix.

use std::ops::Range;

use crate::algebra::{NO_INDEX, SparseMatrix};

/// The compressed graph of a symmetric submatrix: a node is a maximal set of consecutive unknowns
/// whose rows have the same pattern, for example the unknowns of a cell of discontinuous elements. Two
/// different nodes are adjacent if the matrix couples their unknowns; no node is its own neighbour.
///
/// Unknowns of a node are indistinguishable for minimum degree and dissection; they are eliminated one
/// after the other (C. Ashcraft, SIAM J. Sci. Comput. 16 (1995), 1404-1411).
pub(crate) struct CompressedGraph {
    /// Start of each node's list in `neighbours`, and its length at the end.
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    /// Start of each node's unknowns, as positions in the list of free unknowns, and the length of
    /// that list at the end.
    first_unknowns: Vec<u32>,
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
        let mut first_unknowns = Vec::new();
        let mut node_of = vec![NO_INDEX; matrix.row_starts.len() - 1];
        for (k, &i) in free.iter().enumerate() {
            if k == 0 || row(free[k - 1]) != row(i) {
                first_unknowns.push(k as u32);
            }
            node_of[i as usize] = first_unknowns.len() as u32 - 1;
        }
        let n = first_unknowns.len();
        first_unknowns.push(free.len() as u32);
        let for_each_edge = |visit: &mut dyn FnMut(u32, u32)| {
            for node in 0..n as u32 {
                let mut last = NO_INDEX;
                for &j in row(free[first_unknowns[node as usize] as usize]) {
                    let other = node_of[j as usize];
                    if other != last && other < node {
                        visit(node, other);
                        last = other;
                    }
                }
            }
        };
        let mut starts = vec![0_u32; n + 2];
        for_each_edge(&mut |node, other| {
            starts[node as usize + 2] += 1;
            starts[other as usize + 2] += 1;
        });
        for k in 0..n {
            starts[k + 2] += starts[k + 1];
        }
        let mut neighbours = vec![0; starts[n + 1] as usize];
        for_each_edge(&mut |node, other| {
            for (from, to) in [(node, other), (other, node)] {
                let next = &mut starts[from as usize + 1];
                neighbours[*next as usize] = to;
                *next += 1;
            }
        });
        starts.pop();
        Self { starts, neighbours, first_unknowns }
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// The unknowns of a node, as positions in the list of free unknowns.
    pub fn unknowns(&self, node: u32) -> Range<usize> {
        let node = node as usize;
        self.first_unknowns[node] as usize..self.first_unknowns[node + 1] as usize
    }

    /// The neighbours of a node.
    #[inline]
    pub fn neighbours(&self, node: u32) -> &[u32] {
        let node = node as usize;
        &self.neighbours[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}
