//! Small dense complementarity problems between bounds.

use nalgebra::{DMatrix, DVector};

use crate::algebra::Contact;

/// Find `z` within bounds such that `w = M z + q` is zero between them, not negative on the lower
/// and not positive on the upper one. Absent bounds are infinite.
#[derive(Debug)]
pub(super) struct SmallProblem {
    /// The matrix, symmetric or not.
    pub matrix: DMatrix<f64>,
    /// The constant.
    pub constant: DVector<f64>,
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
    /// Largest violation of a bound that is put down to rounding.
    pub gap_noise: f64,
    /// The same of the sign of each multiplier.
    pub force_noise: Vec<f64>,
}

/// Block pivots that fail to lower the number of infeasible unknowns before single ones are taken.
const PATIENCE: usize = 10;

impl SmallProblem {
    /// The contact state of the solution, starting from a guess; `None` if a pivot matrix is
    /// singular or the pivots run out, which cannot happen for a P-matrix free of rounding until
    /// all states have been tried.
    ///
    /// Block principal pivots (all infeasible unknowns change at once) as long as they pay, then
    /// only the infeasible unknown of least index (Murty, Linear Algebra Appl. 9 (1974) 65-108),
    /// which is finite for P-matrices; with two bounds too, because fixing all other unknowns at
    /// their complementary values leaves an increasing function of the last one.
    pub fn solve(&self, mut state: Vec<Contact>) -> Option<Vec<Contact>> {
        let n = state.len();
        let mut fewest = n + 1;
        let mut patience = PATIENCE;
        for _ in 0..1000 + 20 * n {
            let (z, w) = self.complementary(&state)?;
            let next = |i: usize| self.next(i, state[i], z[i], w[i]);
            let infeasible: Vec<usize> = (0..n).filter(|&i| next(i) != state[i]).collect();
            let Some(&least) = infeasible.first() else {
                return Some(state);
            };
            if infeasible.len() < fewest {
                fewest = infeasible.len();
                patience = PATIENCE;
            } else {
                patience = patience.saturating_sub(1);
            }
            let change = if patience > 0 {
                &infeasible[..]
            } else {
                &[least]
            };
            let changed: Vec<_> = change.iter().map(|&i| (i, next(i))).collect();
            for (i, contact) in changed {
                state[i] = contact;
            }
        }
        None
    }

    /// The state an unknown should change to, its own if it is feasible.
    fn next(&self, i: usize, state: Contact, z: f64, w: f64) -> Contact {
        match state {
            Contact::Open if z < self.lower[i] - self.gap_noise => Contact::Lower,
            Contact::Open if z > self.upper[i] + self.gap_noise => Contact::Upper,
            Contact::Lower if w < -self.force_noise[i] => Contact::Open,
            Contact::Upper if w > self.force_noise[i] => Contact::Open,
            _ => state,
        }
    }

    /// `z` on its bounds where the state says so, `w` zero elsewhere.
    fn complementary(&self, state: &[Contact]) -> Option<(DVector<f64>, DVector<f64>)> {
        let open: Vec<usize> = (0..state.len())
            .filter(|&i| state[i] == Contact::Open)
            .collect();
        let mut z = DVector::from_iterator(
            state.len(),
            state.iter().enumerate().map(|(i, contact)| match contact {
                Contact::Open => 0.0,
                Contact::Lower => self.lower[i],
                Contact::Upper => self.upper[i],
            }),
        );
        let w = &self.matrix * &z + &self.constant;
        if open.is_empty() {
            return Some((z, w));
        }
        let block = DMatrix::from_fn(open.len(), open.len(), |i, j| {
            self.matrix[(open[i], open[j])]
        });
        let right = DVector::from_fn(open.len(), |i, _| -w[open[i]]);
        let solution = block.lu().solve(&right)?;
        for (&i, &x) in open.iter().zip(solution.iter()) {
            if !x.is_finite() {
                return None;
            }
            z[i] = x;
        }
        let w = &self.matrix * &z + &self.constant;
        Some((z, w))
    }
}
