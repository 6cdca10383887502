//! Schemes as users write them: name, placement of bounds, choices.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use super::{SCHEMES, Scheme, SchemeOptions, keys_of_scheme, scheme_by_name};
use crate::constraint::{CONSTRAINT_SETS, ConstraintSet, Nodes, constraint_set_by_name};
use crate::input::excerpt;

/// A scheme as users write it, `NAME[:PLACEMENT][@KEY=VALUE[,KEY=VALUE...]]`: for instance
/// `wopsip:facet-means@factor=10,weight=anisotropic`. The keys are the fields of [`SchemeOptions`];
/// [`keys_of_scheme`] says which of them a scheme takes. Displayed as its label, in which nothing
/// stands that is default, so that two ways to write one scheme have one label.
///
/// ```
/// use unilateral::scheme::NamedScheme;
/// let schemes = NamedScheme::list(["sipg@factor=1.50", "br2@factor=2", "lifts=full"]).unwrap();
/// assert_eq!(schemes.iter().map(|s| s.to_string()).collect::<Vec<_>>(), ["sipg", "br2@factor=2,lifts=full"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedScheme {
    name: &'static str,
    placement: Option<&'static str>,
    options: SchemeOptions,
}

/// Why a scheme as a user wrote it cannot be made: what is wrong, where, and what may stand there.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SchemeNameError(String);

/// The error about what was written.
fn wrong(text: &str, what: impl fmt::Display) -> SchemeNameError {
    SchemeNameError(format!("{}: {what}", excerpt(text)))
}

fn names(known: &[(&str, &str)]) -> String {
    known.iter().map(|entry| entry.0).collect::<Vec<_>>().join(", ")
}

impl FromStr for NamedScheme {
    type Err = SchemeNameError;

    fn from_str(text: &str) -> Result<Self, SchemeNameError> {
        let (head, choices) = match text.split_once('@') {
            Some((head, choices)) => (head, Some(choices)),
            None => (text, None),
        };
        let (name, placement) = match head.split_once(':') {
            Some((name, placement)) => (name, Some(placement)),
            None => (head, None),
        };
        let Some(&(name, _)) = SCHEMES.iter().find(|known| known.0 == name) else {
            let known = names(SCHEMES);
            let message = format!("unknown scheme {:?}; there are: {known}", excerpt(name));
            return Err(SchemeNameError(message));
        };
        let mut scheme = Self::plain(name);
        if let Some(placement) = placement {
            scheme.placement = Some(scheme.placed(text, placement)?);
        }
        for choice in choices.into_iter().flat_map(|choices| choices.split(',')) {
            scheme.choose(text, choice)?;
        }
        Ok(scheme)
    }
}

impl fmt::Display for NamedScheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let set = self.constraint_set().unwrap_or_else(|| Arc::new(Nodes));
        f.write_str(&self.make::<2>().label_on(&set))
    }
}

