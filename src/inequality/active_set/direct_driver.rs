//! The driver of the active set method with factors: its iteration, and the methods that follow where
//! the active set stagnates or cycles.

use super::condensation::{self, Tolerances};
use super::direct_iterate::DirectIterate;
use super::projected_newton;
use super::state_history::StateHistory;
use super::{ActiveSet, Globalisation};
use crate::inequality::certificate::certify_with_rounding;
use crate::inequality::{Outcome, interior_point};
use crate::linear::direct::FactorError;
use crate::real::Real;

/// Factor by which each condensation enlarges the rounding multiple.
const MULTIPLE_GROWTH: f64 = 4.0;

/// Largest factor by which the rounding multiple is enlarged in all. A thousand times machine epsilon
/// leaves a certificate below 1e-9 in `f64` and about 1e-4 in `f32`.
const MAX_MULTIPLE_GROWTH: f64 = 64.0;

/// The largest certificate that is attributed to rounding, divided by the rounding multiple times
/// machine epsilon.
const CERTIFICATE_FACTOR: f64 = 8.0;

/// A run of the active set method with factors.
pub(crate) struct DirectDriver<'s, 'a, T> {
    settings: &'s ActiveSet,
    iterate: &'s mut DirectIterate<'a, T>,
    history: StateHistory,
    /// Whether an unknown changes state within the present cycle.
    cycle: Vec<bool>,
    /// The multiple of machine epsilon within which no unknown changes its state; grows with
    /// condensations.
    rounding_multiple: f64,
    /// The number of condensed problems since the last warm start.
    condensations: usize,
    /// The number of linear systems at the last cycle, condensation or warm start.
    last_intervention: usize,
    /// The number of linear systems when the number of state changes last halved.
    last_halving: usize,
    /// The number of state changes when it last halved.
    fewest_changes: usize,
    /// See `stagnation_steps` of [`ActiveSet`].
    stagnation_steps: usize,
    /// Whether the interior point method may still provide a start because of stagnation.
    may_warm_start: bool,
    /// The number of state changes after the preceding linear system; `None` after a warm start.
    previous_changes: Option<usize>,
}

impl<'s, 'a, T: Real> DirectDriver<'s, 'a, T> {
    /// A run from the contact states of the iterate.
    pub fn new(settings: &'s ActiveSet, iterate: &'s mut DirectIterate<'a, T>) -> Self {
        let n = iterate.states.len();
        Self {
            settings,
            iterate,
            history: StateHistory::new(n),
            cycle: vec![false; n],
            rounding_multiple: settings.rounding_band,
            condensations: 0,
            last_intervention: 0,
            last_halving: 0,
            fewest_changes: usize::MAX,
            stagnation_steps: settings.stagnation_steps,
            previous_changes: None,
            may_warm_start: settings.globalisation == Globalisation::OnStagnation,
        }
    }

    /// Prepares the run for contact states that stagnated in another method: the first system that
    /// does not halve the number of state changes leads to the interior point method.
    pub fn after_stagnation(mut self) -> Self {
        self.stagnation_steps = 0;
        self
    }

    /// Runs until the active set is that of the solution or no method is left.
    pub fn run(mut self) -> Outcome {
        let result = match self.settings.globalisation {
            Globalisation::ProjectedNewton if self.iterate.inequality.symmetric => {
                self.run_projected_newton()
            }
            Globalisation::InteriorPointFirst => {
                self.iterate.warm_start_by_interior_point();
                self.run_active_set()
            }
            _ => self.run_active_set(),
        };
        result.unwrap_or_else(|outcome| self.outcome_of_best(outcome))
    }

