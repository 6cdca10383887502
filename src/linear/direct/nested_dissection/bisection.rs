//! Bisection of a part of a graph: the best plane, and a minimum vertex separator at it.

use super::compressed_graph::CompressedGraph;
use crate::algebra::NO_INDEX;

/// The label of separators.
pub(crate) const SEPARATOR: u32 = u32::MAX;

/// Least fraction of the nodes on each side of a plane.
const MIN_FRACTION: f64 = 0.4;

/// Weight of the squared imbalance `((k - n/2) / n)^2` in the relative cost of a plane with `k` of `n`
/// nodes below.
const IMBALANCE_WEIGHT: f64 = 8.0;

/// The state of a node.
#[derive(Clone, Copy, Default)]
struct NodeState {
    /// The label of the part that contains the node.
    label: u32,
    /// For each axis, the position of the node among the nodes of its part, sorted along this axis.
    positions: [u32; 3],
}

/// The boundary sizes of all planes perpendicular to an axis. The plane at a position has the nodes
/// before this position below it, all others above it. The two boundaries of a plane are the nodes below it with
/// neighbours above it, and the nodes above it with neighbours below it.
#[derive(Clone, Default)]
struct AxisPlanes {
    /// The sizes of the two boundaries of the plane at a position minus the sizes for the plane at the
    /// preceding position.
    boundary_changes: Vec<[i32; 2]>,
    /// For each position the last position among its node and the neighbours of this node.
    last_neighbours: Vec<u32>,
}

/// A plane perpendicular to an axis, with the nodes before a position below.
#[derive(Clone, Copy)]
pub(crate) struct Plane {
    pub axis: usize,
    position: usize,
    /// The size of the smaller boundary, times the sum of one and the weighted squared imbalance.
    cost: f64,
}

/// Divides parts of a graph into two parts and a separator.
pub(crate) struct Bisector<'g> {
    graph: &'g CompressedGraph,
    nodes: Vec<NodeState>,
    axes: [AxisPlanes; 3],
    /// The matching across the plane: the mate of each node, or [`NO_INDEX`]; all [`NO_INDEX`]
    /// between two bisections.
    mate: Vec<u32>,
    /// The number of the last search that visited each node.
    visited: Vec<u32>,
    /// The number of the present search.
    search: u32,
}

impl<'g> Bisector<'g> {
    /// The bisector of a graph; all nodes have the label zero.
    pub fn new(graph: &'g CompressedGraph) -> Self {
        let n = graph.n_nodes();
        let axis =
            || AxisPlanes { boundary_changes: vec![[0; 2]; n + 1], last_neighbours: vec![0; n] };
        Self {
            graph,
            nodes: vec![NodeState::default(); n],
            axes: [axis(), axis(), axis()],
            mate: vec![NO_INDEX; n],
            visited: vec![0; n],
            search: 0,
        }
    }

    /// The label of a node.
    #[inline]
    pub fn label(&self, node: u32) -> u32 {
        self.nodes[node as usize].label
    }

