//! Ritz values from the coefficients of conjugate gradients.

/// The Lanczos tridiagonal matrix of a run of conjugate gradients with the step lengths `alpha_k` and the direction
/// coefficients `beta_k`: diagonal entries `1 / alpha_k + beta_(k-1) / alpha_(k-1)`, off-diagonal entries
/// `beta_k^(1/2) / alpha_k`. Its eigenvalues are the Ritz values of the preconditioned matrix.
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
        let from_last = self.last.map_or(0.0, |(alpha, beta)| beta / alpha);
        if let Some((alpha, beta)) = self.last {
            self.off_diagonal_squares.push(beta.max(0.0) / (alpha * alpha));
        }
        self.diagonal.push(1.0 / alpha + from_last);
        self.last = Some((alpha, beta));
    }

    /// The smallest and the largest eigenvalue of a positive semidefinite matrix, by bisection with Sylvester's law of
    /// inertia; `None` for the empty matrix.
    pub fn extreme_eigenvalues(&self) -> Option<(f64, f64)> {
        let n = self.diagonal.len();
        if n == 0 {
            return None;
        }
        let row_bound = |i: usize| {
            let left = if i > 0 { self.off_diagonal_squares[i - 1].sqrt() } else { 0.0 };
            let right = if i + 1 < n { self.off_diagonal_squares[i].sqrt() } else { 0.0 };
            self.diagonal[i] + left + right
        };
        // Gershgorin's bound of all eigenvalues
        let bound = (0..n).map(row_bound).fold(0.0, f64::max);
        let eigenvalue = |k: usize| {
            let (mut low, mut high) = (0.0, bound);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if self.count_below(middle) >= k { high = middle } else { low = middle }
            }
            0.5 * (low + high)
        };
        Some((eigenvalue(1), eigenvalue(n)))
    }

    /// The number of eigenvalues below `shift`: the number of negative pivots of the matrix minus `shift` times the
    /// identity.
    fn count_below(&self, shift: f64) -> usize {
        let mut count = 0;
        let mut pivot = 1.0;
        for (i, &d) in self.diagonal.iter().enumerate() {
            let reduction = if i > 0 { self.off_diagonal_squares[i - 1] / pivot } else { 0.0 };
            pivot = d - shift - reduction;
            if pivot == 0.0 {
                pivot = f64::MIN_POSITIVE;
            }
            count += usize::from(pivot < 0.0);
        }
        count
    }
}
