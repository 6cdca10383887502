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

/// Factor by which each condensation widens the rounding band.
const BAND_GROWTH: f64 = 4.0;

/// Largest factor by which the rounding band is widened in all. A thousand units of rounding leave a
/// certificate below 1e-9 in `f64` and about 1e-4 in `f32`.
const MAX_BAND_GROWTH: f64 = 64.0;

/// Largest certificate, in units of the rounding band, that rounding explains.
const CERTIFICATE_UNITS: f64 = 8.0;

/// A run of the active set method with factors.
pub(crate) struct DirectDriver<'s, 'a, T> {
    settings: &'s ActiveSet,
    iterate: &'s mut DirectIterate<'a, T>,
    history: StateHistory,
    /// Whether an unknown changes state within the present cycle.
    cycle: Vec<bool>,
    /// Units of rounding within which no unknown changes its state; grows with condensations.
    band: f64,
    condensations: usize,
    /// The number of linear systems at the last cycle, condensation or warm start.
    last_intervention: usize,
    /// The number of linear systems when the number of state changes last halved, and that number.
    last_halving: usize,
    fewest_changes: usize,
    /// See `stagnation_steps` of [`ActiveSet`].
    stagnation_steps: usize,
    /// Whether the interior point method may still provide a start because of stagnation.
    may_warm_start: bool,
    /// State changes after the linear system before, unless a warm start came in between.
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
            band: settings.rounding_band,
            condensations: 0,
            last_intervention: 0,
            last_halving: 0,
            fewest_changes: usize::MAX,
            stagnation_steps: settings.stagnation_steps,
            previous_changes: None,
            may_warm_start: settings.globalisation == Globalisation::OnStagnation,
        }
    }

    /// The run for contact states that stagnated in another method: the first system that does not
    /// halve the number of state changes leads to the interior point method.
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

    /// The active set iteration. The error is the outcome if it does not end in a solution.
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
            let global_band = self.band - self.settings.rounding_band;
            if !self.iterate.update_active_set(self.band, global_band, &mut self.history) {
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

    /// Whether the second system or a later one after a warm start does not halve the number of state
    /// changes, while the interior point method can continue.
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

    /// Clears the history but for the present active set.
    fn reset_history(&mut self) {
        self.history = StateHistory::new(self.iterate.states.len());
        self.history.record(&self.iterate.states, &mut self.cycle);
    }

    /// Solves for the present active set. False if the first matrix of the run is singular; every bound
    /// is then made active.
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

    /// Leaves a cycle by condensation, else by the interior point method, else by projected Newton; an
    /// outcome if that ends the run. `has_returned` tells an active set that occurred before from a lack
    /// of improvement.
    fn resolve_cycle(&mut self, has_returned: bool) -> Result<Option<Outcome>, Outcome> {
        let members: Vec<u32> =
            (0..self.cycle.len()).filter(|&i| self.cycle[i]).map(|i| i as u32).collect();
        if self.condensations < self.settings.max_condensations
            && members.len() <= self.settings.max_condensed
        {
            self.condensations += 1;
            if self.condense(&members) {
                self.history.restart(&self.iterate.states);
                let widest = MAX_BAND_GROWTH * self.settings.rounding_band;
                self.band = (BAND_GROWTH * self.band).min(widest);
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
        // without a repeated active set the iteration may still converge, or cycle with fewer unknowns
        self.cycle.fill(false);
        Ok(None)
    }

    /// Continues with the active set that the interior point method finds.
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
    fn run_projected_newton(&mut self) -> Result<Outcome, Outcome> {
        projected_newton::minimise(self.iterate, self.settings)?;
        self.band = self.settings.rounding_band;
        self.confirm()
    }

    /// Sets the contact states of `members` to those that solve the problem condensed on them; false if
    /// none is found.
    fn condense(&mut self, members: &[u32]) -> bool {
        let (band, global_band) = (self.band, self.band - self.settings.rounding_band);
        let iterate = &mut *self.iterate;
        iterate.outer += 1;
        iterate.set_prescribed_values();
        let tolerances = Tolerances {
            bound: iterate.bound_tolerance(band),
            multiplier: &|i| iterate.multiplier_tolerance(i, band, global_band),
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

    /// The outcome of an iteration that ends without a final active set: the best iterate may satisfy the
    /// complementarity conditions, or as well as rounding allows.
    fn outcome_of_best(&mut self, outcome: Outcome) -> Outcome {
        if !matches!(outcome, Outcome::IterationLimit | Outcome::Cycling | Outcome::Stalled) {
            return outcome;
        }
        let (best, jump_multipliers) = self.iterate.best_values();
        let inequality = self.iterate.inequality;
        let (certificate, amplification) =
            certify_with_rounding(inequality, best, jump_multipliers);
        let rounding =
            CERTIFICATE_UNITS * self.settings.rounding_band * T::EPSILON * amplification.max(1.0);
        if certificate.largest() > rounding {
            outcome
        } else if certificate.largest() <= T::CERTIFICATE_LIMIT {
            self.iterate.restore_best();
            Outcome::Converged
        } else {
            Outcome::Stalled
        }
    }

    /// The outcome of an active set that predicts itself: converged if the certificate, which does not
    /// depend on contact states, is within rounding.
    fn confirm(&self) -> Result<Outcome, Outcome> {
        let DirectIterate { inequality, values, jump_multipliers, .. } = &*self.iterate;
        let (certificate, amplification) =
            certify_with_rounding(inequality, values, jump_multipliers);
        let rounding = CERTIFICATE_UNITS * self.band * T::EPSILON;
        // large penalties amplify rounding; the limit holds all the same
        let largest = (rounding * amplification.max(1.0)).min(T::CERTIFICATE_LIMIT);
        if certificate.feasibility <= rounding && certificate.largest() <= largest {
            Ok(Outcome::Converged)
        } else {
            Err(Outcome::Stalled)
        }
    }
}
