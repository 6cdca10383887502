//! The violations of the complementarity conditions at one unknown.

use crate::algebra::{Bound, Contact};
use crate::inequality::certificate::nearer_bound;
use crate::real::{Real, maximum};

/// The bound that the value `x` touches: the nearer one, if its gap is at most the step. None for a fixed unknown.
pub(super) fn touched_bound<T: Real>(bound: &Bound<T>, x: f64, step: f64) -> Contact {
    let (side, gap, _) = nearer_bound(bound, x, step);
    match bound.fixed_value() {
        None if gap <= step.abs() => side,
        _ => Contact::Inactive,
    }
}

/// The violations at one unknown, each as a change of its value; see [`Certificate`](crate::inequality::Certificate).
#[derive(Default)]
pub(super) struct LocalViolation {
    pub feasibility: f64,
    pub multiplier: f64,
    pub complementarity: f64,
    pub residual: f64,
}

impl LocalViolation {
    /// The violations for the value `x` and `step = r_i / d_i`, which is positive where a Gauss-Seidel
    /// correction would decrease the value.
    pub fn new<T: Real>(bound: &Bound<T>, x: f64, step: f64) -> Self {
        if let Some(value) = bound.fixed_value() {
            return Self { feasibility: (x - value.to_f64()).abs(), ..Self::default() };
        }
        let [to_lower, to_upper] = bound.distances(x);
        let (_, gap, step_to_bound) = nearer_bound(bound, x, step);
        let to_opposite = maximum(to_lower, to_upper);
        let feasibility = maximum(maximum(-to_lower, -to_upper), 0.0);
        let mut local = Self { feasibility, ..Self::default() };
        if gap > step.abs() {
            local.residual = step;
        } else if step_to_bound < 0.0 {
            local.multiplier = (-step_to_bound).min(to_opposite.max(0.0));
        }
        local.complementarity = gap.min(step_to_bound).max(0.0);
        local
    }

    /// Counts as a multiplier by how much the step of an unknown in a contact state exceeds the largest one there.
    pub fn add_excess<T: Real>(
        &mut self,
        bound: &Bound<T>,
        (x, step): (f64, f64),
        (state, most): (Contact, f64),
    ) {
        let excess = step.abs() - most;
        if excess > 0.0 && touched_bound(bound, x, step) == state {
            self.multiplier = maximum(self.multiplier, excess);
        }
    }

    /// Counts the share of an unknown in the force of its node, if its sign is wrong, as a multiplier. Its step is
    /// relative to the diagonal of the stiffness `K`; the change is that with the same energy in the diagonal `d` of
    /// `A`.
    pub fn add_share<T: Real>(
        &mut self,
        bound: &Bound<T>,
        (x, step): (f64, f64),
        share: f64,
        (stiffness, d): (f64, f64),
    ) {
        let (wrong, opposite) = match touched_bound(bound, x, step) {
            Contact::Lower => (-share, bound.upper()),
            Contact::Upper => (share, bound.lower()),
            Contact::Inactive => return,
        };
        if wrong > 0.0 && stiffness > 0.0 {
            let to_opposite = opposite.map_or(f64::INFINITY, |o| (x - o.to_f64()).abs());
            let change = (wrong / stiffness).min(to_opposite);
            self.multiplier = maximum(self.multiplier, change * (stiffness / d).sqrt());
        }
    }
}
