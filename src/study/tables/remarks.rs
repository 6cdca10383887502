//! The remarks below the tables of a report: why rows did not converge, warnings, and what marks mean.

use super::columns::above_norm;
use crate::study::row::{Row, distinct};
use crate::study::series::Series;

/// The remarks on rows: why some did not converge, warnings, and the marks of bounds.
pub(super) fn remarks(series: &[Series<'_>], warned: &[Series<'_>]) -> Vec<String> {
    let reason = |row: &Row| match row.converged() {
        true => Vec::new(),
        false => {
            let reason = row.message.as_deref().unwrap_or(row.status.message());
            vec![format!("{}: {reason}", row.status)]
        }
    };
    let rows: Vec<&Row> = warned.iter().flat_map(|of| of.rows.iter().copied()).collect();
    let failures = each_once(series, reason);
    let warnings = each_once(warned, |row| row.warnings.clone());
    let marks = above_norm(&rows).into_iter().chain(unproven(&rows));
    failures.into_iter().chain(warnings).chain(marks).collect()
}

/// Each text of rows once, after the names of its series, with their levels where these are not all.
fn each_once(series: &[Series<'_>], texts: impl Fn(&Row) -> Vec<String>) -> Vec<String> {
    let has = |row: &Row, text: &String| texts(row).contains(text);
    let all = series.iter().flat_map(|of| of.rows.iter().flat_map(|row| texts(row)));
    let remark = |text: String| {
        let mut places: Vec<(String, Vec<&str>)> = Vec::new();
        for of in series {
            let levels = of.rows.iter().filter(|row| has(row, &text));
            let levels: Vec<String> = levels.map(|row| row.level.to_string()).collect();
            let place = match (levels.len(), of.rows.len()) {
                (0, _) => continue,
                (_, 1) => String::new(),
                _ => format!(" at {}", levels.join(", ")),
            };
            // series with the same levels have them once
            match places.iter_mut().find(|(other, _)| *other == place) {
                Some((_, names)) => names.push(&of.name),
                None => places.push((place, vec![&of.name])),
            }
        }
        let place = |(place, names): (String, Vec<&str>)| names.join(", ") + &place;
        let places: Vec<String> = places.into_iter().map(place).collect();
        format!("{}: {text}", places.join("; "))
    };
    distinct(all).into_iter().map(remark).collect()
}

/// The remark that explains the marks of bounds: the terms that are not proven, with their schemes where these differ in
/// them. None without marks.
fn unproven(rows: &[&Row]) -> Option<String> {
    let words = |row: &&Row| row.bound.unproven_words();
    let sets = distinct(rows.iter().map(words).filter(|words| !words.is_empty()));
    let of_schemes = |set: &String| {
        let rows = rows.iter().filter(|row| words(row) == *set);
        let labels = distinct(rows.map(|row| row.label.as_str()));
        format!("{set} ({})", labels.join(", "))
    };
    let all = match &sets[..] {
        [] => return None,
        [set] => set.clone(),
        several => several.iter().map(of_schemes).collect::<Vec<_>>().join("; "),
    };
    Some(format!("* bound with terms that are not proven: {all}"))
}
