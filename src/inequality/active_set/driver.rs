//! The course of the active set method: when to go on, and what to do where it does not settle.

use super::condensed_lcp::{Noise, resolve};
use super::cycles::History;
use super::iterate::Iterate;
use super::{ActiveSet, LastResort};
use crate::inequality::certificate::certify_with_noise;
use crate::inequality::projected_newton::descend;
use crate::inequality::{Outcome, interior_point};
use crate::linear::FactorError;
use crate::real::Real;

/// How much the band may widen: a thousand units of rounding in all leave a certificate below 1e-9
/// in `f64` and about 1e-4 in `f32`.
const WIDEST: f64 = 64.0;

/// A run of the active set method with everything it falls back on.
pub(crate) struct Search<'s, 'a, T> {
    settings: &'s ActiveSet,
    iterate: &'s mut Iterate<'a, T>,
    history: History,
    /// Whether an unknown takes part in what does not settle.
    cycle: Vec<bool>,
    /// Units of rounding within which nothing changes state now.
    band: f64,
    condensations: usize,
    /// The number of linear systems when an iterate was last better than all before, and when fewer
    /// than half as many unknowns changed as ever before.
    progress: usize,
    settling: usize,
    fewest: usize,
    /// See [`ActiveSet::hesitation`].
    hesitation: usize,
    /// Whether the interior point method may still be asked.
    is_untried: bool,
    /// Changes of state before the last linear system, if the interior point method was not asked in
    /// between.
    moved: Option<usize>,
}

impl<'s, 'a, T: Real> Search<'s, 'a, T> {
    /// A run from the states of the iterate.
    pub fn new(settings: &'s ActiveSet, iterate: &'s mut Iterate<'a, T>) -> Self {
        let n = iterate.state.len();
        Self {
            settings,
            iterate,
            history: History::new(n),
            cycle: vec![false; n],
            band: settings.band,
            condensations: 0,
            progress: 0,
            settling: 0,
            fewest: usize::MAX,
            hesitation: settings.hesitation,
            moved: None,
            is_untried: settings.last_resort == LastResort::WhenUnsettled,
        }
    }

    /// The same where the active set is known not to settle by itself from there.
    pub fn impatient(mut self) -> Self {
        self.hesitation = 0;
        self
    }

    /// Runs until the active set rests or nothing is left to be tried.
    pub fn run(mut self) -> Outcome {
        let result = match self.settings.last_resort {
            LastResort::Monotone if self.iterate.inequality.symmetric => self.descend(),
            LastResort::AtOnce => {
                self.iterate.approach();
                self.search()
            }
            _ => self.search(),
        };
        result.unwrap_or_else(|outcome| self.settle(outcome))
    }

    /// The error is the reason why the active set does not rest.
    fn search(&mut self) -> Result<Outcome, Outcome> {
        self.forget();
        loop {
            if self.iterate.outer >= self.settings.max_outer {
                return Err(Outcome::IterationLimit);
            }
            if !self.solve_linear()? {
                continue;
            }
            if !self.iterate.assess() {
                return Err(Outcome::NotFinite);
            }
            let spread = self.band - self.settings.band;
            if !self.iterate.change_state(self.band, spread, &mut self.history) {
                return self.confirm();
            }
            let outer = self.iterate.outer;
            if self.was_believed_too_early()
                && outer + interior_point::MOST <= self.settings.max_outer
            {
                self.approach();
                continue;
            }
            if 2 * self.history.moving() <= self.fewest {
                self.fewest = self.history.moving();
                self.settling = outer;
            }
            let returned = self.history.record(&self.iterate.state, &mut self.cycle);
            if returned {
                self.progress = outer;
                if let Some(outcome) = self.resolve(true)? {
                    return Ok(outcome);
                }
            } else if self.is_untried
                && outer - self.settling >= self.hesitation
                && outer + interior_point::MOST <= self.settings.max_outer
            {
                self.approach();
            } else if outer - self.progress.max(self.iterate.best_outer()) >= self.settings.patience
            {
                self.history.mark_recent(self.settings.patience, &mut self.cycle);
                self.progress = outer;
                if let Some(outcome) = self.resolve(false)? {
                    return Ok(outcome);
                }
            }
        }
    }

    /// Whether the active set does not settle at once where the interior point method stopped.
    fn was_believed_too_early(&mut self) -> bool {
        let moving = self.history.moving();
        let before = self.moved.replace(moving);
        self.iterate.can_resume() && before.is_some_and(|before| 2 * moving > before)
    }