    /// The plane of least cost through the part `label`, whose nodes are given sorted along each
    /// axis, up to three; `None` if no plane has enough nodes on both sides.
    ///
    /// A node belongs to the boundary of all planes between its own position and those of its first
    /// and last neighbours, so that one pass over the edges determines the boundary sizes of all
    /// planes.
    pub fn best_plane(&mut self, along: &[&[u32]], label: u32) -> Option<Plane> {
        let n = along[0].len();
        for (axis, nodes) in along.iter().enumerate() {
            for (position, &node) in nodes.iter().enumerate() {
                self.nodes[node as usize].positions[axis] = position as u32;
            }
            self.axes[axis].boundary_changes[..=n].fill([0; 2]);
        }
        for &node in along[0] {
            let own = self.nodes[node as usize].positions;
            let (mut first, mut last) = (own, own);
            for &other in self.graph.neighbours(node) {
                let neighbour = &self.nodes[other as usize];
                if neighbour.label == label {
                    for k in 0..3 {
                        first[k] = first[k].min(neighbour.positions[k]);
                        last[k] = last[k].max(neighbour.positions[k]);
                    }
                }
            }
            for (k, axis) in self.axes[..along.len()].iter_mut().enumerate() {
                let [first, own, last] = [first[k], own[k], last[k]].map(|k| k as usize);
                axis.last_neighbours[own] = last as u32;
                axis.boundary_changes[own + 1][0] += 1;
                axis.boundary_changes[last + 1][0] -= 1;
                axis.boundary_changes[first + 1][1] += 1;
                axis.boundary_changes[own + 1][1] -= 1;
            }
        }
        let planes = (0..along.len()).filter_map(|axis| self.best_plane_across(axis, n));
        planes.min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// The plane of least cost perpendicular to an axis, for a part of `n` nodes; `None` as for
    /// [`Bisector::best_plane`].
    fn best_plane_across(&self, axis: usize, n: usize) -> Option<Plane> {
        let (least, middle) = (((n as f64 * MIN_FRACTION) as usize).max(1), n as f64 / 2.0);
        let mut sizes = [0, 0];
        let mut best = None::<Plane>;
        for (position, changes) in self.axes[axis].boundary_changes[..n].iter().enumerate() {
            sizes.iter_mut().zip(changes).for_each(|(size, change)| *size += change);
            if position.min(n - position) >= least {
                let imbalance = (position as f64 - middle) / n as f64;
                let cost = f64::from(sizes[0].min(sizes[1]))
                    * (1.0 + IMBALANCE_WEIGHT * imbalance * imbalance);
                if best.is_none_or(|best| cost < best.cost) {
                    best = Some(Plane { axis, position, cost });
                }
            }
        }
        best
    }

    /// Divides the part of the last call of [`Bisector::best_plane`] into two parts with the given
    /// labels and a minimum vertex separator with the label [`SEPARATOR`]. `nodes` are the nodes of
    /// the part sorted along the axis of the plane.
    ///
    /// The separator is the minimum vertex cover of the edges across the plane. By König's theorem
    /// it has as many nodes as a maximum matching has pairs. It contains the node above of each
    /// matched pair that an alternating path from an unmatched node below reaches, and the node
    /// below of every other pair.
    pub fn bisect(&mut self, nodes: &[u32], plane: Plane, labels: [u32; 2]) {
        let (below, above) = nodes.split_at(plane.position);
        below.iter().for_each(|&node| self.nodes[node as usize].label = labels[0]);
        above.iter().for_each(|&node| self.nodes[node as usize].label = labels[1]);
        let last_neighbours = self.axes[plane.axis].last_neighbours.iter();
        let boundary: Vec<u32> = below
            .iter()
            .zip(last_neighbours)
            .filter(|&(_, &position)| position as usize >= plane.position)
            .map(|(&node, _)| node)
            .collect();
        self.match_boundary(&boundary, labels[1]);
        self.search += 1;
        for &node in &boundary {
            if self.mate[node as usize] == NO_INDEX {
                self.visit_alternating_paths(node, labels[1]);
            }
        }
        for &node in &boundary {
            let mate = std::mem::replace(&mut self.mate[node as usize], NO_INDEX);
            if mate != NO_INDEX {
                let is_reached = self.visited[node as usize] == self.search;
                let chosen = if is_reached { mate } else { node };
                self.nodes[chosen as usize].label = SEPARATOR;
                self.mate[mate as usize] = NO_INDEX;
            }
        }
    }
}

impl Bisector<'_> {
    /// Computes a maximum matching between the nodes `boundary` below the plane and the nodes with the label
    /// `label_above`, those above it.
    fn match_boundary(&mut self, boundary: &[u32], label_above: u32) {
        for &node in boundary {
            let neighbours = self.graph.neighbours(node).iter();
            let mut unmatched = neighbours
                .filter(|&&k| self.label(k) == label_above && self.mate[k as usize] == NO_INDEX);
            if let Some(&mate) = unmatched.next() {
                self.set_mates(node, mate);
            }
        }
        // Nodes visited by a search without success lie on no augmenting path until the matching
        // changes; the number of the search therefore changes only then.
        self.search += 1;
        for &node in boundary {
            if self.mate[node as usize] == NO_INDEX && self.augment(node, label_above) {
                self.search += 1;
            }
        }
    }

    fn set_mates(&mut self, node: u32, mate: u32) {
        self.mate[node as usize] = mate;
        self.mate[mate as usize] = node;
    }

