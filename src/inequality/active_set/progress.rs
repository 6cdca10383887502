//! The progress of the inexact active set method: stagnation, and how accurately to solve.

use super::kkt_evaluation::KktEvaluation;

/// Fewer state changes than this hardly change the error: the next system is then solved accurately.
const FEW_CHANGES: usize = 16;

/// Largest number of solutions that may be repeated because of rounding.
const MAX_REPEATS: usize = 3;

/// The progress of an iteration.
pub(crate) struct ProgressMonitor {
    /// Whether the active set changed after the last linear system.
    pub active_set_changed: bool,
    /// Whether the next system is solved accurately.
    next_is_accurate: bool,
    /// Whether all systems from now on are solved accurately.
    all_are_accurate: bool,
    /// The smallest merit so far.
    best_merit: f64,
    /// The number of systems since the smallest merit, or since all are solved accurately.
    steps_without_improvement: usize,
    /// The number of accurate solutions whose residual was too large.
    repeats: usize,
    /// The number of state changes when it last halved.
    fewest_changes: usize,
    /// The number of systems with state changes since then.
    steps_without_halving: usize,
}

impl ProgressMonitor {
    /// The progress before the first system, which is solved accurately if `is_linear`: no unknown
    /// has an inequality as bound.
    pub fn new(is_linear: bool) -> Self {
        Self {
            active_set_changed: true,
            next_is_accurate: is_linear,
            all_are_accurate: false,
            best_merit: f64::INFINITY,
            steps_without_improvement: 0,
            repeats: 0,
            fewest_changes: usize::MAX,
            steps_without_halving: 0,
        }
    }

    /// Whether the next system is solved accurately.
    pub fn is_accurate(&self) -> bool {
        self.next_is_accurate || self.all_are_accurate
    }

    /// Notes a number of state changes; true if it has not halved for more than `stagnation_steps`
    /// systems.
    pub fn stagnates(&mut self, changes: usize, stagnation_steps: usize) -> bool {
        if 2 * changes <= self.fewest_changes {
            (self.fewest_changes, self.steps_without_halving) = (changes, 0);
        } else if changes > 0 {
            self.steps_without_halving += 1;
        }
        self.steps_without_halving > stagnation_steps
    }

    /// Notes an accurate solution whose residual is too large; false after more than [`MAX_REPEATS`] of
    /// them.
    pub fn may_repeat(&mut self) -> bool {
        self.repeats += 1;
        self.repeats <= MAX_REPEATS
    }

    /// Notes an evaluation. If the merit has not improved for more than `improvement_steps`
    /// systems, all further systems are solved accurately; if it has not improved for as many of
    /// these either, returns false. `has_returned`: whether the active set has occurred before.
    pub fn improves(
        &mut self,
        evaluation: &KktEvaluation,
        has_returned: bool,
        improvement_steps: usize,
    ) -> bool {
        let changes = evaluation.state_changes.len();
        self.active_set_changed = changes > 0;
        self.next_is_accurate = has_returned || changes < FEW_CHANGES;
        if !self.active_set_changed {
            return true;
        }
        let merit = evaluation.merit();
        self.steps_without_improvement =
            if merit < self.best_merit { 0 } else { self.steps_without_improvement + 1 };
        self.best_merit = self.best_merit.min(merit);
        if self.steps_without_improvement > improvement_steps {
            if self.all_are_accurate {
                return false;
            }
            // inaccurate solutions may be the cause
            (self.all_are_accurate, self.steps_without_improvement) = (true, 0);
        }
        true
    }
}
