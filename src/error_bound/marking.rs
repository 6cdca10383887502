//! The cells that are refined next.

use super::ErrorBound;

/// The fraction of all shares, one over this, of which the order is found at once.
const SORTED_AT_ONCE: usize = 16;

impl ErrorBound {
    /// The smallest set of cells whose shares sum to `theta` of those of all cells, ascending (W. Dörfler, SIAM
    /// J. Numer. Anal. 33 (1996), 1106-1124); of equal shares the first cell counts as larger. None without
    /// a share that is positive.
    #[must_use]
    pub fn marked(&self, theta: f64) -> Vec<usize> {
        let goal = theta.min(1.0) * self.cells.iter().sum::<f64>();
        let mut order: Vec<(f64, usize)> = self.cells.iter().copied().zip(0..).collect();
        let larger = |a: &(f64, usize), b: &(f64, usize)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
        let (mut sum, mut marked) = (0.0, Vec::new());
        let mut rest = &mut order[..];
        // few shares make the sum: only the largest ones are sorted
        while sum < goal && !rest.is_empty() {
            let n = (self.cells.len() / SORTED_AT_ONCE).max(1).min(rest.len());
            rest.select_nth_unstable_by(n - 1, larger);
            let (largest, others) = rest.split_at_mut(n);
            largest.sort_unstable_by(larger);
            let is_needed = |&(share, _): &(f64, usize)| {
                let is_needed = sum < goal && share > 0.0;
                sum += share;
                is_needed
            };
            let needed = largest.iter().copied().take_while(is_needed);
            marked.extend(needed.map(|(_, cell)| cell));
            rest = others;
        }
        marked.sort_unstable();
        marked
    }
}
