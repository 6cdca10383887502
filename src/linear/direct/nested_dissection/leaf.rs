//! The order within what is not cut any more.

use super::graph::Graph;

/// No node.
const NONE: u32 = u32::MAX;

/// Orders small sets of nodes by least degree, those around them being eliminated later.
///
/// Degrees are exact: a set of a hundred nodes and what is around it are the bits of a few words.
/// Counting what is around keeps nodes at the rim for the end, which a degree within the set would
/// eliminate first (the reason for halos in F. Pellegrini, J. Roman, P. Amestoy, Concurrency: Pract.
/// Exper. 12 (2000), 69-84).
pub(crate) struct Leaf {
    /// The number of each node in the set and around it, [`NONE`] elsewhere.
    local: Vec<u32>,
    /// For each node of the set, whom it meets, as bits.
    rows: Vec<u64>,
    around: Vec<u32>,
}

impl Leaf {
    /// For graphs of this size.
    pub fn new(size: usize) -> Self {
        Self { local: vec![NONE; size], rows: Vec::new(), around: Vec::new() }
    }

    /// Orders a set around which everything comes later.
    pub fn order(&mut self, graph: &Graph, nodes: &mut [u32]) {
        let n = nodes.len();
        if n == 0 {
            return;
        }
        let width = self.number(graph, nodes);
        self.rows.clear();
        self.rows.resize(n * width, 0);
        for (k, &node) in nodes.iter().enumerate() {
            let row = &mut self.rows[k * width..(k + 1) * width];
            let met = graph.neighbours(node).iter().map(|&other| self.local[other as usize]);
            met.filter(|&bit| bit != NONE)
                .for_each(|bit| row[bit as usize / 64] |= 1 << (bit % 64));
        }
        nodes.iter().chain(&self.around).for_each(|&node| self.local[node as usize] = NONE);
        let pivots = self.eliminate(n, width);
        let sorted: Vec<u32> = pivots.iter().map(|&k| nodes[k]).collect();
        nodes.copy_from_slice(&sorted);
    }

    /// Numbers the set and what is around it; returns the words that a bit for each takes.
    fn number(&mut self, graph: &Graph, nodes: &[u32]) -> usize {
        for (k, &node) in nodes.iter().enumerate() {
            self.local[node as usize] = k as u32;
        }
        self.around.clear();
        for &other in nodes.iter().flat_map(|&node| graph.neighbours(node)) {
            let local = &mut self.local[other as usize];
            if *local == NONE {
                *local = (nodes.len() + self.around.len()) as u32;
                self.around.push(other);
            }
        }
        (nodes.len() + self.around.len()).div_ceil(64)
    }

    /// Eliminates the node of least degree again and again; the order is that of a walk through the
    /// tree of elimination, children first, so that columns alike are next to each other.
    fn eliminate(&mut self, n: usize, width: usize) -> Vec<usize> {
        let count = |row: &[u64]| row.iter().map(|word| word.count_ones()).sum::<u32>();
        let mut degrees: Vec<u32> = self.rows.chunks(width).map(count).collect();
        let mut pivots = Vec::with_capacity(n);
        let mut row = vec![0; width];
        for _ in 0..n {
            let least = (0..n).min_by_key(|&k| degrees[k]);
            let Some(pivot) = least else { break };
            degrees[pivot] = u32::MAX;
            pivots.push(pivot);
            row.copy_from_slice(&self.rows[pivot * width..(pivot + 1) * width]);
            for k in bits(&row).take_while(|&k| k < n) {
                let other = &mut self.rows[k * width..(k + 1) * width];
                other.iter_mut().zip(&row).for_each(|(a, b)| *a |= b);
                other[k / 64] &= !(1 << (k % 64));
                other[pivot / 64] &= !(1 << (pivot % 64));
                degrees[k] = count(other);
            }
        }
        self.walk(&pivots, width)
    }

    /// The same elimination, children right before their parents, the largest family last.
    fn walk(&self, pivots: &[usize], width: usize) -> Vec<usize> {
        let n = pivots.len();
        let mut place = vec![0; n];
        pivots.iter().enumerate().for_each(|(k, &pivot)| place[pivot] = k);
        // a node that was eliminated keeps the row it had then
        let parent = |pivot: usize| {
            let row = &self.rows[pivot * width..(pivot + 1) * width];
            bits(row).take_while(|&k| k < n).map(|k| place[k]).min()
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
        // from the end: a parent, then its largest child
        let mut order = Vec::with_capacity(n);
        roots.sort_by_key(|&k| sizes[k]);
        let mut stack = roots;
        while let Some(k) = stack.pop() {
            order.push(pivots[k]);
            children[k].sort_by_key(|&child| sizes[child]);
            stack.append(&mut children[k]);
        }
        order.reverse();
        order
    }
}

/// The numbers of the bits that are set, ascending.
fn bits(words: &[u64]) -> impl Iterator<Item = usize> {
    words.iter().enumerate().flat_map(|(k, &word)| {
        let rest = |&word: &u64| (word & (word - 1) != 0).then(|| word & (word - 1));
        std::iter::successors((word != 0).then_some(word), rest)
            .map(move |word| 64 * k + word.trailing_zeros() as usize)
    })
}
