//! A criterion of the stability study, with its limits.

use super::row::{ExpectedRange, short};

/// A condition on figures: every run of the study has at least one row for it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Criterion {
    /// Name of the criterion.
    pub name: &'static str,
    /// The limits. A row has the first one unless its case says which; without limits figures are only reported.
    pub limits: &'static [ExpectedRange],
    /// The condition, with `{}` in place of the limits, in their order.
    template: &'static str,
}

impl Criterion {
    pub(crate) const fn new(
        name: &'static str,
        limits: &'static [ExpectedRange],
        template: &'static str,
    ) -> Self {
        Self { name, limits, template }
    }

    /// The condition, in a sentence.
    pub fn sentence(&self) -> String {
        let number = |range: &ExpectedRange| range.at_most.or(range.at_least).map(short);
        let fill = |text: String, number: String| text.replacen("{}", &number, 1);
        self.limits.iter().filter_map(number).fold(self.template.to_owned(), fill)
    }
}
