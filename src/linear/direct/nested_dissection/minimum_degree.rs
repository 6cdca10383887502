//! Minimum degree for the leaves of a nested dissection.

use super::compressed_graph::CompressedGraph;
use crate::algebra::NO_INDEX;

/// Exact minimum degree for small sets of nodes. The halo of a set, the neighbours of its nodes
/// outside of the set, is eliminated later.
///
/// The degree of a node is the number of adjacent nodes of the compressed graph, not of unknowns.
/// Degrees count the halo; without it, nodes at the boundary of the set would have too small
/// degrees and be eliminated first (F. Pellegrini, J. Roman, P. Amestoy, Concurrency: Pract. Exper.
/// 12 (2000), 69-84). The adjacency of [`LEAF_SIZE`](super::LEAF_SIZE) nodes and their halo is a
/// bit matrix with a few words a row.
pub(crate) struct MinimumDegree {
    /// The local number of each node of the set (first) and of its halo (after the set);
    /// [`NO_INDEX`] for all other nodes, and for all nodes between two calls of
    /// [`MinimumDegree::order`].
    local: Vec<u32>,
    /// The adjacency in the elimination graph: row `k` belongs to the node of the set with local
    /// number `k`; bit `j` is set if this node is adjacent to the node with local number `j`.
    adjacency: Vec<u64>,
    /// The nodes of the halo, in the order of their local numbers.
    halo: Vec<u32>,
}

impl MinimumDegree {
    /// Workspace for a graph of `n_nodes` nodes.
    pub fn new(n_nodes: usize) -> Self {
        Self { local: vec![NO_INDEX; n_nodes], adjacency: Vec::new(), halo: Vec::new() }
    }

    /// Permutes a set of nodes into their order of elimination. The nodes must be different, and no
    /// node of the graph its own neighbour; the graph must have the number of nodes given to
    /// [`MinimumDegree::new`].
    pub fn order(&mut self, graph: &CompressedGraph, nodes: &mut [u32]) {
        let n = nodes.len();
        if n == 0 {
            return;
        }
        let width = self.number_locally(graph, nodes);
        self.adjacency.clear();
        self.adjacency.resize(n * width, 0);
        for (k, &node) in nodes.iter().enumerate() {
            let row = &mut self.adjacency[k * width..(k + 1) * width];
            let adjacent = graph.neighbours(node).iter().map(|&other| self.local[other as usize]);
            adjacent
                .filter(|&bit| bit != NO_INDEX)
                .for_each(|bit| row[bit as usize / 64] |= 1 << (bit % 64));
        }
        nodes.iter().chain(&self.halo).for_each(|&node| self.local[node as usize] = NO_INDEX);
        let pivots = self.eliminate(n, width);
        let sorted: Vec<u32> = pivots.iter().map(|&k| nodes[k]).collect();
        nodes.copy_from_slice(&sorted);
    }

    /// Sets the local numbers of a set and its halo, which must be [`NO_INDEX`] before; returns the
    /// number of words of a row of bits.
    fn number_locally(&mut self, graph: &CompressedGraph, nodes: &[u32]) -> usize {
        for (k, &node) in nodes.iter().enumerate() {
            self.local[node as usize] = k as u32;
        }
        self.halo.clear();
        for &other in nodes.iter().flat_map(|&node| graph.neighbours(node)) {
            let local = &mut self.local[other as usize];
            if *local == NO_INDEX {
                *local = (nodes.len() + self.halo.len()) as u32;
                self.halo.push(other);
            }
        }
        (nodes.len() + self.halo.len()).div_ceil(64)
    }

    /// Repeats `n` times: eliminates a node of minimum degree. Returns the local numbers of the `n`
    /// nodes of the set in a postorder of the elimination tree, which makes columns of the Cholesky
    /// factor with similar patterns consecutive. Afterwards the row of a node contains its
    /// neighbours at the time of its elimination.
    fn eliminate(&mut self, n: usize, width: usize) -> Vec<usize> {
        let count = |row: &[u64]| row.iter().map(|word| word.count_ones()).sum::<u32>();
        let mut degrees: Vec<u32> = self.adjacency.chunks(width).map(count).collect();
        let mut pivots = Vec::with_capacity(n);
        let mut row = vec![0; width];
        for _ in 0..n {
            let least = (0..n).min_by_key(|&k| degrees[k]);
            let Some(pivot) = least else { break };
            degrees[pivot] = u32::MAX;
            pivots.push(pivot);
            row.copy_from_slice(&self.adjacency[pivot * width..(pivot + 1) * width]);
            for k in bits(&row).take_while(|&k| k < n) {
                let other = &mut self.adjacency[k * width..(k + 1) * width];
                other.iter_mut().zip(&row).for_each(|(a, b)| *a |= b);
                other[k / 64] &= !(1 << (k % 64));
                other[pivot / 64] &= !(1 << (pivot % 64));
                degrees[k] = count(other);
            }
        }
        self.postorder(&pivots, width)
    }

    /// The postorder of the elimination tree of `pivots`, nodes in the order of their elimination;
    /// among the children of a node the one with the largest subtree comes last.
    fn postorder(&self, pivots: &[usize], width: usize) -> Vec<usize> {
        let n = pivots.len();
        let mut position = vec![0; n];
        pivots.iter().enumerate().for_each(|(k, &pivot)| position[pivot] = k);
        // The row of an eliminated node contains its neighbours at the time of elimination. The parent of
        // the node is the one of these neighbours that is eliminated first.
        let parent = |pivot: usize| {
            let row = &self.adjacency[pivot * width..(pivot + 1) * width];
            bits(row).take_while(|&k| k < n).map(|k| position[k]).min()
        };
        let parents: Vec<Option<usize>> = pivots.iter().map(|&pivot| parent(pivot)).collect();
        let mut sizes = vec![1; n];
        let mut children = vec![Vec::new(); n];
        let mut roots = Vec::new();
        for k in 0..n {
            match parents[k] {
                Some(parent) => {
                    sizes[parent] += sizes[k];
                    children[parent].push(k);
                }
                None => roots.push(k),
            }
        }
        // The reversed postorder: a parent, then the largest subtree.
        let mut order = Vec::with_capacity(n);
        let sort_by_size = |nodes: &mut [usize]| nodes.sort_by_key(|&k| sizes[k]);
        sort_by_size(&mut roots);
        let mut stack = roots;
        while let Some(k) = stack.pop() {
            order.push(pivots[k]);
            sort_by_size(&mut children[k]);
            stack.append(&mut children[k]);
        }
        order.reverse();
        order
    }
}

/// The positions of the bits that are set, ascending.
fn bits(words: &[u64]) -> impl Iterator<Item = usize> {
    words.iter().enumerate().flat_map(|(k, &word)| {
        let without_lowest = |&word: &u64| (word & (word - 1) != 0).then(|| word & (word - 1));
        std::iter::successors((word != 0).then_some(word), without_lowest)
            .map(move |word| 64 * k + word.trailing_zeros() as usize)
    })
}
