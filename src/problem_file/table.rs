//! Tables and values of a TOML file, with their places.

use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{ProblemFileError, ProblemFileErrorKind};
use super::expression::{Expression, Names};
use super::formula::Formula;
use crate::input::excerpt;
use crate::mesh::gmsh::{GmshError, GmshErrorKind, GmshFile};

/// A value with its place.
pub(super) type Value<'t> = Spanned<DeValue<'t>>;

/// Where the problem of a file is posed.
pub(super) enum Place {
    Box {
        corners: [Vec<f64>; 2],
    },
    /// The offset is that of the name in the problem file.
    File {
        path: PathBuf,
        file: Box<GmshFile>,
        offset: usize,
    },
}

impl Place {
    pub fn dimension(&self) -> usize {
        match self {
            Self::Box { corners } => corners[0].len(),
            Self::File { file, .. } => file.dimension(),
        }
    }
}

/// Constants by name.
pub(super) type Constants = Vec<(String, f64)>;

/// A problem file.
pub(super) struct Source<'t> {
    pub path: &'t Path,
    pub text: &'t str,
    /// Its constants, once they are read.
    pub constants: Constants,
}

type Found<V> = Result<V, ProblemFileError>;

impl<'t> Source<'t> {
    /// The error at an offset in bytes.
    pub fn error(
        &self,
        offset: usize,
        kind: ProblemFileErrorKind,
        message: String,
    ) -> ProblemFileError {
        let place = Some(self.position(offset));
        ProblemFileError { kind, path: self.path.into(), place, message, source: None }
    }

    /// The error for a mesh file that is named at an offset in bytes, with its path once.
    pub fn mesh_error(&self, offset: usize, mesh: &Path, error: GmshError) -> ProblemFileError {
        let message = match error.kind {
            GmshErrorKind::Unreadable => error.to_string(),
            _ => format!("mesh {}: {error}", mesh.display()),
        };
        let at_name = self.error(offset, ProblemFileErrorKind::Mesh, message);
        ProblemFileError { source: Some(Box::new(error)), ..at_name }
    }

    /// The error for a key that is missing in the table at an offset in bytes.
    pub fn missing(&self, offset: usize, key: &str, purpose: &str) -> ProblemFileError {
        let message = format!("`{key}` is missing: {purpose}");
        self.error(offset, ProblemFileErrorKind::Text, message)
    }

    /// The error for a key at an offset in bytes that means nothing.
    fn unknown_key(&self, offset: usize, key: &str, allowed: &str) -> ProblemFileError {
        let message = format!("unknown key `{}`; allowed are {allowed}", excerpt(key));
        self.error(offset, ProblemFileErrorKind::Text, message)
    }

    /// Line and column of an offset in bytes, from one.
    fn position(&self, offset: usize) -> [usize; 2] {
        let offset =
            (0..=offset.min(self.text.len())).rev().find(|&k| self.text.is_char_boundary(k));
        let before = &self.text[..offset.unwrap_or(0)];
        let line_start = before.rfind('\n').map_or(0, |k| k + 1);
        [before.matches('\n').count() + 1, before[line_start..].chars().count() + 1]
    }