    /// The active set iteration.
    ///
    /// # Errors
    /// The outcome if it does not end in a solution.
    fn run_active_set(&mut self) -> Result<Outcome, Outcome> {
        self.reset_history();
        loop {
            if self.iterate.outer >= self.settings.max_outer {
                return Err(Outcome::IterationLimit);
            }
            if !self.solve_linear()? {
                continue;
            }
            if !self.iterate.update_best() {
                return Err(Outcome::NotFinite);
            }
            let global_multiple = self.rounding_multiple - self.settings.rounding_band;
            if !self.iterate.update_active_set(
                self.rounding_multiple,
                global_multiple,
                &mut self.history,
            ) {
                return self.confirm();
            }
            if self.was_identified_too_early() && self.has_steps_for_interior_point() {
                self.warm_start();
                continue;
            }
            self.note_halving();
            if self.history.record(&self.iterate.states, &mut self.cycle) {
                self.last_intervention = self.iterate.outer;
                if let Some(outcome) = self.resolve_cycle(true)? {
                    return Ok(outcome);
                }
            } else if self.stagnates() && self.has_steps_for_interior_point() {
                self.warm_start();
            } else if self.lacks_improvement() {
                self.history.mark_recent(self.settings.improvement_steps, &mut self.cycle);
                self.last_intervention = self.iterate.outer;
                if let Some(outcome) = self.resolve_cycle(false)? {
                    return Ok(outcome);
                }
            }
        }
    }

    /// Whether the interior point method can continue, and the present system, at least the second
    /// after a warm start, did not halve the number of state changes of the preceding one. Stores
    /// the present number.
    fn was_identified_too_early(&mut self) -> bool {
        let changes = self.history.pending_changes();
        let before = self.previous_changes.replace(changes);
        self.iterate.has_restart() && before.is_some_and(|before| 2 * changes > before)
    }

    /// Whether the limit of linear systems leaves room for an interior point method.
    fn has_steps_for_interior_point(&self) -> bool {
        self.iterate.outer + interior_point::MAX_STEPS <= self.settings.max_outer
    }

    /// Notes when the number of state changes was last at most half of the fewest before.
    fn note_halving(&mut self) {
        let changes = self.history.pending_changes();
        if 2 * changes <= self.fewest_changes {
            self.fewest_changes = changes;
            self.last_halving = self.iterate.outer;
        }
    }

    /// Whether a warm start is due because the number of state changes has not halved for long.
    fn stagnates(&self) -> bool {
        self.may_warm_start && self.iterate.outer - self.last_halving >= self.stagnation_steps
    }

    /// Whether the best iterate has not improved for long.
    fn lacks_improvement(&self) -> bool {
        let last = self.last_intervention.max(self.iterate.best_outer());
        self.iterate.outer - last >= self.settings.improvement_steps
    }

    /// Replaces the history by one that contains the present active set only.
    fn reset_history(&mut self) {
        self.history = StateHistory::new(self.iterate.states.len());
        self.history.record(&self.iterate.states, &mut self.cycle);
    }

