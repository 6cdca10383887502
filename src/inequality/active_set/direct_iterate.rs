//! The iterate of the active set method with factors: values, contact states, and the operations of one
//! step.

use super::contact_state::{admissible_state, prescribed_value, starting_states};
use super::inactive_system::{InactiveSystem, LinearUnknowns};
use super::state_history::StateHistory;
use crate::algebra::{Bound, Contact, Inequality};
use crate::inequality::certificate::positive_diagonal;
use crate::inequality::interior_point::{InteriorPoint, Restart};
use crate::inequality::{Outcome, Solution};
use crate::linear::direct::FactorError;
use crate::real::Real;

/// The values and contact states of a step, and the best values so far.
pub(crate) struct DirectIterate<'a, T> {
    pub inequality: &'a Inequality<T>,
    pub values: Vec<T>,
    pub states: Vec<Contact>,
    /// Number of linear systems with a new active set so far.
    pub outer: usize,
    /// `b - A u`.
    residual: Vec<f64>,
    /// The largest of all `|u_i|` and `|v_i|`, `v_i` the admissible value nearest to `u_i`; one if
    /// all are zero.
    max_norm: f64,
    best: BestIterate<T>,
    /// The jump multipliers if the matrix is a
    /// [`PenalisedMatrix`](crate::algebra::PenalisedMatrix); else empty.
    pub jump_multipliers: Vec<T>,
    system: InactiveSystem<'a, T>,
    /// The data from which the interior point method can continue; `None` before its first run, or
    /// if no further step is possible.
    restart: Option<Restart>,
}

/// The iterate with the smallest merit; see [`DirectIterate::update_best`].
struct BestIterate<T> {
    merit: f64,
    /// Number of linear systems before this iterate.
    outer: usize,
    values: Vec<T>,
    states: Vec<Contact>,
    jump_multipliers: Vec<T>,
}

impl<'a, T: Real> DirectIterate<'a, T> {
    /// The admissible values nearest to zero, with the contact states of the inequality's start.
    pub fn new(inequality: &'a Inequality<T>) -> Self {
        let bounds = &inequality.bounds;
        let values: Vec<T> = bounds.iter().map(|bound| bound.nearest(T::lit(0.0))).collect();
        let states = starting_states(bounds, &inequality.start);
        let system = InactiveSystem::new(inequality);
        let jump_multipliers = vec![T::lit(0.0); system.n_jumps()];
        Self {
            inequality,
            outer: 0,
            residual: vec![0.0; inequality.size()],
            max_norm: 1.0,
            best: BestIterate {
                merit: f64::INFINITY,
                outer: 0,
                values: values.clone(),
                states: states.clone(),
                jump_multipliers: jump_multipliers.clone(),
            },
            values,
            states,
            jump_multipliers,
            system,
            restart: None,
        }
    }

    /// The solution: the current iterate if it converged, else the best one.
    pub fn into_solution(self, outcome: Outcome) -> Solution<T> {
        let (values, contact, jump_multipliers) = if outcome == Outcome::Converged {
            (self.values, self.states, self.jump_multipliers)
        } else {
            (self.best.values, self.best.states, self.best.jump_multipliers)
        };
        Solution::new(values, contact, outcome)
            .iterations(self.outer, 0)
            .jump_multipliers(jump_multipliers)
    }

    /// Sets every fixed or active unknown to its prescribed value, exactly.
    pub fn set_prescribed_values(&mut self) {
        for ((value, bound), state) in
            self.values.iter_mut().zip(&self.inequality.bounds).zip(&self.states)
        {
            if let Some(prescribed) = prescribed_value(bound, *state) {
                *value = prescribed;
            }
        }
    }

