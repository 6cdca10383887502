//! The work of a solve: the number of linear systems, and, where it is asked for, the certificate after every outer step.

use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// The state of a solve after an outer step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistoryPoint {
    /// Number of linear systems so far; see [`Solution::systems`](super::Solution::systems).
    pub systems: usize,
    /// Seconds since the solve began, without those of certificates that only the history needs.
    pub seconds: f64,
    /// The largest part of the certificate of the present values; infinite where there is none.
    pub certificate: f64,
}

/// The number of the present outer step of a solver, from which another thread can display the progress. Clones share
/// the number. Solvers of this library count linear systems with a new active set, steps of the interior point method
/// and of the proximal point method, and cycles of monotone multigrid.
///
/// ```
/// use unilateral::inequality::StepCounter;
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), Error> {
/// let steps = StepCounter::default();
/// let study = Study::<2>::new(scenes::radial(1.0)).scheme(Sipg::default()).levels([8]);
/// let report = study.steps(steps.clone()).run()?;
/// assert_eq!(Some(steps.get()), report.rows[0].iterations.outer);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default)]
pub struct StepCounter(Arc<AtomicUsize>);

impl StepCounter {
    /// Sets the number.
    pub fn set(&self, step: usize) {
        self.0.store(step, Ordering::Relaxed);
    }
    /// Adds a step.
    pub(super) fn advance(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
    /// The number; zero before the first step.
    pub fn get(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }
}

/// What a solver tells of its work while it runs.
pub(super) struct Recorder<'g> {
    steps: &'g StepCounter,
    systems: Cell<usize>,
    /// Whether the history has no point of the present step yet.
    is_new_step: Cell<bool>,
    begin: Cell<Instant>,
    /// The history; `None` if it is not kept.
    history: Option<RefCell<Vec<HistoryPoint>>>,
}

impl<'g> Recorder<'g> {
    /// A solve begins.
    pub fn new(steps: &'g StepCounter, keeps_history: bool) -> Self {
        steps.set(0);
        Self {
            steps,
            systems: Cell::new(0),
            is_new_step: Cell::new(true),
            begin: Cell::new(Instant::now()),
            history: keeps_history.then(RefCell::default),
        }
    }

    /// An outer step begins, with a linear system.
    pub fn begin_step(&self) {
        self.steps.advance();
        self.is_new_step.set(true);
        self.count_system();
    }

    /// The present step has a linear system more.
    pub fn count_system(&self) {
        self.systems.set(self.systems.get() + 1);
    }

    /// The values after a linear system are known. Their point replaces that of an earlier system of the same step. The
    /// certificate is computed only if a history is kept, and the clock stands still meanwhile.
    pub fn end_step(&self, certificate: impl FnOnce() -> f64) {
        let Some(history) = &self.history else { return };
        let pause = Instant::now();
        let seconds = (pause - self.begin.get()).as_secs_f64();
        let (systems, certificate) = (self.systems.get(), certificate());
        let mut history = history.borrow_mut();
        if !self.is_new_step.replace(false) {
            history.pop();
        }
        history.push(HistoryPoint { systems, seconds, certificate });
        self.begin.set(self.begin.get() + pause.elapsed());
    }

    /// The number of linear systems, and the history, empty if it is not kept.
    pub fn finish(self) -> (usize, Vec<HistoryPoint>) {
        (self.systems.get(), self.history.map(RefCell::into_inner).unwrap_or_default())
    }
}
