//! Measurements of the laws that hold.

use std::fmt;

use super::error::Law;

/// What was measured of a law that holds. `Display` is a line of a [`KitReport`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LawReport {
    /// The law.
    pub law: Law,
    /// The figures by name, as the variants of [`Law`] list them.
    pub figures: Vec<(&'static str, f64)>,
    sentence: String,
}

impl LawReport {
    pub(super) fn new(law: Law, sentence: String, figures: &[(&'static str, f64)]) -> Self {
        Self { law, figures: figures.to_vec(), sentence }
    }
    /// The figure of a name; none for one that is not measured.
    pub fn figure(&self, name: &str) -> Option<f64> {
        self.figures.iter().find(|figure| figure.0 == name).map(|figure| figure.1)
    }
}

impl fmt::Display for LawReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:<13}{}", self.law, self.sentence)
    }
}

/// Measurements of all laws.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct KitReport {
    /// Name of the scheme.
    pub scheme: String,
    /// Dimension of space.
    pub dimension: usize,
    /// The laws, in the order in which they are tested.
    pub laws: Vec<LawReport>,
}

impl KitReport {
    /// A figure of a law; none for one that is not measured.
    pub fn figure(&self, law: Law, name: &str) -> Option<f64> {
        self.laws.iter().find(|report| report.law == law)?.figure(name)
    }
}

impl fmt::Display for KitReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} in {} dimensions", self.scheme, self.dimension)?;
        self.laws.iter().try_for_each(|law| writeln!(f, "  {law}"))
    }
}