    /// Sets the prescribed values and solves the linear system of the present active set, which
    /// changes values, jump multipliers and residual; see [`InactiveSystem::solve`]. Counts the
    /// system even if it has no factors.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn solve_linear(&mut self, refinements: usize) -> Result<(), FactorError> {
        self.outer += 1;
        self.set_prescribed_values();
        let Self { values, jump_multipliers, residual, .. } = self;
        let unknowns = LinearUnknowns { values, jump_multipliers, residual };
        self.system.solve(&self.states, unknowns, refinements)
    }

    /// Computes `max_norm` and the merit, and keeps the iterate as the best one if its merit is the
    /// smallest so far. False, without a change, if the merit is not finite.
    ///
    /// The merit is the square of the projected Jacobi step `u - P(u + r / d)`, `r = b - A u`, in
    /// the norm `(sum d_i v_i^2)^(1/2)` of the diagonal `d` of `A`. It is zero at the solution
    /// only. It is not divided by the size of the iterate, which would favour iterates that are far
    /// too large.
    pub fn update_best(&mut self) -> bool {
        let mut max_norm = 0.0_f64;
        let mut merit = 0.0;
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let (x, value) = (self.values[i], self.values[i].to_f64());
            let d = positive_diagonal(self.inequality, i);
            let target = bound.nearest(T::lit(value + self.residual[i] / d)).to_f64();
            max_norm = max_norm.max(value.abs()).max(bound.nearest(x).to_f64().abs());
            merit += d * (value - target).powi(2);
        }
        if !merit.is_finite() {
            return false;
        }
        self.max_norm = if max_norm > 0.0 { max_norm } else { 1.0 };
        if merit < self.best.merit {
            self.best.merit = merit;
            self.best.outer = self.outer;
            self.best.values.copy_from_slice(&self.values);
            self.best.states.copy_from_slice(&self.states);
            self.best.jump_multipliers.copy_from_slice(&self.jump_multipliers);
        }
        true
    }

    /// The number of linear systems before the best iterate.
    pub fn best_outer(&self) -> usize {
        self.best.outer
    }

    /// Sets the active set that the iterate predicts: inactive unknowns that violate a bound become
    /// active, active unknowns whose multiplier has the wrong sign become inactive, both only
    /// beyond the tolerances [`DirectIterate::bound_tolerance`] and
    /// [`DirectIterate::multiplier_tolerance`]. Notes the changes in the history; returns whether
    /// any state changed.
    pub fn update_active_set(
        &mut self,
        rounding_multiple: f64,
        global_multiple: f64,
        history: &mut StateHistory,
    ) -> bool {
        // all states are predicted before any is set: a multiplier's tolerance depends on neighbours
        let changes: Vec<(u32, Contact)> = (0..self.states.len())
            .filter_map(|i| Some((i as u32, self.predict(i, rounding_multiple, global_multiple)?)))
            .collect();
        for &(i, contact) in &changes {
            self.set_state(i as usize, contact, history);
        }
        !changes.is_empty()
    }

    /// The new contact state of unknown `i`; `None` if it keeps its own.
    fn predict(&self, i: usize, rounding_multiple: f64, global_multiple: f64) -> Option<Contact> {
        let bound = &self.inequality.bounds[i];
        if bound.fixed_value().is_some() {
            return None;
        }
        let x = self.values[i].to_f64();
        let tolerance = self.bound_tolerance(rounding_multiple);
        let wrong_multiplier = match self.states[i] {
            Contact::Inactive if bound.lower().is_some_and(|l| l.to_f64() - x > tolerance) => {
                return Some(Contact::Lower);
            }
            Contact::Inactive if bound.upper().is_some_and(|u| x - u.to_f64() > tolerance) => {
                return Some(Contact::Upper);
            }
            Contact::Inactive => return None,
            Contact::Lower => self.residual[i],
            Contact::Upper => -self.residual[i],
        };
        let is_wrong = wrong_multiplier > 0.0
            && wrong_multiplier > self.multiplier_tolerance(i, rounding_multiple, global_multiple);
        is_wrong.then_some(Contact::Inactive)
    }

    /// Sets one contact state and notes the change.
    pub fn set_state(&mut self, i: usize, contact: Contact, history: &mut StateHistory) {
        if self.states[i] != contact {
            self.states[i] = contact;
            history.note_change(i);
        }
    }

    /// Replaces the iterate by the result of the interior point method, which starts from the best
    /// iterate, or continues from its own last point if there is one. If it finds no active set,
    /// only the number of linear systems changes, and the method cannot continue later.
    pub fn warm_start_by_interior_point(&mut self) {
        let BestIterate { values, jump_multipliers, .. } = &self.best;
        let condensation = self.system.condensation();
        let mut method = match self.restart.take() {
            Some(restart) => InteriorPoint::resume(self.inequality, condensation, restart),
            None => InteriorPoint::new(self.inequality, condensation, values, jump_multipliers),
        };
        let contact = method.run();
        self.outer += method.steps;
        if let Some(contact) = contact {
            let states = contact.iter().zip(&self.inequality.bounds);
            self.states =
                states.map(|(&contact, bound)| admissible_state(bound, contact)).collect();
            self.values = method.values();
            self.jump_multipliers = method.jump_multipliers();
            self.restart = method.into_restart();
        }
    }

    /// Whether the interior point method can continue from its last point.
    pub fn has_restart(&self) -> bool {
        self.restart.is_some()
    }

    /// Projects every value onto its bounds.
    pub fn project_values(&mut self) {
        for (value, bound) in self.values.iter_mut().zip(&self.inequality.bounds) {
            *value = bound.nearest(*value);
        }
    }

    /// Whether no bound is violated by more than [`DirectIterate::bound_tolerance`].
    pub fn is_admissible(&self, rounding_multiple: f64) -> bool {
        let tolerance = self.bound_tolerance(rounding_multiple);
        let violation =
            |(&x, bound): (&T, &Bound<T>)| (x.to_f64() - bound.nearest(x).to_f64()).abs();
        let mut violations = self.values.iter().zip(&self.inequality.bounds).map(violation);
        violations.all(|violation| violation <= tolerance)
    }

    /// The values and jump multipliers of the best iterate.
    pub fn best_values(&self) -> (&[T], &[T]) {
        (&self.best.values, &self.best.jump_multipliers)
    }

    /// Replaces values, states and jump multipliers by those of the best iterate; the residual stays.
    pub fn restore_best(&mut self) {
        self.values.copy_from_slice(&self.best.values);
        self.states.copy_from_slice(&self.best.states);
        self.jump_multipliers.copy_from_slice(&self.best.jump_multipliers);
    }

    /// Makes every unknown with a bound active, at its lower bound if it has two; false if nothing
    /// changed.
    pub fn activate_all(&mut self, history: &mut StateHistory) -> bool {
        let mut is_changed = false;
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let contact = match (bound.lower(), bound.upper()) {
                (Some(_), _) => Contact::Lower,
                (None, Some(_)) => Contact::Upper,
                (None, None) => Contact::Inactive,
            };
            is_changed |= contact != self.states[i];
            self.set_state(i, contact, history);
        }
        is_changed
    }

    /// Tolerance for the violation of a bound: `rounding_multiple` times machine epsilon times
    /// `max_norm`.
    pub fn bound_tolerance(&self, rounding_multiple: f64) -> f64 {
        rounding_multiple * T::EPSILON * self.max_norm
    }

    /// Tolerance for a multiplier of the wrong sign, the sum of two parts: `rounding_multiple`
    /// times the sum of the absolute values of the terms of its residual, each times machine
    /// epsilon (of the scalar `T` for terms of inactive unknowns, of `f64` for all others); and
    /// `global_multiple` times the machine epsilon of `T` times `d_i` times `max_norm`.
    pub fn multiplier_tolerance(
        &self,
        i: usize,
        rounding_multiple: f64,
        global_multiple: f64,
    ) -> f64 {
        let Inequality { matrix, load, bounds, .. } = self.inequality;
        let global = positive_diagonal(self.inequality, i) * self.max_norm;
        let global_part = global_multiple * T::EPSILON * global;
        if let Some(condensation) = self.system.condensation() {
            let value = |j: usize| self.values[j].to_f64();
            let is_prescribed = |j: usize| prescribed_value(&bounds[j], self.states[j]).is_some();
            let (inactive, prescribed) =
                condensation.residual_term_sizes(i, &value, &self.jump_multipliers, &is_prescribed);
            return rounding_multiple * (T::EPSILON * inactive + f64::EPSILON * prescribed)
                + global_part;
        }
        let (columns, entries) = matrix.row(i);
        let mut inactive = 0.0;
        let mut prescribed = load[i].to_f64().abs();
        for (&j, &a) in columns.iter().zip(entries) {
            let j = j as usize;
            let term = (a.to_f64() * self.values[j].to_f64()).abs();
            match prescribed_value(&bounds[j], self.states[j]) {
                Some(_) => prescribed += term,
                None => inactive += term,
            }
        }
        rounding_multiple * (T::EPSILON * inactive + f64::EPSILON * prescribed) + global_part
    }
}
