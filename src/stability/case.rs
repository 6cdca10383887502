//! A case of the stability study as a table: schemes at the places of a sweep, and the figures of every run.

use super::Stability;
use super::at::At;
use super::row::ExpectedRange;
use crate::error::Error;
use crate::real::Precision;
use crate::scenes::AnyScene;
use crate::scheme::NamedScheme;
use crate::study::Row;

/// A hard case: what is judged, and the sweeps that are run for it.
pub(crate) struct Case {
    pub name: &'static str,
    pub criteria: &'static [Criterion],
    pub sweeps: fn(&Stability<'_>) -> Result<Vec<Sweep>, Error>,
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
    /// The coarsest meshes: figures mean little, but every criterion has its rows.
    Trial,
    /// Coarse meshes and few places of each sweep; every criterion has its rows.
    #[default]
    Quick,
    /// All sweeps.
    Full,
}

impl Effort {
    /// One of three: the first for a trial, the last for all sweeps.
    pub(crate) fn pick<T>(self, of: [T; 3]) -> T {
        let [trial, quick, full] = of;
        match self {
            Self::Trial => trial,
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
    /// Whether schemes start without contact and without coarser levels.
    pub is_cold: bool,
    /// Whether every scheme runs with the interior point method too.
    pub has_interior_point: bool,
    pub columns: Vec<Column>,
}

/// A scheme that a case names.
pub(crate) fn scheme(name: &str) -> NamedScheme {
    name.parse().expect("cases name schemes that exist")
}

/// Schemes that a case names, separated by blanks.
pub(crate) fn schemes(names: &str) -> Vec<NamedScheme> {
    names.split_whitespace().map(scheme).collect()
}

/// A scheme with powers of ten as its over-penalty factor `eta`.
pub(crate) fn with_eta(name: &str, exponents: &[i32]) -> Vec<NamedScheme> {
    exponents.iter().map(|exponent| scheme(&format!("{name}@eta=1e{exponent}"))).collect()
}

/// A place of a sweep.
pub(crate) struct Place {
    pub scene: AnyScene,
    /// The level of the study.
    pub level: usize,
    /// The level that rows show: subdivisions, also of a mesh that is made by hand.
    pub shown: Option<usize>,
    /// The value of the parameter.
    pub value: Option<f64>,
    /// The scalar of assembly and solve.
    pub precision: Precision,
    /// What is said of the place before the figures of a run.
    pub note: String,
}

impl Place {
    /// A scene on a level.
    pub fn new(scene: impl Into<AnyScene>, level: usize) -> Self {
        Self {
            scene: scene.into(),
            level,
            shown: Some(level),
            value: None,
            precision: Precision::Double,
            note: String::new(),
        }
    }
    /// A scene whose domain is a mesh, for which rows show this level.
    pub fn on_mesh(scene: impl Into<AnyScene>, shown: Option<usize>) -> Self {
        Self { shown, ..Self::new(scene, 0) }
    }
    /// At a value of the parameter.
    pub fn at(self, value: f64) -> Self {
        Self { value: Some(value), ..self }
    }
    /// In a precision.
    pub fn precision(self, precision: Precision) -> Self {
        Self { precision, ..self }
    }
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
    /// Further figures in words.
    pub detail: Of<String>,
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
            detail: Box::new(|at| at.figures()),
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
            detail: Box::new(move |at| at.fitted_errors(error)),
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
    /// Sets the further figures in words.
    pub fn detail(self, detail: impl Fn(&At<'_>) -> String + 'static) -> Self {
        Self { detail: Box::new(detail), ..self }
    }
    /// Sets what is asked of the figure.
    pub fn asked(self, asked: impl Fn(&At<'_>) -> Asked + 'static) -> Self {
        Self { asked: Box::new(asked), ..self }
    }
}

/// A norm of the error by name.
pub(crate) type Norm = (&'static str, fn(&Row) -> Option<f64>);

pub(crate) const L2: Norm = ("L2", |row| row.error.l2);
pub(crate) const H1: Norm = ("H1", |row| row.error.h1);
pub(crate) const ENERGY: Norm = ("energy", |row| row.error.energy);
/// The jump seminorm: the penalty's part of the energy norm.
pub(crate) const JUMPS: Norm = ("jumps", |row| {
    let (energy, h1) = (row.error.energy?, row.error.h1?);
    Some((energy * energy - h1 * h1).max(0.0).sqrt())
});
