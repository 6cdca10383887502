//! Projected Newton, a descent method: slow, but finite for every symmetric positive definite matrix.

use super::ActiveSet;
use super::direct_iterate::DirectIterate;
use super::state_history::StateHistory;
use crate::algebra::Contact;
use crate::inequality::Outcome;
use crate::real::Real;

/// The Armijo constant: the fraction of the decrease predicted by the slope that a step must achieve.
const ARMIJO: f64 = 1e-4;

/// Minimises the energy `u.A u / 2 - b.u` within the bounds, from the values of the iterate, which
/// becomes the minimiser. The matrix must be symmetric.
///
/// All values are admissible and the energy never rises. Each step computes the minimum on the
/// present face, the set of values with the present active set. If this minimum violates bounds,
/// the step goes towards it along the projected path (Bertsekas, SIAM J. Control Optim. 20 (1982)
/// 221-246) as far as the Armijo condition holds, but at least to the first bound, and every bound
/// it reaches becomes active. If the minimum is admissible, all unknowns whose multiplier has the
/// wrong sign become inactive (More, Toraldo, SIAM J. Optim. 1 (1991) 93-113).
///
/// The method is finite: every step adds an active unknown until the minimum is admissible, and the
/// energies of admissible minima, of which there are at most as many as faces, decrease.
///
/// # Errors
/// The outcome if no solution is found, among them [`Outcome::Stalled`] where rounding exceeds the
/// decrease of the energy.
pub(crate) fn minimise<T: Real>(
    iterate: &mut DirectIterate<'_, T>,
    settings: &ActiveSet,
) -> Result<(), Outcome> {
    let mut history = StateHistory::new(iterate.values.len());
    iterate.set_prescribed_values();
    iterate.project_values();
    let mut decrease = f64::NAN;
    loop {
        if iterate.outer >= settings.max_outer {
            return Err(Outcome::IterationLimit);
        }
        let from = FeasiblePoint::of(iterate);
        iterate.solve_linear(settings.refinements)?;
        if !iterate.update_best() {
            return Err(Outcome::NotFinite);
        }
        if iterate.is_admissible(settings.rounding_band) {
            decrease += from.decrease(iterate, &iterate.values);
            if !iterate.update_active_set(settings.rounding_band, 0.0, &mut history) {
                return Ok(());
            }
            // not a number before the first admissible minimum, which has no predecessor
            if decrease <= 0.0 {
                return Err(Outcome::Stalled);
            }
            decrease = 0.0;
        } else {
            decrease += from.projected_search(iterate, &mut history);
        }
    }
}

/// Admissible values and the residual `b - A u` at them.
struct FeasiblePoint<T> {
    values: Vec<T>,
    residual: Vec<f64>,
}

/// A bound of an unknown that lies between its value at a feasible point and its target value.
struct Crossing {
    unknown: usize,
    /// The fraction of the way to the target at which the bound lies.
    fraction: f64,
    /// The contact state at the bound.
    contact: Contact,
}

impl<T: Real> FeasiblePoint<T> {
    /// The point of an iterate, whose values must be admissible.
    fn of(iterate: &DirectIterate<'_, T>) -> Self {
        let values = iterate.values.clone();
        let mut residual = vec![0.0; values.len()];
        iterate.inequality.residual_f64(&values, &mut residual);
        Self { values, residual }
    }

    /// The decrease of the energy from this point to `values`.
    fn decrease(&self, iterate: &DirectIterate<'_, T>, values: &[T]) -> f64 {
        let (slope, curvature) = self.slope_and_curvature(iterate, values);
        slope - 0.5 * curvature
    }

    /// `r.s` and `s.A s` of the step `s` from this point to `values`.
    fn slope_and_curvature(&self, iterate: &DirectIterate<'_, T>, values: &[T]) -> (f64, f64) {
        let step: Vec<T> = values.iter().zip(&self.values).map(|(&x, &y)| x - y).collect();
        let matrix = &iterate.inequality.matrix;
        let (mut slope, mut curvature) = (0.0, 0.0);
        for (i, step_i) in step.iter().enumerate() {
            slope += self.residual[i] * step_i.to_f64();
            curvature += step_i.to_f64() * matrix.row_dot_f64(i, &step);
        }
        (slope, curvature)
    }

    /// The Armijo search along the projected path `P(u + t (target - u))` from this point `u` to
    /// the values of the iterate, the target, which are replaced by the point found. Every bound
    /// reached becomes active. Returns the decrease of the energy.
    fn projected_search(
        &self,
        iterate: &mut DirectIterate<'_, T>,
        history: &mut StateHistory,
    ) -> f64 {
        let target = iterate.values.clone();
        let crossings = self.crossings(iterate, &target);
        let first = crossings.iter().map(|crossing| crossing.fraction).fold(1.0, f64::min);
        let mut t = 1.0;
        let decrease = loop {
            for i in 0..target.len() {
                let x = self.values[i] + (target[i] - self.values[i]) * T::lit(t);
                iterate.values[i] = iterate.inequality.bounds[i].nearest(x);
            }
            let (slope, curvature) = self.slope_and_curvature(iterate, &iterate.values);
            let decrease = slope - 0.5 * curvature;
            if t <= first || decrease > 0.0 && decrease >= ARMIJO * slope {
                break decrease;
            }
            t = if 0.5 * t > first { 0.5 * t } else { first };
        };
        for crossing in crossings {
            if crossing.fraction <= t {
                iterate.set_state(crossing.unknown, crossing.contact, history);
            }
        }
        iterate.set_prescribed_values();
        decrease
    }

    /// The bounds of inactive unknowns between this point and `target`.
    fn crossings(&self, iterate: &DirectIterate<'_, T>, target: &[T]) -> Vec<Crossing> {
        let bounds = &iterate.inequality.bounds;
        let inactive = (0..target.len()).filter(|&i| iterate.states[i] == Contact::Inactive);
        let crossing = |i: usize| {
            let (from, to) = (self.values[i].to_f64(), target[i].to_f64());
            let (bound, contact) = match (bounds[i].lower(), bounds[i].upper()) {
                (Some(l), _) if to < l.to_f64() => (l, Contact::Lower),
                (_, Some(u)) if to > u.to_f64() => (u, Contact::Upper),
                _ => return None,
            };
            let fraction = ((bound.to_f64() - from) / (to - from)).max(0.0);
            Some(Crossing { unknown: i, fraction, contact })
        };
        inactive.filter_map(crossing).collect()
    }
}