    /// Solves the linear system of the present active set. `Ok(false)` if the first matrix of the
    /// run is singular and every bound has been made active instead.
    ///
    /// # Errors
    /// The outcome if the matrix has no factors otherwise.
    fn solve_linear(&mut self) -> Result<bool, Outcome> {
        match self.iterate.solve_linear(self.settings.refinements) {
            Ok(()) => Ok(true),
            Err(FactorError::Singular) if self.iterate.outer == 1 => {
                if self.settings.check_definite {
                    return Err(Outcome::NotCoercive);
                }
                if !self.iterate.activate_all(&mut self.history) {
                    return Err(Outcome::Singular);
                }
                self.reset_history();
                Ok(false)
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Leaves a cycle by condensation, else by the interior point method, else by projected Newton.
    /// `has_returned`: the active set has occurred before; else the best iterate has not improved.
    /// Returns the outcome of projected Newton; `None` if the active set iteration continues.
    ///
    /// # Errors
    /// The outcome if the run ends without a solution.
    fn resolve_cycle(&mut self, has_returned: bool) -> Result<Option<Outcome>, Outcome> {
        let members: Vec<u32> =
            (0..self.cycle.len()).filter(|&i| self.cycle[i]).map(|i| i as u32).collect();
        if self.condensations < self.settings.max_condensations
            && members.len() <= self.settings.max_condensed
        {
            self.condensations += 1;
            if self.condense(&members) {
                self.history.restart(&self.iterate.states);
                let largest = MAX_MULTIPLE_GROWTH * self.settings.rounding_band;
                self.rounding_multiple = (MULTIPLE_GROWTH * self.rounding_multiple).min(largest);
                return Ok(None);
            }
        }
        if self.may_warm_start {
            self.warm_start();
        } else if self.settings.globalisation != Globalisation::Never
            && self.iterate.inequality.symmetric
        {
            self.iterate.restore_best();
            return self.run_projected_newton().map(Some);
        } else if has_returned {
            return Err(Outcome::Cycling);
        }
        // no active set has been repeated: the iteration may still converge, or cycle with fewer
        // unknowns
        self.cycle.fill(false);
        Ok(None)
    }

    /// Continues with the active set that the interior point method finds, with the present one if
    /// it finds none.
    fn warm_start(&mut self) {
        self.may_warm_start = false;
        self.previous_changes = None;
        self.iterate.warm_start_by_interior_point();
        self.reset_history();
        self.cycle.fill(false);
        self.last_intervention = self.iterate.outer;
        self.condensations = 0;
    }

    /// Projected Newton from the present iterate.
    ///
    /// # Errors
    /// The outcome if it does not end in a solution.
    fn run_projected_newton(&mut self) -> Result<Outcome, Outcome> {
        projected_newton::minimise(self.iterate, self.settings)?;
        self.rounding_multiple = self.settings.rounding_band;
        self.confirm()
    }

    /// Sets the contact states of `members` to the states that solve the problem condensed on these
    /// unknowns; false, with states unchanged, if no solution is found or there are no factors.
    /// Counts as a linear system.
    fn condense(&mut self, members: &[u32]) -> bool {
        let multiple = self.rounding_multiple;
        let global_multiple = multiple - self.settings.rounding_band;
        let iterate = &mut *self.iterate;
        iterate.outer += 1;
        iterate.set_prescribed_values();
        let tolerances = Tolerances {
            bound: iterate.bound_tolerance(multiple),
            multiplier: &|i| iterate.multiplier_tolerance(i, multiple, global_multiple),
        };
        let (inequality, values, states) = (iterate.inequality, &iterate.values, &iterate.states);
        let solved = condensation::solve(inequality, values, states, members, &tolerances);
        let Ok(Some(new_states)) = solved else {
            return false;
        };
        for (&i, &contact) in members.iter().zip(&new_states) {
            iterate.set_state(i as usize, contact, &mut self.history);
        }
        true
    }

    /// The outcome of an iteration that ends with `outcome`, without a final active set. If the
    /// best iterate satisfies the complementarity conditions as well as rounding allows, it is
    /// [`Outcome::Converged`] (and the best iterate replaces the present one) or, above the limit
    /// of the certificate, [`Outcome::Stalled`]; else `outcome`.
    fn outcome_of_best(&mut self, outcome: Outcome) -> Outcome {
        if !matches!(outcome, Outcome::IterationLimit | Outcome::Cycling | Outcome::Stalled) {
            return outcome;
        }
        let (best, jump_multipliers) = self.iterate.best_values();
        let inequality = self.iterate.inequality;
        let (certificate, amplification) =
            certify_with_rounding(inequality, best, jump_multipliers);
        let rounding =
            CERTIFICATE_FACTOR * self.settings.rounding_band * T::EPSILON * amplification.max(1.0);
        if certificate.largest() > rounding {
            outcome
        } else if certificate.largest() <= T::CERTIFICATE_LIMIT {
            self.iterate.restore_best();
            Outcome::Converged
        } else {
            Outcome::Stalled
        }
    }

    /// The outcome of an iterate that predicts its own active set: [`Outcome::Converged`] if the
    /// certificate, which does not depend on contact states, is within rounding.
    ///
    /// # Errors
    /// [`Outcome::Stalled`] otherwise.
    fn confirm(&self) -> Result<Outcome, Outcome> {
        let DirectIterate { inequality, values, jump_multipliers, .. } = &*self.iterate;
        let (certificate, amplification) =
            certify_with_rounding(inequality, values, jump_multipliers);
        let rounding = CERTIFICATE_FACTOR * self.rounding_multiple * T::EPSILON;
        // large penalties amplify rounding; the limit of the certificate is respected nevertheless
        let largest = (rounding * amplification.max(1.0)).min(T::CERTIFICATE_LIMIT);
        if certificate.feasibility <= rounding && certificate.largest() <= largest {
            Ok(Outcome::Converged)
        } else {
            Err(Outcome::Stalled)
        }
    }
}
