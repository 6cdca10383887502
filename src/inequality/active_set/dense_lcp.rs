//! Small dense complementarity problems between bounds.

use nalgebra::{DMatrix, DVector};

use crate::algebra::Contact;

/// Find `z` within bounds such that `w = M z + q` is zero between them, not negative on the lower
/// and not positive on the upper one. Absent bounds are infinite.
#[derive(Debug)]
pub(crate) struct SmallProblem {
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

/// Block pivots that fail to lower the number of infeasible unknowns before the path is followed.
const PATIENCE: usize = 10;

impl SmallProblem {
    /// The contact states of the solution, starting from a guess; `None` if a pivot matrix is
    /// singular or the path does not end, which needs a matrix that is not a P-matrix, or ties.
    ///
    /// Block principal pivots (all infeasible unknowns change at once) as long as they pay: most
    /// often a handful. Then the path of solutions is followed, see [`SmallProblem::follow`].
    pub fn solve(&self, mut state: Vec<Contact>) -> Option<Vec<Contact>> {
        let n = state.len();
        let mut fewest = n + 1;
        let mut patience = PATIENCE;
        while patience > 0 {
            let (z, w) = self.complementary(&state, std::slice::from_ref(&self.constant))?;
            let next: Vec<Contact> = (0..n).map(|i| self.next(i, state[i], z[i], w[i])).collect();
            let infeasible = (0..n).filter(|&i| next[i] != state[i]).count();
            if infeasible == 0 {
                return Some(state);
            }
            if infeasible < fewest {
                fewest = infeasible;
                patience = PATIENCE;
            } else {
                patience -= 1;
            }
            state = next;
        }
        self.follow(state)
    }

    /// Follows the solutions for the constants `q + t p` from `t = 1`, where the present states
    /// are made right by the choice of `p`, to `t = 0` (parametric principal pivoting; Cottle,
    /// Math. Program. 3 (1972) 210-224).
    ///
    /// For a P-matrix there is one solution for every `t`, continuous and piecewise linear in it:
    /// one unknown changes state at a time, `t` falls all the way, no state returns. The number of
    /// pieces is about that of the unknowns. (Pivots on the infeasible unknown of least index,
    /// Murty 1974, are finite as well, but thousands did not do for forty unknowns.)
    fn follow(&self, mut state: Vec<Contact>) -> Option<Vec<Contact>> {
        let n = state.len();
        let constants = [self.constant.clone(), self.shift(&state)?];
        let mut t = 1.0;
        for _ in 0..100 + 20 * n {
            let (z, w) = self.complementary(&state, &constants)?;
            let ((z, dz), (w, dw)) = ((z.column(0), z.column(1)), (w.column(0), w.column(1)));
            // The first condition to fail as t falls: value + t * rate >= 0 must hold.
            let mut event = (0.0, None);
            for i in 0..n {
                let mut meet = |value: f64, rate: f64, next: Contact| {
                    if rate > 0.0 && value < 0.0 {
                        let at = (-value / rate).min(t);
                        if at > event.0 {
                            event = (at, Some((i, next)));
                        }
                    }
                };
                match state[i] {
                    Contact::Inactive => {
                        meet(z[i] - self.lower[i] + self.gap_noise, dz[i], Contact::Lower);
                        meet(self.upper[i] - z[i] + self.gap_noise, -dz[i], Contact::Upper);
                    }
                    Contact::Lower => meet(w[i] + self.force_noise[i], dw[i], Contact::Inactive),
                    Contact::Upper => meet(-w[i] + self.force_noise[i], -dw[i], Contact::Inactive),
                }
            }
            let (at, Some((i, next))) = event else {
                return Some(state);
            };
            t = at;
            state[i] = next;
        }
        None
    }
    /// The state an unknown should change to, its own if it is feasible.
    fn next(&self, i: usize, state: Contact, z: f64, w: f64) -> Contact {
        match state {
            Contact::Inactive if z < self.lower[i] - self.gap_noise => Contact::Lower,
            Contact::Inactive if z > self.upper[i] + self.gap_noise => Contact::Upper,
            Contact::Lower if w < -self.force_noise[i] => Contact::Inactive,
            Contact::Upper if w > self.force_noise[i] => Contact::Inactive,
            _ => state,
        }
    }

    /// The change `p` of the constant that makes the states right: wrong unknowns and multipliers
    /// are moved past where they change sign, each by a different share of what they are wrong
    /// by, lest two change state at once on the way back.
    fn shift(&self, state: &[Contact]) -> Option<DVector<f64>> {
        let (z, w) = self.complementary(state, std::slice::from_ref(&self.constant))?;
        let (mut z, mut w) = (z.column(0).into_owned(), w.column(0).into_owned());
        for i in 0..state.len() {
            let share = 0.25 + 0.5 * (i as f64 * 0.618_033_988_75).fract();
            let (lower, upper) = (self.lower[i], self.upper[i]);
            match state[i] {
                Contact::Inactive if z[i] < lower => {
                    z[i] = lower + share * (lower - z[i]).min(upper - lower);
                }
                Contact::Inactive if z[i] > upper => {
                    z[i] = upper - share * (z[i] - upper).min(upper - lower);
                }
                Contact::Lower if w[i] < 0.0 => w[i] *= -share,
                Contact::Upper if w[i] > 0.0 => w[i] *= -share,
                _ => {}
            }
        }
        Some(w - &self.matrix * z - &self.constant)
    }

    /// `z` and `w = M z + q` for each constant `q`, by columns: `w` zero where the state is open,
    /// elsewhere `z` on its bound for the first constant and zero for all others, which are rates.
    fn complementary(
        &self,
        state: &[Contact],
        constants: &[DVector<f64>],
    ) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let open: Vec<usize> =
            (0..state.len()).filter(|&i| state[i] == Contact::Inactive).collect();
        let constants = DMatrix::from_columns(constants);
        let mut z = DMatrix::zeros(state.len(), constants.ncols());
        for (i, contact) in state.iter().enumerate() {
            z[(i, 0)] = match contact {
                Contact::Inactive => 0.0,
                Contact::Lower => self.lower[i],
                Contact::Upper => self.upper[i],
            };
        }
        if !open.is_empty() {
            let right = -(&self.matrix * &z + &constants).select_rows(&open);
            let block = self.matrix.select_rows(&open).select_columns(&open);
            let solution = block.lu().solve(&right)?;
            if !solution.iter().all(|x| x.is_finite()) {
                return None;
            }
            for (row, &i) in open.iter().enumerate() {
                z.row_mut(i).copy_from(&solution.row(row));
            }
        }
        let w = &self.matrix * &z + &constants;
        Some((z, w))
    }
}
