//! Comparison with an earlier report: counts exactly, errors to rounding, times not at all.

use std::fmt;

use serde_json::Value;

use super::report::WorkReport;
use crate::error::Error;
use crate::real::Precision;

/// Keys that identify a row.
const KEYS: [&str; 7] =
    ["scene", "label", "constraint", "linear_asked", "precision", "theta", "level"];
/// Keys whose values must agree exactly.
const COUNTS: [&str; 8] = [
    "/status",
    "/linear",
    "/cells",
    "/unknowns",
    "/nonzeros",
    "/active",
    "/iterations/outer",
    "/iterations/linear",
];
/// Keys whose values must agree to rounding.
const NUMBERS: [&str; 4] = ["/error/l2", "/error/h1", "/error/energy", "/error/max"];

/// How many rows without a counterpart are named when changes are printed.
const FIRST: usize = 5;

/// Changes against a baseline.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Changes {
    /// One line for every number that changed.
    pub changed: Vec<String>,
    /// Rows of the baseline that are not in the report.
    pub missing: Vec<String>,
    /// Rows of the report that are not in the baseline.
    pub new: Vec<String>,
    /// How many rows were compared.
    pub compared: usize,
}

impl fmt::Display for Changes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (n, k) = (self.compared, self.changed.len());
        writeln!(f, "against the baseline: {n} rows compared, {k} numbers changed")?;
        self.changed.iter().try_for_each(|line| writeln!(f, "  changed: {line}"))?;
        for (kind, lines) in [("not run now", &self.missing), ("new", &self.new)] {
            lines.iter().take(FIRST).try_for_each(|line| writeln!(f, "  {kind}: {line}"))?;
            if lines.len() > FIRST {
                writeln!(f, "  {kind}: {} more", lines.len() - FIRST)?;
            }
        }
        Ok(())
    }
}

/// Compares a report with an earlier one, given as the JSON it wrote. Errors differ if they do so
/// by more than the square root of the rounding of their precision, relative to their size.
///
/// # Errors
/// [`Error::Parameter`] if the text is no report.
pub fn changes(baseline: &str, report: &WorkReport) -> Result<Changes, Error> {
    let no_report = |value: String| Error::Parameter {
        parameter: "baseline",
        value,
        allowed: "must be a report.json of this program".to_owned(),
    };
    let old: Value = serde_json::from_str(baseline).map_err(|e| no_report(e.to_string()))?;
    let old = old["rows"].as_array().ok_or_else(|| no_report("no rows".to_owned()))?;
    // plain data with string keys: its serialisation cannot fail
    let new: Vec<Value> =
        report.rows.iter().map(|m| serde_json::to_value(m).unwrap_or(Value::Null)).collect();
    let mut changes = Changes::default();
    for before in old {
        match new.iter().find(|now| name(now) == name(before)) {
            None => changes.missing.push(name(before)),
            Some(now) => {
                changes.compared += 1;
                compare(before, now, &mut changes.changed);
            }
        }
    }
    let known = |now: &&Value| old.iter().any(|before| name(before) == name(now));
    changes.new = new.iter().filter(|now| !known(now)).map(name).collect();
    Ok(changes)
}

/// The name of a row.
fn name(row: &Value) -> String {
    let part = |key: &&str| match &row[*key] {
        Value::Null => None,
        Value::String(text) => Some(text.clone()),
        other => Some(format!("{key} {other}")),
    };
    KEYS.iter().filter_map(part).collect::<Vec<_>>().join(", ")
}

fn compare(before: &Value, now: &Value, changed: &mut Vec<String>) {
    let at = |row: &Value, path: &str| row.pointer(path).cloned().unwrap_or(Value::Null);
    let tolerance = match now["precision"].as_str() {
        Some(name) => Precision::by_name(name).unwrap_or_default().epsilon().sqrt(),
        None => f64::EPSILON.sqrt(),
    };
    let mut tell = |path: &str, (a, b): (Value, Value)| {
        let key = path.trim_start_matches('/').replace('/', ".");
        changed.push(format!("{}: {key} was {a}, is {b}", name(now)));
    };
    for path in COUNTS {
        let pair = (at(before, path), at(now, path));
        if pair.0 != pair.1 {
            tell(path, pair);
        }
    }
    for path in NUMBERS {
        let pair = (at(before, path), at(now, path));
        let same = match (pair.0.as_f64(), pair.1.as_f64()) {
            (Some(a), Some(b)) => (a - b).abs() <= tolerance * a.abs().max(b.abs()),
            (a, b) => a == b,
        };
        if !same {
            tell(path, pair);
        }
    }
}
