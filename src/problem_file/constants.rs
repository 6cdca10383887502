//! The constants of a problem file: numbers by name, which a caller may replace.

use toml::de::DeTable;

use super::error::{ProblemFileError, ProblemFileErrorKind};
use super::expression::{Names, use_of_name};
use super::formula::Formula;
use super::table::{Constants, Source, Value};
use crate::input::excerpt;

/// Every combination of one value for each name, the last name varying fastest.
pub(super) fn combinations(given: &[(String, Vec<f64>)]) -> Vec<Constants> {
    given.iter().fold(vec![Vec::new()], |all, (name, values)| {
        let with =
            |before: &Constants, value: f64| [&before[..], &[(name.clone(), value)]].concat();
        all.iter().flat_map(|before| values.iter().map(|&value| with(before, value))).collect()
    })
}

/// The end of the name of a problem in a sweep: the constants with several values, `[load=2,width=0.5]`.
pub(super) fn suffix(given: &[(String, Vec<f64>)], chosen: &Constants) -> String {
    let varies = |name: &str| given.iter().any(|(of, values)| of == name && values.len() > 1);
    let varying = chosen.iter().filter(|(name, _)| varies(name));
    let words: Vec<String> = varying.map(|(name, x)| format!("{name}={}", in_words(*x))).collect();
    if words.is_empty() { String::new() } else { format!("[{}]", words.join(",")) }
}

/// The shortest digits that read back to the number, of a whole one without a point: no two numbers share them.
fn in_words(x: f64) -> String {
    let digits = format!("{x:?}");
    digits.strip_suffix(".0").unwrap_or(&digits).to_owned()
}

impl<'t> Source<'t> {
    /// Reads the constants of the file, each from those above it; `given` ones replace values of the file.
    pub fn read_constants(
        &mut self,
        root: &DeTable<'t>,
        given: &Constants,
    ) -> Result<(), ProblemFileError> {
        let kind = ProblemFileErrorKind::Text;
        let none = DeTable::new();
        let (table, offset) = match root.get("constants") {
            Some(value) => (self.table("constants", value)?, value.span().start),
            None => (&none, 0),
        };
        let names: Vec<String> = table.keys().map(|key| key.get_ref().to_string()).collect();
        if let Some((name, _)) = given.iter().find(|(name, _)| !names.contains(name)) {
            let known = match &names[..] {
                [] => "the file has no [constants]".to_owned(),
                some => format!("[constants] has {}", some.join(", ")),
            };
            let message = format!("there is no constant `{}` to set: {known}", excerpt(name));
            return Err(self.error(offset, kind, message));
        }
        for (k, (key, value)) in table.iter().enumerate() {
            let name = &names[k];
            if let Some(taken) = use_of_name(name) {
                let message = format!("a constant cannot be called `{}`: {taken}", excerpt(name));
                return Err(self.error(key.span().start, kind, message));
            }
            let own = self.constant(name, value, &names[k..])?;
            let found = given.iter().find(|(of, _)| of == name).map_or(own, |(_, x)| *x);
            if !found.is_finite() {
                let message = format!("the constant `{name}` is {found}: it must be finite");
                return Err(self.error(value.span().start, kind, message));
            }
            self.constants.push((name.clone(), found));
        }
        Ok(())
    }

    /// The value of a constant in the file; those from its own on are not known yet.
    fn constant(
        &self,
        name: &str,
        value: &Value<'t>,
        below: &[String],
    ) -> Result<f64, ProblemFileError> {
        let names = Names { variables: &[], constants: &self.constants, below };
        match self.formula_of(name, value, names)? {
            Formula::Number(x) => Ok(x),
            Formula::Expression(_) => Err(self.wrong_type(name, value, "a number")),
        }
    }
}
