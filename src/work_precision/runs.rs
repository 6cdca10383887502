//! Rows of cases that ran several times.

use crate::measure::ErrorNorm;
use crate::study::Row;

impl Row {
    /// The seconds that lead to an error in this norm: those of the row, and for the bound of a uniform mesh its own
    /// besides.
    pub fn seconds_to(&self, norm: ErrorNorm) -> f64 {
        match norm {
            ErrorNorm::Bound => self.seconds_with_bound(),
            _ => self.seconds.total,
        }
    }
    /// The median of the total seconds of several runs over the least: a measure of the spread that one disturbed
    /// run does not change. Of two runs in the middle the slower; none for a single run.
    pub fn median_over_least(&self) -> Option<f64> {
        let runs = self.runs.as_ref().filter(|runs| runs.len() > 1)?;
        Some(runs[runs.len() / 2] / runs[0])
    }
    /// Adds a further run of the same case. Times may differ, counts may not: if they do, a warning says so.
    pub fn add_run(&mut self, again: &Self) {
        let counts = |r: &Self| (r.status, r.unknowns, r.nonzeros, r.iterations.clone(), r.active);
        let warning = "status or counts differ between runs";
        if counts(again) != counts(self) && !self.warnings.iter().any(|w| w == warning) {
            self.warnings.push(warning.to_owned());
        }
        let total = again.seconds.total;
        if total < self.seconds.total {
            self.seconds = again.seconds;
        }
        let runs = self.runs.get_or_insert_default();
        runs.insert(runs.partition_point(|run| *run <= total), total);
    }
}
