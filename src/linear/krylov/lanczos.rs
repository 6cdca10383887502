//! Ritz values from the coefficients of conjugate gradients.

/// The Lanczos tridiagonal matrix of a run of conjugate gradients; its eigenvalues are the Ritz values
/// of the preconditioned matrix.
///
/// Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed. (2003), section 6.7.3.
#[derive(Default)]
pub(crate) struct LanczosMatrix {
    diagonal: Vec<f64>,
    /// The squares of the off-diagonal entries.
    off_diagonal_squares: Vec<f64>,
    /// The coefficients `alpha` and `beta` of the last iteration; `None` before the first.
    last: Option<(f64, f64)>,
}

impl LanczosMatrix {
    /// Adds the row of an iteration with step length `alpha` and direction coefficient `beta`.
    pub fn push(&mut self, alpha: f64, beta: f64) {
        let carried = self.last.map_or(0.0, |(alpha, beta)| beta / alpha);
        if let Some((alpha, beta)) = self.last {
            self.off_diagonal_squares.push(beta.max(0.0) / (alpha * alpha));
        }
        self.diagonal.push(1.0 / alpha + carried);
        self.last = Some((alpha, beta));
    }

    /// The smallest and the largest eigenvalue, by bisection with Sylvester's law of inertia;
    /// `None` for the empty matrix.
    pub fn extreme_eigenvalues(&self) -> Option<(f64, f64)> {
        let n = self.diagonal.len();
        if n == 0 {
            return None;
        }
        let gershgorin = |i: usize| {
            let left = if i > 0 { self.off_diagonal_squares[i - 1].sqrt() } else { 0.0 };
            let right = if i + 1 < n { self.off_diagonal_squares[i].sqrt() } else { 0.0 };
            self.diagonal[i] + left + right
        };
        let largest = (0..n).map(gershgorin).fold(0.0, f64::max);
        let find = |count: usize| {
            let (mut low, mut high) = (0.0, largest);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if self.count_below(middle) >= count { high = middle } else { low = middle }
            }
            0.5 * (low + high)
        };
        Some((find(1), find(n)))
    }

    /// The number of eigenvalues below `shift`: negative pivots of the shifted matrix.
    fn count_below(&self, shift: f64) -> usize {
        let mut count = 0;
        let mut pivot = 1.0;
        for (i, &d) in self.diagonal.iter().enumerate() {
            let carried = if i > 0 { self.off_diagonal_squares[i - 1] / pivot } else { 0.0 };
            pivot = d - shift - carried;
            if pivot == 0.0 {
                pivot = f64::MIN_POSITIVE;
            }
            count += usize::from(pivot < 0.0);
        }
        count
    }
}
