//! A case of the stability study.

use super::criterion::Criterion;
use super::plan::Plan;

/// A hard case: what is judged, and the jobs that compute it.
pub(crate) struct Case {
    pub name: &'static str,
    pub criteria: &'static [Criterion],
    /// Adds the jobs of the case.
    pub plan: fn(&mut Plan<'_>),
}
