//! Violations of bounds that are below the tolerance of [`Iterate::evaluate`], but not small in energy if penalties are
//! large.

use super::iterate::Iterate;
use super::linear_solver::LinearSolver;
use crate::algebra::Contact;
use crate::real::Real;

/// Largest energy norm of all small violations together, divided by that of the iterate, with which they are ignored.
const MAX_SHARE: f64 = 1e-11;

impl<T: Real> Iterate<'_, T> {
    /// The inactive unknowns that violate a bound by more than the rounding of the values near them, with the states of
    /// the violated bounds; the largest of all values, as in [`Iterate::evaluate`], is no scale here. None if the
    /// energy norm of all these violations, estimated by the diagonal of the matrix, is at most [`MAX_SHARE`] times
    /// that of the iterate.
    ///
    /// An unknown that is wrongly left inactive changes the values by its violation at most, and their energy norm by
    /// the violation times the square root of the diagonal entry, which contains the penalties.
    pub fn small_violations(
        &self,
        rounding_band: f64,
        solver: &dyn LinearSolver<T>,
    ) -> Vec<(u32, Contact)> {
        let mut violations = Vec::new();
        let mut square = 0.0;
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            if self.eliminated[i] {
                continue;
            }
            let x = self.values[i];
            let below = bound.lower().map_or(0.0, |lower| (lower - x).to_f64());
            let above = bound.upper().map_or(0.0, |upper| (x - upper).to_f64());
            let violation = below.max(above);
            if violation > 0.0
                && violation > rounding_band * T::EPSILON * solver.largest_value_near(i, self)
            {
                let state = if below > above { Contact::Lower } else { Contact::Upper };
                violations.push((i as u32, state));
                square += self.diagonal[i] * violation * violation;
            }
        }
        if square.sqrt() <= MAX_SHARE * self.energy_norm {
            violations.clear();
        }
        violations
    }
}
