//! A datum as a problem has it: without a name, and by the names of regions or boundary groups.

use std::fmt::Debug;

use super::Datum;

/// The name of all regions, and of all boundary groups: a datum for it is the one without a name.
pub(super) const ALL: &str = "default";

/// A datum without a name, and data for named regions of cells or named groups of boundary facets.
///
/// A cell in several named groups takes the datum that was given first; a cell in none of them takes
/// the datum without a name. Boundary facets likewise. A problem in which a name has two data, or which has two
/// without a name, is not solved: [`Error::GivenTwice`](crate::error::Error::GivenTwice).
#[derive(Clone)]
#[non_exhaustive]
pub struct Given<F> {
    /// The datum without a name.
    pub everywhere: Option<F>,
    /// Data by the name of a region or boundary group, in the order in which they were given.
    pub named: Vec<(String, F)>,
    /// Whether a datum without a name took the place of another.
    is_replaced: bool,
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
    /// Gives a datum to a named group, or without a name where the name is `default`.
    pub(crate) fn give(&mut self, name: &str, datum: F) {
        match name {
            ALL => self.is_replaced |= self.everywhere.replace(datum).is_some(),
            _ => self.named.push((name.to_owned(), datum)),
        }
    }
}

/// A datum of any kind with its names.
pub(super) trait AnyGiven {
    /// The names that have data.
    fn names(&self) -> Vec<&str>;
    /// The datum without a name.
    fn everywhere(&self) -> Option<&dyn Debug>;
    /// The name for which there are two data; `default` for those without a name.
    fn given_twice(&self) -> Option<&str>;
}

impl<F: Debug> AnyGiven for Given<F> {
    fn names(&self) -> Vec<&str> {
        self.names().collect()
    }
    fn everywhere(&self) -> Option<&dyn Debug> {
        self.everywhere.as_ref().map(|datum| datum as _)
    }
    fn given_twice(&self) -> Option<&str> {
        let is_second =
            |k: &usize| self.named[..*k].iter().any(|(name, _)| *name == self.named[*k].0);
        let second = (0..self.named.len()).find(is_second).map(|k| &self.named[k].0[..]);
        second.or(self.is_replaced.then_some(ALL))
    }
}

impl<const D: usize> Given<Datum<D>> {
    /// Adds a datum to that of a named group, or to that without a name.
    pub(super) fn add(&mut self, name: &str, datum: impl Into<Datum<D>>) {
        let known = match name {
            ALL => self.everywhere.as_mut(),
            _ => self.named.iter_mut().find(|known| known.0 == name).map(|known| &mut known.1),
        };
        match known {
            Some(known) => *known = known.plus(datum.into()),
            None => self.give(name, datum.into()),
        }
    }
}

impl<F> Default for Given<F> {
    fn default() -> Self {
        Self { everywhere: None, named: Vec::new(), is_replaced: false }
    }
}

impl<F> From<F> for Given<F> {
    fn from(datum: F) -> Self {
        Self { everywhere: Some(datum), ..Self::default() }
    }
}
