//! A report as comma-separated values.

use crate::study::row::Row;
use serde::Serialize;
use serde_json::Value;

/// Rows as comma-separated values: see `Report::to_csv`.
pub fn to_csv(rows: &[Row]) -> String {
    lines(rows)
}

/// Values as comma-separated values, one object a line.
pub(crate) fn lines<R: Serialize>(rows: &[R]) -> String {
    let mut text = String::new();
    for (i, row) in rows.iter().enumerate() {
        let mut columns = Vec::new();
        // A row is plain data with string keys: its serialisation cannot fail, and should it ever,
        // the line would be missing and the reader's count of rows tell.
        flatten("", &serde_json::to_value(row).unwrap_or(Value::Null), &mut columns);
        if i == 0 {
            push_line(&mut text, columns.iter().map(|(key, _)| key.as_str()));
        }
        push_line(&mut text, columns.iter().map(|(_, cell)| cell.as_str()));
    }
    text
}

/// The object whose keys differ from row to row: names of contact groups.
const OF_NAMES: &str = "resultants";

/// Keys and cells of a value, depth first; an object of names is one cell.
pub(super) fn flatten(prefix: &str, value: &Value, columns: &mut Vec<(String, String)>) {
    if let Value::Object(map) = value
        && prefix != OF_NAMES
    {
        for (key, inner) in map {
            let joined = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
            flatten(&joined, inner, columns);
        }
    } else {
        columns.push((prefix.to_owned(), cell(value)));
    }
}

/// The text of a value in one cell.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(s) => s.clone(),
        Value::Object(map) => {
            let entry = |(name, value): (&String, &Value)| format!("{name}: {}", cell(value));
            map.iter().map(entry).collect::<Vec<_>>().join("; ")
        }
        Value::Array(items) => items.iter().map(cell).collect::<Vec<_>>().join("; "),
        // Numbers are the shortest digits that read back to the same bits.
        other => other.to_string(),
    }
}

/// A line of cells, quoted where a reader would otherwise see more cells or lines than there are.
fn push_line<'a>(text: &mut String, cells: impl Iterator<Item = &'a str>) {
    for (i, cell) in cells.enumerate() {
        if i > 0 {
            text.push(',');
        }
        let outer_space = cell.trim().len() != cell.len();
        if outer_space || cell.contains(['"', ',', '\n', '\r']) {
            text.push('"');
            text.push_str(&cell.replace('"', "\"\""));
            text.push('"');
        } else {
            text.push_str(cell);
        }
    }
    text.push('\n');
}
