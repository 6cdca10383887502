//! A datum as a problem has it: without a name, and by the names of regions or boundary groups.

/// A datum without a name, and data for named regions of cells or named groups of boundary facets.
///
/// A cell in several named groups takes the datum that was given first; a cell in none of them takes
/// the datum without a name. Boundary facets likewise.
#[derive(Clone)]
#[non_exhaustive]
pub struct Given<F> {
    /// The datum without a name.
    pub everywhere: Option<F>,
    /// Data by the name of a region or boundary group, in the order in which they were given.
    pub named: Vec<(String, F)>,
}

impl<F> Given<F> {
    /// Whether there is a datum, with or without a name.
    pub fn is_given(&self) -> bool {
        self.everywhere.is_some() || !self.named.is_empty()
    }
    /// The names that have data.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.named.iter().map(|(name, _)| &name[..])
    }
    /// The position of the first datum that has one of these names.
    pub(super) fn position(&self, names: &[String]) -> Option<usize> {
        self.names().position(|name| names.iter().any(|n| n == name))
    }
    /// The datum of a group with these names.
    pub(super) fn of(&self, names: &[String]) -> Option<&F> {
        self.position(names).map(|k| &self.named[k].1).or(self.everywhere.as_ref())
    }
    /// Gives a datum to a named group, or without a name.
    pub(crate) fn give(&mut self, name: Option<&str>, datum: F) {
        match name {
            Some(name) => self.named.push((name.to_owned(), datum)),
            None => self.everywhere = Some(datum),
        }
    }
}

impl<F> Default for Given<F> {
    fn default() -> Self {
        Self { everywhere: None, named: Vec::new() }
    }
}

impl<F> From<F> for Given<F> {
    fn from(datum: F) -> Self {
        Self { everywhere: Some(datum), named: Vec::new() }
    }
}
