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

/// Each warning of the rows once, after the labels of its rows, with their levels where a label has several.
pub(super) fn warnings<'r>(rows: &[&'r Row]) -> Vec<(String, &'r str)> {
    let levels_of = |label: &str, has: &dyn Fn(&Row) -> bool| {
        distinct(rows.iter().filter(|r| r.label == label && has(r)).map(|r| r.level))
    };
    let labels = |warning: &str| {
        let has = |row: &Row| row.warnings.iter().any(|of| of == warning);
        let labels = distinct(rows.iter().filter(|r| has(r)).map(|r| r.label.as_str()));
        let of_label = |label: &str| match levels_of(label, &|_| true).len() {
            1 => String::new(),
            _ => {
                let levels = levels_of(label, &has);
                format!(
                    " at {}",
                    levels.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
                )
            }
        };
        // labels with the same levels have them once
        let all = distinct(labels.iter().map(|label| of_label(label)));
        let with = |levels: &String| {
            let meant = labels.iter().copied().filter(|label| of_label(label) == *levels);
            meant.collect::<Vec<_>>().join(", ") + levels
        };
        all.iter().map(with).collect::<Vec<_>>().join("; ")
    };
    let once = distinct(rows.iter().flat_map(|r| r.warnings.iter().map(String::as_str)));
    once.into_iter().map(|warning| (labels(warning), warning)).collect()
}