    /// The table of the file.
    pub fn root(&self) -> Found<DeTable<'t>> {
        let syntax = |e: toml::de::Error| {
            let offset = e.span().map_or(0, |span| span.start);
            self.error(offset, ProblemFileErrorKind::Text, e.message().to_owned())
        };
        Ok(DeTable::parse(self.text).map_err(syntax)?.into_inner())
    }

    /// Mesh file or box.
    pub fn place(&self, root: &DeTable<'t>) -> Found<Place> {
        let purpose = "the Gmsh file of the domain, or `box` with its two corners";
        match (root.get("mesh"), root.get("box")) {
            (Some(file), None) => self.mesh_file(file),
            (None, Some(corners)) => self.corners(corners),
            (None, None) => Err(self.missing(0, "mesh", purpose)),
            (Some(_), Some(second)) => {
                let allowed = "`mesh` or `box`, not both";
                Err(self.unknown_key(second.span().start, "box", allowed))
            }
        }
    }

    fn mesh_file(&self, value: &Value<'t>) -> Found<Place> {
        let name = self.string("mesh", value)?;
        let path = self.path.parent().unwrap_or(Path::new("")).join(name);
        let offset = value.span().start;
        let file = GmshFile::read(&path).map_err(|e| self.mesh_error(offset, &path, e))?;
        Ok(Place::File { path, file: Box::new(file), offset })
    }

    fn corners(&self, value: &Value<'t>) -> Found<Place> {
        let wrong = || self.wrong_type("box", value, "two corners of one to three numbers each");
        let corner = |corner: &Value<'t>| -> Found<Vec<f64>> {
            let numbers = corner.get_ref().as_array().ok_or_else(wrong)?;
            numbers.iter().map(|x| self.number("box", x)?.ok_or_else(wrong)).collect()
        };
        let corners = value.get_ref().as_array().ok_or_else(wrong)?;
        let corners = corners.iter().map(corner).collect::<Found<Vec<_>>>()?;
        let Ok([lower, upper]) = <[Vec<f64>; 2]>::try_from(corners) else { return Err(wrong()) };
        if lower.len() != upper.len() || !(1..=3).contains(&lower.len()) {
            return Err(wrong());
        }
        let is_side = |(a, b): (&f64, &f64)| (b - a).is_finite() && b > a;
        if !lower.iter().zip(&upper).all(is_side) {
            let expected = "two corners, the first below the second in every coordinate";
            return Err(self.wrong_type("box", value, expected));
        }
        Ok(Place::Box { corners: [lower, upper] })
    }

    /// Refuses a key that is not in the list.
    pub fn allow(&self, table: &DeTable<'t>, allowed: &[&str]) -> Found<()> {
        match table.keys().find(|key| !allowed.contains(&&**key.get_ref())) {
            Some(key) => {
                Err(self.unknown_key(key.span().start, key.get_ref(), &allowed.join(", ")))
            }
            None => Ok(()),
        }
    }

    /// The error for a value of another type.
    pub fn wrong_type(&self, key: &str, value: &Value<'t>, expected: &str) -> ProblemFileError {
        let found = excerpt(&self.text[value.span()]);
        let message = format!("`{key}` must be {expected}, not {found}");
        self.error(value.span().start, ProblemFileErrorKind::Text, message)
    }

    /// A table within a table.
    pub fn table<'v>(&self, key: &str, value: &'v Value<'t>) -> Found<&'v DeTable<'t>> {
        value.get_ref().as_table().ok_or_else(|| self.wrong_type(key, value, "a table"))
    }

    /// A string.
    pub fn string<'v>(&self, key: &str, value: &'v Value<'t>) -> Found<&'v str> {
        value.get_ref().as_str().ok_or_else(|| self.wrong_type(key, value, "a string"))
    }

    /// A number, or an expression in constants; none where the value is neither.
    pub fn number(&self, key: &str, value: &Value<'t>) -> Found<Option<f64>> {
        match value.get_ref() {
            DeValue::Float(_) | DeValue::Integer(_) | DeValue::String(_) => {
                match self.formula(key, value, &[])? {
                    Formula::Number(x) => Ok(Some(x)),
                    Formula::Expression(_) => Ok(None),
                }
            }
            _ => Ok(None),
        }
    }

    fn literal(&self, value: &Value<'t>) -> Option<f64> {
        match value.get_ref() {
            DeValue::Float(float) => float.as_str().parse().ok(),
            DeValue::Integer(integer) => {
                Some(i64::from_str_radix(integer.as_str(), integer.radix()).ok()? as f64)
            }
            _ => None,
        }
    }

    /// A number, or an expression in these variables.
    pub fn formula(&self, key: &str, value: &Value<'t>, variables: &[&str]) -> Found<Formula> {
        let names = Names { variables, constants: &self.constants, below: &[] };
        self.formula_of(key, value, names)
    }
    /// A number, or an expression in these names.
    pub fn formula_of(&self, key: &str, value: &Value<'t>, names: Names<'_>) -> Found<Formula> {
        if let Some(number) = self.literal(value) {
            return Ok(Formula::Number(number));
        }
        let Some(text) = value.get_ref().as_str() else {
            return Err(self.wrong_type(key, value, "a number, or an expression as a string"));
        };
        let expression = Expression::parse(text, names).map_err(|error| {
            let raw = &self.text[value.span()];
            let quotes = raw.len() - raw.trim_start_matches(['"', '\'']).len();
            // an empty string is all quotes
            let quotes = if text.is_empty() { quotes / 2 } else { quotes };
            let offset = value.span().start + quotes + error.offset;
            self.error(offset, ProblemFileErrorKind::Text, error.message)
        })?;
        // constants are integrated exactly
        Ok(expression.constant().map_or(Formula::Expression(expression), Formula::Number))
    }
}
