//! The number of the present outer step of a solver.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

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
