//! Small dense linear complementarity problems between two bounds.

use nalgebra::{DMatrix, DVector};

use crate::algebra::Contact;

/// Find `z` with `lower <= z <= upper` such that `w_i` of `w = M z + q` is zero where `z_i` lies
/// between the bounds, not negative at the lower bound and not positive at the upper bound. Absent
/// bounds are infinite.
#[derive(Debug)]
pub(crate) struct DenseLcp {
    /// `M`, symmetric or not.
    pub matrix: DMatrix<f64>,
    /// `q`.
    pub constant: DVector<f64>,
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
    /// Tolerance for the violation of a bound.
    pub bound_tolerance: f64,
    /// Tolerance for `|w_i|` of the wrong sign, for each unknown.
    pub multiplier_tolerances: Vec<f64>,
}

/// Number of block pivots without a new minimum of infeasible unknowns before the parametric method.
const MAX_PIVOTS_WITHOUT_GAIN: usize = 10;

impl DenseLcp {
    /// The contact states of the solution, from a first guess. `None` if a pivot matrix is singular
    /// or the parametric method does not end, which happens only by ties or if `M` is not a
    /// P-matrix (all principal minors positive).
    ///
    /// A block principal pivot changes the states of all infeasible unknowns at once; a few pivots
    /// suffice as a rule. Where the number of infeasible unknowns no longer falls,
    /// [`DenseLcp::parametric_pivots`] follow.
    pub fn solve(&self, mut states: Vec<Contact>) -> Option<Vec<Contact>> {
        let n = states.len();
        let mut fewest = n + 1;
        let mut pivots_left = MAX_PIVOTS_WITHOUT_GAIN;
        while pivots_left > 0 {
            let (z, w) = self.complementary(&states, std::slice::from_ref(&self.constant))?;
            let next: Vec<Contact> =
                (0..n).map(|i| self.predict(i, states[i], z[i], w[i])).collect();
            let infeasible = (0..n).filter(|&i| next[i] != states[i]).count();
            if infeasible == 0 {
                return Some(states);
            }
            if infeasible < fewest {
                fewest = infeasible;
                pivots_left = MAX_PIVOTS_WITHOUT_GAIN;
            } else {
                pivots_left -= 1;
            }
            states = next;
        }
        self.parametric_pivots(states)
    }

    /// Parametric principal pivoting (Cottle, Math. Program. 3 (1972) 210-224): follows the solutions
    /// for the constants `q + t p` from `t = 1`, where `p` makes the given states feasible, to `t = 0`.
    /// `None` if a pivot matrix is singular or `t = 0` is not reached within the limit of pivots.
    ///
    /// For a P-matrix the solution is unique for every `t`, continuous and piecewise linear in `t`: one
    /// unknown changes state at a time, `t` decreases, and no set of states returns. The number of
    /// pieces is about the number of unknowns. (The least-index rule of Murty (1974) is finite too, but
    /// takes more than thousands of pivots for forty unknowns.)
    fn parametric_pivots(&self, mut states: Vec<Contact>) -> Option<Vec<Contact>> {
        let n = states.len();
        let constants = [self.constant.clone(), self.perturbation(&states)?];
        let mut t = 1.0;
        for _ in 0..100 + 20 * n {
            let (z, w) = self.complementary(&states, &constants)?;
            let ((z, dz), (w, dw)) = ((z.column(0), z.column(1)), (w.column(0), w.column(1)));
            // the largest t at which one of the conditions value + t rate >= 0 fails
            let mut event = (0.0, None);
            for i in 0..n {
                let mut require = |value: f64, rate: f64, next: Contact| {
                    if rate > 0.0 && value < 0.0 {
                        let root = (-value / rate).min(t);
                        if root > event.0 {
                            event = (root, Some((i, next)));
                        }
                    }
                };
                let tolerance = self.multiplier_tolerances[i];
                match states[i] {
                    Contact::Inactive => {
                        let gap = z[i] - self.lower[i] + self.bound_tolerance;
                        require(gap, dz[i], Contact::Lower);
                        let gap = self.upper[i] - z[i] + self.bound_tolerance;
                        require(gap, -dz[i], Contact::Upper);
                    }
                    Contact::Lower => require(w[i] + tolerance, dw[i], Contact::Inactive),
                    Contact::Upper => require(-w[i] + tolerance, -dw[i], Contact::Inactive),
                }
            }
            let (root, Some((i, next))) = event else {
                return Some(states);
            };
            t = root;
            states[i] = next;
        }
        None
    }