    /// Enlarges the matching along an augmenting path from the unmatched node `start` below the plane; false if
    /// there is none. The nodes above the plane have the label `label_above`.
    fn augment(&mut self, start: u32, label_above: u32) -> bool {
        // The nodes of the path below the plane, each with the index of its next neighbour.
        let mut path = vec![(start, 0)];
        while let Some((node, next)) = path.last_mut() {
            let Some(&across) = self.graph.neighbours(*node).get(*next) else {
                path.pop();
                continue;
            };
            *next += 1;
            let k = across as usize;
            if self.label(across) != label_above || self.visited[k] == self.search {
                continue;
            }
            self.visited[k] = self.search;
            if self.mate[k] != NO_INDEX {
                path.push((self.mate[k], 0));
                continue;
            }
            for &(node, next) in &path {
                self.set_mates(node, self.graph.neighbours(node)[next - 1]);
            }
            return true;
        }
        false
    }

    /// Marks all nodes on alternating paths from the unmatched node `start` below the plane as visited. The nodes
    /// above the plane have the label `label_above`.
    fn visit_alternating_paths(&mut self, start: u32, label_above: u32) {
        let mut stack = vec![start];
        self.visited[start as usize] = self.search;
        while let Some(node) = stack.pop() {
            for &across in self.graph.neighbours(node) {
                let k = across as usize;
                if self.label(across) != label_above || self.visited[k] == self.search {
                    continue;
                }
                self.visited[k] = self.search;
                // With a maximum matching every node reached above the plane has a mate.
                if self.mate[k] != NO_INDEX {
                    self.visited[self.mate[k] as usize] = self.search;
                    stack.push(self.mate[k]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::SparseMatrix;

    /// The graph of an `n` by `n` lattice, with edges between nodes at most `reach` apart in both
    /// directions.
    fn lattice(n: usize, reach: usize) -> CompressedGraph {
        let near = |a: usize, b: usize| a.abs_diff(b) <= reach;
        let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        for i in 0..n * n {
            let columns = (0..n * n).filter(|&j| near(i / n, j / n) && near(i % n, j % n));
            matrix.columns.extend(columns.map(|j| j as u32));
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        matrix.values = vec![1.0; matrix.columns.len()];
        CompressedGraph::new(&matrix, &(0..(n * n) as u32).collect::<Vec<_>>())
    }

    /// No edge joins the two parts; the separator consists of `reach` lines of nodes; the smaller part
    /// and the separator have at least two fifths of the nodes.
    #[test]
    fn separators_separate() {
        for (n, reach) in [(12, 1), (13, 1), (12, 2), (15, 3)] {
            let graph = lattice(n, reach);
            let size = (n * n) as u32;
            let rows: Vec<u32> = (0..size).collect();
            let side = n as u32;
            let columns: Vec<u32> = (0..size).map(|k| k % side * side + k / side).collect();
            let mut bisector = Bisector::new(&graph);
            let plane = bisector.best_plane(&[&rows, &columns], 0).unwrap();
            let nodes = if plane.axis == 0 { &rows } else { &columns };
            bisector.bisect(nodes, plane, [1, 2]);
            let count = |label| rows.iter().filter(|&&node| bisector.label(node) == label).count();
            assert_eq!(count(SEPARATOR), n * reach);
            assert_eq!(count(1) + count(2) + count(SEPARATOR), n * n);
            assert!(count(1).min(count(2)) + count(SEPARATOR) >= 2 * n * n / 5);
            for &node in rows.iter().filter(|&&node| bisector.label(node) == 1) {
                assert!(graph.neighbours(node).iter().all(|&other| bisector.label(other) != 2));
            }
        }
    }

    /// A graph with one hub on each side of the plane, adjacent to all nodes of the other side: the two
    /// hubs are the minimum separator, and smaller than the boundary of either side.
    #[test]
    fn separators_are_minimal() {
        let n = 20_u32;
        let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        for i in 0..n {
            let hub = |k: u32| k == 0 || k == n - 1;
            let columns =
                (0..n).filter(|&j| i == j || ((hub(i) || hub(j)) && (i < n / 2) != (j < n / 2)));
            matrix.columns.extend(columns);
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        matrix.values = vec![1.0; matrix.columns.len()];
        let all: Vec<u32> = (0..n).collect();
        let graph = CompressedGraph::new(&matrix, &all);
        let mut bisector = Bisector::new(&graph);
        let plane = bisector.best_plane(&[&all], 0).unwrap();
        bisector.bisect(&all, plane, [1, 2]);
        let separator: Vec<u32> =
            all.iter().copied().filter(|&node| bisector.label(node) == SEPARATOR).collect();
        assert_eq!(separator, [0, n - 1]);
    }
}
