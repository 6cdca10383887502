//! A report as comma-separated values.

use serde::Serialize;
use serde_json::Value;

/// Values as comma-separated values, one object a line.
pub(crate) fn lines<R: Serialize>(rows: &[R]) -> String {
    let columns_of = |row: &R| {
        let mut columns = Vec::new();
        let value = serde_json::to_value(row).expect("a row is plain data with string keys");
        flatten("", &value, &mut columns);
        columns
    };
    let rows: Vec<Vec<(String, String)>> = rows.iter().map(columns_of).collect();
    let keys = all_keys(&rows);
    let mut text = String::new();
    if !rows.is_empty() {
        push_line(&mut text, keys.iter().copied());
    }
    for row in &rows {
        let of_key = |key: &&str| row.iter().find(|(of, _)| of == key);
        push_line(&mut text, keys.iter().map(|key| of_key(key).map_or("", |(_, cell)| cell)));
    }
    text
}

/// The keys of all rows: those that the first row does not have follow what stands before them in their row.
fn all_keys(rows: &[Vec<(String, String)>]) -> Vec<&str> {
    let mut keys: Vec<&str> = Vec::new();
    for row in rows {
        let mut next = 0;
        for (key, _) in row {
            match keys.iter().position(|known| known == key) {
                Some(place) => next = place + 1,
                None => {
                    keys.insert(next, key);
                    next += 1;
                }
            }
        }
    }
    keys
}

/// The object whose keys differ from row to row: names of contact groups.
const OF_NAMES: &str = "resultants";

/// Keys and cells of a value, depth first; an object of names is one cell.
fn flatten(prefix: &str, value: &Value, columns: &mut Vec<(String, String)>) {
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
        Value::Array(items) => {
            let item = |item: &Value| if item.is_array() { item.to_string() } else { cell(item) };
            items.iter().map(item).collect::<Vec<_>>().join("; ")
        }
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