    /// The state to which unknown `i` changes; its present state if it is feasible.
    fn predict(&self, i: usize, state: Contact, z: f64, w: f64) -> Contact {
        match state {
            Contact::Inactive if z < self.lower[i] - self.bound_tolerance => Contact::Lower,
            Contact::Inactive if z > self.upper[i] + self.bound_tolerance => Contact::Upper,
            Contact::Lower if w < -self.multiplier_tolerances[i] => Contact::Inactive,
            Contact::Upper if w > self.multiplier_tolerances[i] => Contact::Inactive,
            _ => state,
        }
    }

    /// The perturbation `p` of the constant that makes given states feasible: each infeasible `z_i` or
    /// `w_i` is moved beyond its limit by a fraction of its violation. The fractions differ, so that no
    /// two unknowns change state at the same `t`. `None` if the pivot matrix is singular.
    fn perturbation(&self, states: &[Contact]) -> Option<DVector<f64>> {
        let (z, w) = self.complementary(states, std::slice::from_ref(&self.constant))?;
        let (mut z, mut w) = (z.column(0).into_owned(), w.column(0).into_owned());
        for i in 0..states.len() {
            let fraction = 0.25 + 0.5 * (i as f64 * 0.618_033_988_75).fract();
            let (lower, upper) = (self.lower[i], self.upper[i]);
            match states[i] {
                Contact::Inactive if z[i] < lower => {
                    z[i] = lower + fraction * (lower - z[i]).min(upper - lower);
                }
                Contact::Inactive if z[i] > upper => {
                    z[i] = upper - fraction * (z[i] - upper).min(upper - lower);
                }
                Contact::Lower if w[i] < 0.0 => w[i] *= -fraction,
                Contact::Upper if w[i] > 0.0 => w[i] *= -fraction,
                _ => {}
            }
        }
        Some(w - &self.matrix * z - &self.constant)
    }

    /// `z` and `w = M z + q` for each constant `q`, one column each: `w_i` is zero for inactive
    /// `i`. For active `i`, `z_i` is the bound in the first column and zero in all other columns,
    /// which are derivatives with respect to the parameter. `None` if the pivot matrix is singular.
    fn complementary(
        &self,
        states: &[Contact],
        constants: &[DVector<f64>],
    ) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let inactive: Vec<usize> =
            (0..states.len()).filter(|&i| states[i] == Contact::Inactive).collect();
        let constants = DMatrix::from_columns(constants);
        let mut z = DMatrix::zeros(states.len(), constants.ncols());
        for (i, contact) in states.iter().enumerate() {
            z[(i, 0)] = match contact {
                Contact::Inactive => 0.0,
                Contact::Lower => self.lower[i],
                Contact::Upper => self.upper[i],
            };
        }
        if !inactive.is_empty() {
            let right = -(&self.matrix * &z + &constants).select_rows(&inactive);
            let block = self.matrix.select_rows(&inactive).select_columns(&inactive);
            let solution = block.lu().solve(&right)?;
            if !solution.iter().all(|x| x.is_finite()) {
                return None;
            }
            for (row, &i) in inactive.iter().enumerate() {
                z.row_mut(i).copy_from(&solution.row(row));
            }
        }
        let w = &self.matrix * &z + &constants;
        Some((z, w))
    }
}
