//! Where a part is cut in two, and the fewest nodes that separate the two.

use super::graph::Graph;

/// No node.
const NONE: u32 = u32::MAX;

/// The part of a separator.
pub(crate) const SEPARATOR: u32 = u32::MAX;

/// Cuts leave at least this part of the nodes on either side.
const LEAST: f64 = 0.4;

/// What an uneven cut costs: this times the square of what it is off the middle, of the whole.
const UNEVEN: f64 = 8.0;

/// Where a node is.
#[derive(Clone, Copy, Default)]
struct Site {
    /// The part it is in.
    part: u32,
    /// Its place in that part along each axis.
    places: [u32; 3],
}

/// What a cut along an axis is chosen by.
#[derive(Clone, Default)]
struct Axis {
    /// How many nodes more than at the place before have neighbours beyond a cut: of the nodes below
    /// it, and of those above.
    rims: Vec<[i32; 2]>,
    /// The farthest place that the node at a place meets.
    farthest: Vec<u32>,
}

/// A cut along an axis: the nodes up to a place lie on one side.
#[derive(Clone, Copy)]
pub(crate) struct Cut {
    pub axis: usize,
    place: usize,
    /// Nodes that have neighbours beyond it, on the side with fewer, and what being uneven costs.
    cost: f64,
}

/// Cuts parts in two.
pub(crate) struct Cutter<'g> {
    graph: &'g Graph,
    sites: Vec<Site>,
    axes: [Axis; 3],
    /// The node across the cut that each node is matched with.
    mate: Vec<u32>,
    /// When each node was last visited.
    visited: Vec<u32>,
    visit: u32,
}

impl<'g> Cutter<'g> {
    /// For a graph in one part, number zero.
    pub fn new(graph: &'g Graph) -> Self {
        let n = graph.size();
        let axis = || Axis { rims: vec![[0; 2]; n + 1], farthest: vec![0; n] };
        Self {
            graph,
            sites: vec![Site::default(); n],
            axes: [axis(), axis(), axis()],
            mate: vec![NONE; n],
            visited: vec![0; n],
            visit: 0,
        }
    }

    /// The part a node is in.
    #[inline]
    pub fn part(&self, node: u32) -> u32 {
        self.sites[node as usize].part
    }

    /// The best cut of a part, whose nodes are given in their order along each axis.
    ///
    /// The nodes that have neighbours beyond a cut, on either side of it, are counted for all cuts at
    /// once: a node is one of them from its own place to that of its farthest neighbour.
    pub fn best(&mut self, along: &[&[u32]], part: u32) -> Option<Cut> {
        let n = along[0].len();
        for (axis, nodes) in along.iter().enumerate() {
            for (place, &node) in nodes.iter().enumerate() {
                self.sites[node as usize].places[axis] = place as u32;
            }
            self.axes[axis].rims[..=n].fill([0; 2]);
        }
        for &node in along[0] {
            let here = self.sites[node as usize].places;
            let (mut first, mut last) = (here, here);
            for &other in self.graph.neighbours(node) {
                let site = &self.sites[other as usize];
                if site.part == part {
                    for k in 0..3 {
                        first[k] = first[k].min(site.places[k]);
                        last[k] = last[k].max(site.places[k]);
                    }
                }
            }
            // a cut at p has the places below p on one side
            for (k, axis) in self.axes[..along.len()].iter_mut().enumerate() {
                let [first, here, last] = [first[k], here[k], last[k]].map(|k| k as usize);
                axis.farthest[here] = last as u32;
                axis.rims[here + 1][0] += 1;
                axis.rims[last + 1][0] -= 1;
                axis.rims[first + 1][1] += 1;
                axis.rims[here + 1][1] -= 1;
            }
        }
        let cuts = (0..along.len()).filter_map(|axis| self.along(axis, n));
        cuts.min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// The best cut along an axis.
    fn along(&self, axis: usize, n: usize) -> Option<Cut> {
        let (least, middle) = (((n as f64 * LEAST) as usize).max(1), n as f64 / 2.0);
        let mut sizes = [0, 0];
        let mut best = None::<Cut>;
        for (place, rims) in self.axes[axis].rims[..n].iter().enumerate() {
            sizes.iter_mut().zip(rims).for_each(|(size, change)| *size += change);
            if place.min(n - place) >= least {
                let off = (place as f64 - middle) / n as f64;
                let cost = f64::from(sizes[0].min(sizes[1])) * (1.0 + UNEVEN * off * off);
                if best.is_none_or(|best| cost < best.cost) {
                    best = Some(Cut { axis, place, cost });
                }
            }
        }
        best
    }

    /// Divides the part whose best cut was found last, its nodes in their order along the axis of the
    /// cut, into two new ones and the fewest nodes that separate them.
    ///
    /// By the theorem of Koenig these are as many as edges across the cut without common nodes: those
    /// below that no alternating path from a node without such an edge reaches, and those above that
    /// one does.
    pub fn divide(&mut self, nodes: &[u32], cut: Cut, new: [u32; 2]) {
        let (below, above) = nodes.split_at(cut.place);
        below.iter().for_each(|&node| self.sites[node as usize].part = new[0]);
        above.iter().for_each(|&node| self.sites[node as usize].part = new[1]);
        let farthest = self.axes[cut.axis].farthest.iter();
        let rim: Vec<u32> = below
            .iter()
            .zip(farthest)
            .filter(|&(_, &place)| place as usize >= cut.place)
            .map(|(&node, _)| node)
            .collect();
        self.match_across(&rim, new[1]);
        self.visit += 1;
        for &node in &rim {
            if self.mate[node as usize] == NONE {
                self.reach(node, new[1]);
            }
        }
        for &node in &rim {
            let mate = std::mem::replace(&mut self.mate[node as usize], NONE);
            if mate != NONE {
                let is_reached = self.visited[node as usize] == self.visit;
                let chosen = if is_reached { mate } else { node };
                self.sites[chosen as usize].part = SEPARATOR;
                self.mate[mate as usize] = NONE;
            }
        }
    }
}

impl Cutter<'_> {
    /// Matches as many nodes of a rim as possible with neighbours in another part.
    fn match_across(&mut self, rim: &[u32], other: u32) {
        for &node in rim {
            let neighbours = self.graph.neighbours(node).iter();
            let mut free =
                neighbours.filter(|&&k| self.part(k) == other && self.mate[k as usize] == NONE);
            if let Some(&mate) = free.next() {
                self.pair(node, mate);
            }
        }
        // what a search in vain has seen leads nowhere until the next path is found
        self.visit += 1;
        for &node in rim {
            if self.mate[node as usize] == NONE && self.augment(node, other) {
                self.visit += 1;
            }
        }
    }