impl NamedScheme {
    /// The schemes of a list that was cut at its commas, each label once: an item with `=` and without
    /// `@` continues the scheme before it, `all` stands for every scheme with its own choices.
    ///
    /// # Errors
    /// [`SchemeNameError`], for the first item that is wrong.
    pub fn list<'t>(
        items: impl IntoIterator<Item = &'t str>,
    ) -> Result<Vec<Self>, SchemeNameError> {
        let mut texts: Vec<String> = Vec::new();
        for item in items {
            match texts.last_mut() {
                Some(text) if item.contains('=') && !item.contains('@') => {
                    let sign = if text.contains('@') { ',' } else { '@' };
                    *text += &format!("{sign}{item}");
                }
                _ => texts.push(item.to_owned()),
            }
        }
        let mut schemes: Vec<Self> = Vec::new();
        for text in texts {
            let found = if text == "all" { Self::all() } else { vec![text.parse()?] };
            for scheme in found {
                if schemes.iter().all(|known| known.to_string() != scheme.to_string()) {
                    schemes.push(scheme);
                }
            }
        }
        Ok(schemes)
    }
    /// Every scheme with its own choices.
    pub fn all() -> Vec<Self> {
        SCHEMES.iter().map(|known| Self::plain(known.0)).collect()
    }
    /// The scheme of a name with its own choices.
    fn plain(name: &'static str) -> Self {
        Self { name, placement: None, options: SchemeOptions::default() }
    }
    /// The name of the scheme, without placement and choices.
    pub const fn name(&self) -> &'static str {
        self.name
    }
    /// The choices written.
    pub fn options(&self) -> &SchemeOptions {
        &self.options
    }
    /// The label without choices: the name, with the placement of bounds if that is not the default.
    #[cfg(feature = "report")]
    pub(crate) fn label_without_choices(&self) -> String {
        Self { options: SchemeOptions::default(), ..*self }.to_string()
    }
    /// The scheme with the penalty of these options if none is written and the scheme takes it.
    #[must_use]
    pub fn or_penalty(mut self, options: &SchemeOptions) -> Self {
        if !self.options.has_penalty() {
            let takes = |key: &str| keys_of_scheme(self.name).contains(&key);
            self.options.factor = options.factor.filter(|_| takes("factor"));
            self.options.eta = options.eta.filter(|_| takes("eta"));
            self.options.sigma = options.sigma.filter(|_| takes("sigma"));
        }
        self
    }
    /// The scheme with this placement of bounds if none is written and its element has such values.
    #[must_use]
    pub fn or_placement(mut self, placement: &str) -> Self {
        self.placement = self.placement.or_else(|| self.placed("", placement).ok());
        self
    }
    /// The scheme.
    pub fn make<const D: usize>(&self) -> Box<dyn Scheme<D>> {
        match scheme_by_name(self.name, &self.options) {
            Some(scheme) => scheme,
            None => unreachable!("the name is one of the list"),
        }
    }
    /// The constraint set of the placement; none if none is chosen.
    pub fn constraint_set(&self) -> Option<Arc<dyn ConstraintSet>> {
        self.placement.and_then(constraint_set_by_name)
    }

    /// The placement of this name, if the element has such values.
    fn placed(&self, text: &str, placement: &str) -> Result<&'static str, SchemeNameError> {
        let scheme = self.make::<2>();
        let fits = |name: &str| {
            constraint_set_by_name(name).is_some_and(|set| scheme.constraint_on(&set).is_some())
        };
        match CONSTRAINT_SETS.iter().find(|set| set.0 == placement) {
            None => {
                let (unknown, known) = (excerpt(placement), names(&CONSTRAINT_SETS));
                let what = format!("there is no placement {unknown:?}; there are: {known}");
                Err(wrong(text, what))
            }
            Some(set) if fits(set.0) => Ok(set.0),
            Some(_) => {
                let sets: Vec<_> = CONSTRAINT_SETS.into_iter().filter(|set| fits(set.0)).collect();
                let allowed = names(&sets);
                let what =
                    format!("the element of the scheme has no such values; it has: {allowed}");
                Err(wrong(text, what))
            }
        }
    }
    /// Takes `KEY=VALUE`.
    fn choose(&mut self, text: &str, choice: &str) -> Result<(), SchemeNameError> {
        let (name, takes) = (self.name, keys_of_scheme(self.name));
        let (key, value) = choice.split_once('=').unwrap_or((choice, ""));
        if !takes.contains(&key) {
            let allowed = if takes.is_empty() { "no key".to_owned() } else { takes.join(", ") };
            let what = format!("{name} does not take {:?}; it takes: {allowed}", excerpt(key));
            return Err(wrong(text, what));
        }
        let is_penalty = |key: &str| ["factor", "eta", "sigma"].contains(&key);
        let is_same = |set: &&str| *set == key || is_penalty(set) && is_penalty(key);
        let before = self.options.entries().map(|entry| entry.0).find(is_same);
        if let Some(before) = before {
            let what =
                format!("the keys {before} and {key} choose the same penalty; give one of them");
            return Err(wrong(text, what));
        }
        self.options
            .set(key, value)
            .map_err(|allowed| wrong(text, format_args!("{key} = {}: {allowed}", excerpt(value))))
    }
}
