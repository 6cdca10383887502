//! The cells that are refined next.

use super::ErrorBound;

impl ErrorBound {
    /// The smallest set of cells whose shares sum to `theta` of those of all cells, ascending (W. Dörfler, SIAM
    /// J. Numer. Anal. 33 (1996), 1106-1124); of equal shares the first cell counts as larger. None without
    /// a share that is positive.
    #[must_use]
    pub fn marked(&self, theta: f64) -> Vec<usize> {
        let goal = theta.min(1.0) * self.cells.iter().sum::<f64>();
        let mut order: Vec<usize> = (0..self.cells.len()).collect();
        order.sort_by(|&a, &b| self.cells[b].total_cmp(&self.cells[a]));
        let mut sum = 0.0;
        let is_needed = |&cell: &usize| {
            let is_needed = sum < goal && self.cells[cell] > 0.0;
            sum += self.cells[cell];
            is_needed
        };
        let mut marked: Vec<usize> = order.into_iter().take_while(is_needed).collect();
        marked.sort_unstable();
        marked
    }
}
