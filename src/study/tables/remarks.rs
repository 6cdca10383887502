//! What a report says below its tables.

use crate::study::row::{Row, distinct};

/// The reason for which a row did not converge, in one sentence.
pub(super) fn reason(row: &Row) -> &str {
    row.message.as_deref().unwrap_or(row.status.message())
}

/// That a row did not converge, with its status and the reason.
pub(crate) fn failure(row: &Row) -> String {
    format!("did not converge: {}: {}", row.status, reason(row))
}

/// Each warning of the rows once, after the labels of its rows.
pub(crate) fn warnings<'r>(rows: &[&'r Row]) -> Vec<(String, &'r str)> {
    let all =
        || rows.iter().flat_map(|r| r.warnings.iter().map(|w| (r.label.as_str(), w.as_str())));
    let labels = |warning: &str| distinct(all().filter(|of| of.1 == warning).map(|of| of.0));
    let once = distinct(all().map(|of| of.1));
    once.into_iter().map(|warning| (labels(warning).join(", "), warning)).collect()
}