    fn pair(&mut self, node: u32, mate: u32) {
        self.mate[node as usize] = mate;
        self.mate[mate as usize] = node;
    }

    /// Looks for an alternating path from a node without mate to one across, and flips it; false if
    /// there is none.
    fn augment(&mut self, start: u32, other: u32) -> bool {
        // nodes on this side, each with its next neighbour to be looked at
        let mut path = vec![(start, 0)];
        while let Some((node, next)) = path.last_mut() {
            let Some(&across) = self.graph.neighbours(*node).get(*next) else {
                path.pop();
                continue;
            };
            *next += 1;
            let k = across as usize;
            if self.part(across) != other || self.visited[k] == self.visit {
                continue;
            }
            self.visited[k] = self.visit;
            if self.mate[k] != NONE {
                path.push((self.mate[k], 0));
                continue;
            }
            for &(node, next) in &path {
                self.pair(node, self.graph.neighbours(node)[next - 1]);
            }
            return true;
        }
        false
    }

    /// Visits what alternating paths from a node without mate reach.
    fn reach(&mut self, start: u32, other: u32) {
        let mut stack = vec![start];
        self.visited[start as usize] = self.visit;
        while let Some(node) = stack.pop() {
            for &across in self.graph.neighbours(node) {
                let k = across as usize;
                if self.part(across) != other || self.visited[k] == self.visit {
                    continue;
                }
                self.visited[k] = self.visit;
                // a matching that cannot grow leaves nothing unmatched that can be reached
                if self.mate[k] != NONE {
                    self.visited[self.mate[k] as usize] = self.visit;
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

    /// A square of nodes, joined to those within reach along rows and columns, and both diagonals.
    fn lattice(n: usize, reach: usize) -> Graph {
        let near = |a: usize, b: usize| a.abs_diff(b) <= reach;
        let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        for i in 0..n * n {
            let met = (0..n * n).filter(|&j| near(i / n, j / n) && near(i % n, j % n));
            matrix.columns.extend(met.map(|j| j as u32));
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        matrix.values = vec![1.0; matrix.columns.len()];
        Graph::new(&matrix, &(0..(n * n) as u32).collect::<Vec<_>>())
    }

    /// Nothing meets across a separator, which is a line of nodes for each step that edges reach;
    /// with it the smaller side has two fifths of the nodes.
    #[test]
    fn separators_separate() {
        for (n, reach) in [(12, 1), (13, 1), (12, 2), (15, 3)] {
            let graph = lattice(n, reach);
            let size = (n * n) as u32;
            let rows: Vec<u32> = (0..size).collect();
            let side = n as u32;
            let columns: Vec<u32> = (0..size).map(|k| k % side * side + k / side).collect();
            let mut cutter = Cutter::new(&graph);
            let cut = cutter.best(&[&rows, &columns], 0).unwrap();
            let nodes = if cut.axis == 0 { &rows } else { &columns };
            cutter.divide(nodes, cut, [1, 2]);
            let count = |part| rows.iter().filter(|&&node| cutter.part(node) == part).count();
            assert_eq!(count(SEPARATOR), n * reach);
            assert_eq!(count(1) + count(2) + count(SEPARATOR), n * n);
            assert!(count(1).min(count(2)) + count(SEPARATOR) >= 2 * n * n / 5);
            for &node in rows.iter().filter(|&&node| cutter.part(node) == 1) {
                assert!(graph.neighbours(node).iter().all(|&other| cutter.part(other) != 2));
            }
        }
    }

    /// Two hubs, each joined to all nodes across: they separate the sides, either rim is larger.
    #[test]
    fn separators_are_least() {
        let n = 20_u32;
        let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        for i in 0..n {
            let hub = |k: u32| k == 0 || k == n - 1;
            let met =
                (0..n).filter(|&j| i == j || ((hub(i) || hub(j)) && (i < n / 2) != (j < n / 2)));
            matrix.columns.extend(met);
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        matrix.values = vec![1.0; matrix.columns.len()];
        let all: Vec<u32> = (0..n).collect();
        let graph = Graph::new(&matrix, &all);
        let mut cutter = Cutter::new(&graph);
        let cut = cutter.best(&[&all], 0).unwrap();
        cutter.divide(&all, cut, [1, 2]);
        let separator: Vec<u32> =
            all.iter().copied().filter(|&node| cutter.part(node) == SEPARATOR).collect();
        assert_eq!(separator, [0, n - 1]);
    }
}
