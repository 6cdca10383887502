//! Schemes to choose from, and running one of them on one level.

use std::sync::Arc;

use crate::constraint::ConstraintSet;
use crate::error::Error;
use crate::scheme::{NamedScheme, Scheme, SchemeOptions};
use crate::study::{Row, Study, peak_memory_bytes};

use super::measured::Phases;

/// A scheme, as a study takes it.
#[derive(Clone)]
pub(crate) struct Candidate<'a, const D: usize> {
    pub scheme: Arc<dyn Scheme<D> + 'a>,
    /// Its constraint set, if that is not the problem's.
    pub set: Option<Arc<dyn ConstraintSet>>,
    /// The choices in its label, if those that are default are among them.
    pub shown: Option<SchemeOptions>,
}

impl<'a, const D: usize> Candidate<'a, D> {
    /// A scheme.
    pub fn new(scheme: impl Scheme<D> + 'a) -> Self {
        Self { scheme: Arc::new(scheme), set: None, shown: None }
    }
    /// A scheme as users write it.
    pub fn named(scheme: &NamedScheme) -> Self {
        let (set, shown) = (scheme.constraint_set(), scheme.shown_choices());
        Self { scheme: scheme.make().into(), set, shown }
    }
}

/// Runs a study of one scheme on one level with nothing known from before: the row, or those of all adaptive steps,
/// and the phases of their times. The peak of memory is that of the process during the run, where the system tells.
pub(crate) fn run_alone<const D: usize>(study: &Study<'_, D>) -> Result<Vec<(Row, Phases)>, Error> {
    let is_reset = reset_peak_memory();
    let rows = study.run_alone()?;
    let peak = peak_memory_bytes().filter(|_| is_reset);
    let of = |(row, coarse): (Row, f64)| {
        let phases = Phases::new(&row.seconds, coarse);
        (Row { peak_memory_bytes: peak, ..row }, phases)
    };
    Ok(rows.into_iter().map(of).collect())
}

/// Resets the peak of the resident set that the kernel records; `true` if it was reset. Linux only.
fn reset_peak_memory() -> bool {
    cfg!(target_os = "linux") && std::fs::write("/proc/self/clear_refs", "5").is_ok()
}
