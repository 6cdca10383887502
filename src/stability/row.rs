//! A row: a figure, its expected range, and the verdict.

use serde::Serialize;

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

    /// The factor by which a figure misses the range; none for a limit of zero and for a figure
    /// that is not positive or not a number.
    pub fn missed_by(&self, figure: f64) -> Option<f64> {
        if self.holds(figure) || figure.is_nan() {
            return None;
        }
        let factor = match (self.at_least, self.at_most) {
            (Some(least), _) if figure < least => least / figure,
            (_, Some(most)) => figure / most,
            _ => return None,
        };
        (factor.is_finite() && factor > 0.0).then_some(factor)
    }

    /// A figure with as many digits as it takes to see on which side of a limit it lies, three at
    /// least.
    pub fn deciding(&self, figure: f64) -> String {
        let texts = (0..15).map(|more| with_digits(figure, more));
        let agrees = |text: &String| {
            text.parse().is_ok_and(|read: f64| self.holds(read) == self.holds(figure))
        };
        texts.into_iter().find(agrees).unwrap_or_else(|| short(figure))
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

/// A number in three digits, without a power of ten where it needs none.
pub(crate) fn short(x: f64) -> String {
    with_digits(x, 0)
}

/// A number in three digits and some `more`, without a power of ten where the number needs none.
fn with_digits(x: f64, more: usize) -> String {
    let trimmed = |digits: &str| digits.trim_end_matches('0').trim_end_matches('.').to_owned();
    let places = match x.abs() {
        0.0 => return "0".to_owned(),
        a if !(1e-2..1e4).contains(&a) => {
            let text = format!("{x:.*e}", 2 + more);
            let (digits, power) = text.split_once('e').expect("the format has a power");
            return format!("{}e{power}", trimmed(digits));
        }
        a if a >= 100.0 => 1,
        a if a >= 10.0 => 2,
        _ => 3,
    };
    trimmed(&format!("{x:.*}", places + more))
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
    /// The factor by which the limit is missed, if there is one.
    pub missed_by: Option<f64>,
}

impl StabilityRow {
    /// The verdict in words, with the factor by which a limit is missed.
    pub fn verdict_words(&self) -> String {
        match (self.verdict, self.missed_by, self.measured) {
            (Verdict::Missed | Verdict::FailsAsExpected, Some(factor), _) => {
                format!("{} (factor {})", self.verdict.name(), factor_in_words(factor))
            }
            (Verdict::Missed | Verdict::FailsAsExpected, None, None) => {
                format!("{} (no figure)", self.verdict.name())
            }
            _ => self.verdict.name().to_owned(),
        }
    }

    /// The place of the sweep in words; empty without a sweep.
    pub(crate) fn place(&self) -> String {
        self.value.map_or_else(String::new, |value| format!("{} {}", self.parameter, short(value)))
    }

    /// The label, of a sweep of a penalty factor without its value: `wopsip@eta`.
    pub(crate) fn series(&self) -> String {
        match self.parameter == "eta" || self.parameter == "sigma" {
            true => format!("{}@{}", self.scheme, self.parameter),
            false => self.label.clone(),
        }
    }

    /// The figure, with the digit that decides.
    pub(crate) fn figure_in_words(&self) -> Option<String> {
        self.measured.map(|figure| self.expected.deciding(figure))
    }
}

/// A factor by which a limit is missed, with as many digits as it takes to see that it is above one.
pub(crate) fn factor_in_words(factor: f64) -> String {
    ExpectedRange::at_most(1.0).deciding(factor)
}
