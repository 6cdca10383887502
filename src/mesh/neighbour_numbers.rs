//! The neighbours of one vertex, or the columns of one row, each once: numbers in the order in which they come, and
//! ranks in ascending order.

/// Consecutive numbers of the neighbours of one vertex, the current one, from zero. Moving to the next vertex takes
/// constant time.
pub(crate) struct NeighbourNumbers<'n> {
    /// For each neighbour one more than the number of its last pair with a vertex, where numbers run on over all
    /// vertices.
    last: &'n mut [u32],
    /// The running number of the first neighbour of the current vertex.
    base: u32,
    n: u32,
}

impl<'n> NeighbourNumbers<'n> {
    /// No numbers yet: `last` has a zero for each neighbour. It is borrowed so that the rest stays in registers.
    #[inline(always)]
    pub fn new(last: &'n mut [u32]) -> Self {
        Self { last, base: 0, n: 0 }
    }
    /// Moves to the next vertex: none of its neighbours has a number.
    #[inline(always)]
    pub fn next_vertex(&mut self) {
        self.base += self.n;
        self.n = 0;
    }
    /// How many numbers the current vertex has given.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.n as usize
    }
    /// The number of this neighbour, the next one if it has none; without a branch.
    #[inline(always)]
    pub fn get_or_push(&mut self, neighbour: u32) -> u32 {
        let last = &mut self.last[neighbour as usize];
        let is_new = *last <= self.base;
        let number = if is_new { self.n } else { *last - self.base - 1 };
        *last = self.base + number + 1;
        self.n += u32::from(is_new);
        number
    }
}

/// Entries compared at once by [`rank`].
pub(crate) const LANES: usize = 8;

/// Longest list ranked by comparing all pairs, which vectorises; longer ones are sorted.
const ALL_PAIRS: usize = 128;

/// The rank in ascending order of each of the first `n` entries of a list, which has room for a multiple of [`LANES`];
/// its other entries are overwritten.
#[inline(always)]
pub(crate) fn rank(list: &mut [u32], n: usize, ranks: &mut [u32]) {
    if n > ALL_PAIRS {
        return sort(&list[..n], ranks);
    }
    let list = &mut list[..n.next_multiple_of(LANES)];
    list[n..].fill(u32::MAX);
    for (ranks, own) in ranks.chunks_exact_mut(LANES).zip(list.chunks_exact(LANES)) {
        let mut below = [0_u32; LANES];
        for &other in &list[..n] {
            for k in 0..LANES {
                below[k] += u32::from(other < own[k]);
            }
        }
        ranks.copy_from_slice(&below);
    }
}

#[cold]
fn sort(list: &[u32], ranks: &mut [u32]) {
    let mut order: Vec<u32> = (0..list.len() as u32).collect();
    order.sort_unstable_by_key(|&k| list[k as usize]);
    for (rank, k) in order.into_iter().enumerate() {
        ranks[k as usize] = rank as u32;
    }
}