    /// Forgets all states but the present one.
    fn forget(&mut self) {
        self.history = History::new(self.iterate.state.len());
        self.history.record(&self.iterate.state, &mut self.cycle);
    }

    /// Solves with the states as they are; false if there was no solution and the states were
    /// changed instead.
    fn solve_linear(&mut self) -> Result<bool, Outcome> {
        match self.iterate.solve_linear(self.settings.refinements) {
            Ok(()) => Ok(true),
            Err(FactorError::Singular) if self.iterate.outer == 1 => {
                if self.settings.check_definite {
                    return Err(Outcome::NotCoercive);
                }
                if !self.iterate.close(&mut self.history) {
                    return Err(Outcome::Singular);
                }
                self.forget();
                Ok(false)
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Deals with the unknowns that do not settle; an outcome if that was the end.
    fn resolve(&mut self, returned: bool) -> Result<Option<Outcome>, Outcome> {
        let members: Vec<u32> =
            (0..self.cycle.len()).filter(|&i| self.cycle[i]).map(|i| i as u32).collect();
        if self.condensations < self.settings.max_condensations
            && members.len() <= self.settings.max_condensed
        {
            self.condensations += 1;
            if self.condense(&members) {
                self.history.restart(&self.iterate.state);
                self.band = (4.0 * self.band).min(WIDEST * self.settings.band);
                return Ok(None);
            }
        }
        if self.is_untried {
            self.approach();
        } else if self.settings.last_resort != LastResort::Never
            && self.iterate.inequality.symmetric
        {
            self.iterate.return_to_best();
            return self.descend().map(Some);
        } else if returned {
            return Err(Outcome::Cycling);
        }
        // It may still come to rest by itself, or wander among fewer unknowns.
        self.cycle.fill(false);
        Ok(None)
    }

    /// Starts anew from where the interior point method gets.
    fn approach(&mut self) {
        self.is_untried = false;
        self.moved = None;
        self.iterate.approach();
        self.forget();
        self.cycle.fill(false);
        self.progress = self.iterate.outer;
        self.condensations = 0;
    }

    /// The method that must end, from the iterate as it is.
    fn descend(&mut self) -> Result<Outcome, Outcome> {
        descend(self.iterate, self.settings)?;
        self.band = self.settings.band;
        self.confirm()
    }

    /// Sets the states of some unknowns to those that solve the problem condensed on them; false if
    /// that has no solution that could be found.
    fn condense(&mut self, members: &[u32]) -> bool {
        let (band, spread) = (self.band, self.band - self.settings.band);
        let iterate = &mut *self.iterate;
        iterate.outer += 1;
        iterate.rest_on_bounds();
        let noise = Noise {
            gap: iterate.gap_noise(band),
            force: &|i| iterate.force_noise(i, band, spread),
        };
        let (values, state) = (&iterate.values, &iterate.state);
        let Ok(Some(states)) = resolve(iterate.inequality, values, state, members, &noise) else {
            return false;
        };
        for (&i, &contact) in members.iter().zip(&states) {
            iterate.set_state(i as usize, contact, &mut self.history);
        }
        true
    }

    /// What to call the best iterate where the active set does not rest: it may be a solution, or as
    /// near to one as rounding allows.
    fn settle(&mut self, outcome: Outcome) -> Outcome {
        if !matches!(outcome, Outcome::IterationLimit | Outcome::Cycling | Outcome::Stalled) {
            return outcome;
        }
        let (best, forces) = self.iterate.best_values();
        let (certificate, unit) = certify_with_noise(self.iterate.inequality, best, forces);
        let rounding = 8.0 * self.settings.band * T::EPSILON * unit.max(1.0);
        if certificate.largest() > rounding {
            outcome
        } else if certificate.largest() <= T::CERTIFICATE_LIMIT {
            self.iterate.return_to_best();
            Outcome::Converged
        } else {
            Outcome::Stalled
        }
    }

    /// The active set rests: whether the complementarity conditions hold indeed, by the
    /// certificate, which knows nothing of it.
    fn confirm(&self) -> Result<Outcome, Outcome> {
        let Iterate { inequality, values, forces, .. } = &*self.iterate;
        let (certificate, unit) = certify_with_noise(inequality, values, forces);
        let rounding = 8.0 * self.band * T::EPSILON;
        // rounding may excuse much for a large penalty, but not that the answer is worthless
        let largest = (rounding * unit.max(1.0)).min(T::CERTIFICATE_LIMIT);
        if certificate.feasibility <= rounding && certificate.largest() <= largest {
            Ok(Outcome::Converged)
        } else {
            Err(Outcome::Stalled)
        }
    }
}
