//! The columns of the file of figures, and by how much a figure may differ on another machine.

use serde_json::Value;

/// What a column holds.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// A word or a number that is the same everywhere.
    Word,
    /// A count that is the same everywhere, but within two in rows where gap and multiplier vanish together.
    Count,
    /// A figure, or several with names, with a rounding error that the row states under this pointer.
    Figure(&'static str),
}

/// A column: its name and where its value is in a row of a report.
pub struct Column {
    pub name: &'static str,
    pointer: &'static str,
    pub kind: Kind,
}

const fn column(name: &'static str, pointer: &'static str, kind: Kind) -> Column {
    Column { name, pointer, kind }
}

const OF_VALUES: Kind = Kind::Figure("/rounding/error/max");
const OF_GRADIENTS: Kind = Kind::Figure("/rounding/error/broken_energy");
const OF_FORCES: Kind = Kind::Figure("/rounding/force");

pub const COLUMNS: &[Column] = &[
    column("status", "/status", Kind::Word),
    column("unknowns", "/unknowns", Kind::Word),
    column("nonzeros", "/nonzeros", Kind::Word),
    column("active", "/active", Kind::Count),
    column("stages", "/iterations/stages", Kind::Word),
    column("outer", "/iterations/outer", Kind::Count),
    column("energy", "/energy", Kind::Figure("/rounding/energy")),
    column("l2", "/error/l2", Kind::Figure("/rounding/error/l2")),
    column("h1", "/error/h1", Kind::Figure("/rounding/error/h1")),
    column("max", "/error/max", OF_VALUES),
    column("broken-energy", "/error/broken_energy", OF_GRADIENTS),
    column("total", "/bound/total", OF_GRADIENTS),
    column("distance", "/bound/distance", OF_GRADIENTS),
    column("discrete", "/bound/discrete", OF_GRADIENTS),
    column("guaranteed", "/bound/guaranteed", Kind::Word),
    column("penetration", "/penetration", OF_VALUES),
    column("contact", "/contact_measure", Kind::Figure("")),
    column("resultant", "/resultant", OF_FORCES),
    column("resultants", "/resultants", OF_FORCES),
    column("multiplier-l1", "/multiplier_l1", OF_FORCES),
    column("warnings", "/warnings", Kind::Word),
    column("certified", "/certificate", Kind::Word),
];

impl Column {
    /// The value in a row as text; a certificate as whether its violations are within a limit.
    pub fn text(&self, row: &Value, limit: f64) -> String {
        match (self.name, row.pointer(self.pointer)) {
            (_, None | Some(Value::Null)) => String::new(),
            ("certified", Some(Value::Object(violations))) => {
                let is_within =
                    |name: &&str| violations[*name].as_f64().is_some_and(|v| v <= limit);
                let names = ["feasibility", "multiplier", "complementarity", "residual"];
                if names.iter().all(is_within) { "yes" } else { "no" }.to_owned()
            }
            ("warnings", Some(Value::Array(warnings))) => warnings.len().to_string(),
            (_, Some(Value::Array(stages))) => {
                let names = stages.iter().map(|stage| stage["stage"].as_str().unwrap());
                names.collect::<Vec<_>>().join("+")
            }
            (_, Some(Value::Object(parts))) => {
                let part = |(name, value): (&String, &Value)| format!("{name}={value}");
                parts.iter().map(part).collect::<Vec<_>>().join(" ")
            }
            (_, Some(Value::String(word))) => word.clone(),
            (_, Some(value)) => value.to_string(),
        }
    }

    /// The rounding error that a row states for its figure in the column.
    pub fn rounding(&self, row: &Value) -> f64 {
        match self.kind {
            Kind::Figure(pointer) => row.pointer(pointer).and_then(Value::as_f64).unwrap_or(0.0),
            Kind::Word | Kind::Count => 0.0,
        }
    }
}
