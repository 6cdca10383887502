//! The remarks below the tables of a report: why rows did not converge, and warnings.

use crate::study::row::{Row, distinct};

/// The reason for which a row did not converge, in one sentence.
fn reason(row: &Row) -> &str {
    row.message.as_deref().unwrap_or(row.status.message())
}

/// The reasons that a table has given.
#[derive(Default)]
pub(super) struct ReasonsGiven(Vec<String>);

impl ReasonsGiven {
    /// The status of a row; of one that did not converge with the reason, which is kept.
    pub fn status(&mut self, row: &Row) -> String {
        let message = self.message(row);
        if !row.converged() {
            self.0.push(reason(row).to_owned());
        }
        message
    }
    /// The status, with the reason unless it was given before.
    pub fn message(&self, row: &Row) -> String {
        match row.converged() {
            true => row.status.to_string(),
            false if self.0.iter().any(|given| given == reason(row)) => {
                format!("{}, as above", row.status)
            }
            false => format!("{}: {}", row.status, reason(row)),
        }
    }
}

/// Each warning of the rows once, after the labels of its rows.
pub(super) fn warnings<'r>(rows: &[&'r Row]) -> Vec<(String, &'r str)> {
    let all =
        || rows.iter().flat_map(|r| r.warnings.iter().map(|w| (r.label.as_str(), w.as_str())));
    let labels = |warning: &str| distinct(all().filter(|of| of.1 == warning).map(|of| of.0));
    let once = distinct(all().map(|of| of.1));
    once.into_iter().map(|warning| (labels(warning).join(", "), warning)).collect()
}
