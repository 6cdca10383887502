//! A case of the stability study as a table: schemes at the places of a sweep, and the figures of every run.

use super::at::At;
use super::place::{Norm, Place};
use super::row::ExpectedRange;
use crate::error::Error;
use crate::mesh::Mesh;
use crate::scheme::NamedScheme;
use crate::study::Row;

/// A hard case: what is judged, and the sweeps that are run for it.
pub(crate) struct Case {
    pub name: &'static str,
    pub criteria: &'static [Criterion],
    pub sweeps: fn(&Plan<'_>) -> Result<Vec<Sweep>, Error>,
}

/// What a study asks of its cases.
pub(crate) struct Plan<'p> {
    pub effort: Effort,
    /// Meshes that users give, with their names.
    pub meshes: &'p [(String, Mesh<3>)],
}

/// A condition on figures: every run of the study has at least one row for it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Criterion {
    /// Name of the criterion.
    pub name: &'static str,
    /// The limits. A row has the first one unless its case says which; without limits figures are only reported.
    pub limits: &'static [ExpectedRange],
    /// The condition with its limits, in a sentence.
    pub sentence: &'static str,
}

impl Criterion {
    pub(crate) const fn new(
        name: &'static str,
        limits: &'static [ExpectedRange],
        sentence: &'static str,
    ) -> Self {
        Self { name, limits, sentence }
    }
}

/// How many meshes and values of each sweep are run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// Coarse meshes and few places of each sweep; every criterion has its rows.
    #[default]
    Quick,
    /// All sweeps.
    Full,
}

impl Effort {
    /// One of two: the first for the quick study, the last for all sweeps.
    pub(crate) fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }
}

/// Schemes at the places of a sweep. Each scheme has a study at each place.
#[derive(Default)]
pub(crate) struct Sweep {
    /// Whether the schemes that every case compares are among those judged.
    pub compares: bool,
    /// The further schemes that are judged.
    pub schemes: Vec<NamedScheme>,
    /// Schemes that figures of the others refer to.
    pub beside: Vec<NamedScheme>,
    /// The name of the parameter. The value of `eta` or `sigma` is that of the scheme, others are those of places.
    pub parameter: &'static str,
    pub places: Vec<Place>,
    pub columns: Vec<Column>,
}

/// What a criterion asks of a figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Asked {
    /// The limit of this number.
    Limit(usize),
    /// To miss the limit of this number, as theory or experience says.
    Failure(usize),
    /// To be reported without a verdict.
    Report,
    /// Nothing: there is no row.
    NoRow,
}

impl Asked {
    /// The first limit, or to miss it.
    pub fn limit_unless(to_fail: bool) -> Self {
        if to_fail { Self::Failure(0) } else { Self::Limit(0) }
    }
}

/// A function of a run.
type Of<T> = Box<dyn Fn(&At<'_>) -> T>;

/// A column of the rows of a sweep: a figure of a run, or of all runs of a scheme, and what is asked of it.
pub(crate) struct Column {
    pub criterion: &'static Criterion,
    pub quantity: String,
    pub figure: Of<Option<f64>>,
    pub asked: Of<Asked>,
    /// Whether the figure is that of all places, which have no level in common.
    pub is_of_all: bool,
}

impl Column {
    /// The figure of each run, which has the first limit of the criterion if that has any.
    pub fn new(
        criterion: &'static Criterion,
        quantity: &str,
        figure: impl Fn(&At<'_>) -> Option<f64> + 'static,
    ) -> Self {
        let by_default = if criterion.limits.is_empty() { Asked::Report } else { Asked::Limit(0) };
        Self {
            criterion,
            quantity: quantity.to_owned(),
            figure: Box::new(figure),
            asked: Box::new(move |_| by_default),
            is_of_all: false,
        }
    }
    /// The order of an error, fitted over all places.
    pub fn fitted(
        criterion: &'static Criterion,
        quantity: &str,
        error: fn(&Row) -> Option<f64>,
        asked: impl Fn(&At<'_>) -> Asked + 'static,
    ) -> Self {
        Self {
            is_of_all: true,
            ..Self::new(criterion, quantity, move |at| at.fitted_order(error)).asked(asked)
        }
    }
    /// The orders of errors, fitted over all places, each with the limit of its number.
    pub fn all_fitted(criterion: &'static Criterion, norms: &[Norm]) -> Vec<Self> {
        let limit = |k| if k < criterion.limits.len() { Asked::Limit(k) } else { Asked::Report };
        let column = |(k, (norm, error)): (usize, &Norm)| {
            let quantity = format!("order in {norm}, fitted");
            Self::fitted(criterion, &quantity, *error, move |_| limit(k))
        };
        norms.iter().enumerate().map(column).collect()
    }
    /// Sets what is asked of the figure.
    pub fn asked(self, asked: impl Fn(&At<'_>) -> Asked + 'static) -> Self {
        Self { asked: Box::new(asked), ..self }
    }
}
