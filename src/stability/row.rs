//! A row: a figure, its expected range, and the verdict.

use serde::Serialize;

use crate::table::Cell;

/// The range of a figure that a criterion asks for. A figure without limits is reported and not
/// judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ExpectedRange {
    /// The smallest figure allowed.
    pub at_least: Option<f64>,
    /// The largest figure allowed.
    pub at_most: Option<f64>,
    /// Whether the choice is shown because theory or experience says that it misses the range.
    pub to_fail: bool,
}

impl ExpectedRange {
    pub(crate) const fn at_least(least: f64) -> Self {
        Self { at_least: Some(least), at_most: None, to_fail: false }
    }
    pub(crate) const fn at_most(most: f64) -> Self {
        Self { at_least: None, at_most: Some(most), to_fail: false }
    }
    /// Around one: at most this factor above or below.
    pub(crate) const fn within(factor: f64) -> Self {
        Self { at_least: Some(1.0 / factor), at_most: Some(factor), to_fail: false }
    }

    /// Whether a figure lies in the range; a figure that is not finite does not.
    pub fn holds(&self, figure: f64) -> bool {
        figure.is_finite()
            && self.at_least.is_none_or(|least| figure >= least)
            && self.at_most.is_none_or(|most| figure <= most)
    }

    fn is_judged(&self) -> bool {
        self.at_least.is_some() || self.at_most.is_some()
    }

    /// The limits in a few characters.
    pub fn words(&self) -> String {
        match (self.at_least, self.at_most) {
            (Some(least), Some(most)) => format!("{} to {}", short(least), short(most)),
            (Some(least), None) => format!("at least {}", short(least)),
            (None, Some(most)) => format!("at most {}", short(most)),
            (None, None) => "-".to_owned(),
        }
    }
}

/// A number with a power of ten only where it needs one.
fn short(x: f64) -> String {
    match x.abs() {
        size if size > 0.0 && !(1e-2..1e4).contains(&size) => format!("{x:e}"),
        _ => ((x * 1e3).round() / 1e3).to_string(),
    }
}

/// The verdict on a figure and its expected range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The figure lies in the range.
    Met,
    /// The figure lies outside the range, or there is none because the solve failed.
    Missed,
    /// The figure lies outside the range, as was expected of this choice.
    FailsAsExpected,
    /// The figure lies in the range, though that was not expected of this choice.
    BetterThanExpected,
    /// There is no expected range.
    Reported,
}

impl Verdict {
    /// All, in the order of summaries.
    pub const ALL: [Self; 5] =
        [Self::Met, Self::Missed, Self::FailsAsExpected, Self::BetterThanExpected, Self::Reported];

    /// The words of reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::Missed => "missed",
            Self::FailsAsExpected => "fails as expected",
            Self::BetterThanExpected => "better than expected",
            Self::Reported => "reported",
        }
    }

    /// The verdict on a figure, or on its absence after a failed solve.
    pub fn on(expected: &ExpectedRange, measured: Option<f64>) -> Self {
        if !expected.is_judged() {
            return Self::Reported;
        }
        match (measured.is_some_and(|figure| expected.holds(figure)), expected.to_fail) {
            (true, false) => Self::Met,
            (true, true) => Self::BetterThanExpected,
            (false, false) => Self::Missed,
            (false, true) => Self::FailsAsExpected,
        }
    }
}

/// One figure of one scheme at one place of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct StabilityRow {
    /// Name of the case.
    pub case: String,
    /// Name of the criterion; see [`criteria`](crate::stability::criteria).
    pub criterion: String,
    /// The scheme, with the placement of its bounds after a colon if it is not the default.
    pub scheme: String,
    /// The scheme with its choices, as users write it: what distinguishes the penalties of a scheme.
    pub label: String,
    /// Scalar of assembly and solve.
    pub precision: String,
    /// Scene or problem.
    pub problem: String,
    /// Subdivisions of the shortest side, where the mesh has such a number.
    pub level: Option<usize>,
    /// Name of the parameter of the sweep.
    pub parameter: String,
    /// Value of that parameter.
    pub value: Option<f64>,
    /// Name of the measured quantity.
    pub quantity: String,
    /// The expected range.
    pub expected: ExpectedRange,
    /// The figure; none if nothing was solved.
    pub measured: Option<f64>,
    /// Further figures.
    pub detail: String,
    /// The verdict on figure and range.
    pub verdict: Verdict,
}

impl StabilityRow {
    /// The cells of a table of rows that miss their range.
    pub(super) fn cells(&self) -> Vec<Cell> {
        let place = self.value.map(|value| format!("{} {}", self.parameter, short(value)));
        vec![
            Cell::Words(self.criterion.clone()),
            Cell::Words(self.label.clone()),
            Cell::Words(format!("{} {}", self.problem, self.precision)),
            Cell::whole(self.level),
            Cell::Words(place.unwrap_or_default()),
            Cell::Words(self.quantity.clone()),
            Cell::Words(self.expected.words()),
            Cell::digits(self.measured, 3),
            Cell::Words(self.detail.clone()),
        ]
    }

    /// The label, of a sweep of a penalty factor without its value: `wopsip@eta`.
    pub(super) fn series(&self) -> String {
        match self.parameter == "eta" || self.parameter == "sigma" {
            true => format!("{}@{}", self.scheme, self.parameter),
            false => self.label.clone(),
        }
    }
}
