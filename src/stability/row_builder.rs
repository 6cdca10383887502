//! Construction of rows, and their figures.

use super::choice::Choice;
use super::criteria::criterion;
use super::row::{ExpectedRange, StabilityRow, Verdict, short};
use crate::measure::fit_order;
use crate::study::Row;

/// A row under construction: criterion, scheme and limits first, then the figure.
#[derive(Clone)]
pub(crate) struct RowBuilder(StabilityRow);

impl RowBuilder {
    /// A row of a scheme for a criterion.
    pub fn new(name: &'static str, choice: &Choice) -> Self {
        Self(StabilityRow {
            case: criterion(name).map_or("", |c| c.case).to_owned(),
            criterion: name.to_owned(),
            scheme: choice.scheme.to_owned(),
            choice: choice.words(),
            precision: "f64".to_owned(),
            problem: String::new(),
            level: None,
            parameter: String::new(),
            value: None,
            quantity: String::new(),
            expected: ExpectedRange::default(),
            measured: None,
            underlying: None,
            underlying_quantity: String::new(),
            detail: String::new(),
            verdict: Verdict::Reported,
            missed_by: None,
        })
    }
    /// Adds a further choice.
    pub fn with(mut self, what: &str) -> Self {
        let comma = if self.0.choice.is_empty() { "" } else { ", " };
        self.0.choice += &format!("{comma}{what}");
        self
    }
    /// On which problem.
    pub fn on(mut self, problem: &str) -> Self {
        self.0.problem = problem.to_owned();
        self
    }
    /// In which precision it is solved.
    pub fn precision(mut self, name: &str) -> Self {
        self.0.precision = name.to_owned();
        self
    }
    /// On which level.
    pub fn level(mut self, level: usize) -> Self {
        self.0.level = Some(level);
        self
    }
    /// At which place of the sweep.
    pub fn at(mut self, parameter: &str, value: f64) -> Self {
        self.0.parameter = parameter.to_owned();
        self.0.value = Some(value);
        self
    }
    /// The quantity that is measured.
    pub fn quantity(mut self, quantity: &str) -> Self {
        self.0.quantity = quantity.to_owned();
        self
    }
    pub fn at_most(mut self, most: f64) -> Self {
        self.0.expected.at_most = Some(most);
        self
    }
    pub fn at_least(mut self, least: f64) -> Self {
        self.0.expected.at_least = Some(least);
        self
    }
    /// Marks a choice that is known to miss the limits.
    pub fn known_to_fail(mut self, to_fail: bool) -> Self {
        self.0.expected.to_fail = to_fail;
        self
    }
    /// Removes the limits, so that the figure is reported without a verdict.
    pub fn only_reported(mut self) -> Self {
        self.0.expected = ExpectedRange::default();
        self
    }
    /// The error or condition number itself, of which the figure is a ratio.
    pub fn underlying(mut self, quantity: &str, value: Option<f64>) -> Self {
        self.0.underlying_quantity = quantity.to_owned();
        self.0.underlying = value;
        self
    }
    /// Further figures.
    pub fn detail(mut self, detail: impl Into<String>) -> Self {
        self.0.detail = detail.into();
        self
    }
    /// The row with this figure.
    pub fn measured(mut self, figure: Option<f64>) -> StabilityRow {
        self.0.measured = figure;
        self.0.judged()
    }
    /// The row of something that does not apply, and why.
    pub fn not_applicable(mut self, why: impl Into<String>) -> StabilityRow {
        self.0.detail = why.into();
        let mut row = self.0.judged();
        row.verdict = Verdict::NotApplicable;
        row
    }
}

/// Errors, iterations and whatever went wrong of a run, in a few words.
pub(crate) fn figures(row: &Row) -> String {
    let mut parts = Vec::new();
    if !row.converged() {
        parts.push(row.status.to_string());
    }
    let errors = [("L2", row.error.l2), ("H1", row.error.h1), ("energy", row.error.energy)];
    parts.extend(errors.iter().filter_map(|(name, e)| e.map(|e| format!("{name} {e:.2e}"))));
    if let Some(outer) = row.iterations.outer.filter(|&n| n > 1) {
        parts.push(format!("{outer} active sets"));
    }
    parts.join(", ")
}

/// A figure of a run that converged.
pub(crate) fn of(row: &Row, figure: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
    if row.converged() { figure(row) } else { None }
}

/// A quotient, where both are there.
pub(crate) fn quotient(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    Some(a? / b?)
}

/// The penalty's part of the error in the energy norm.
pub(crate) fn jump(row: &Row) -> Option<f64> {
    let (energy, h1) = (row.error.energy?, row.error.h1?);
    Some((energy * energy - h1 * h1).max(0.0).sqrt())
}

/// The order fitted to errors on levels; none with fewer than two.
pub(crate) fn fitted_order(errors: &[(usize, f64)]) -> Option<f64> {
    let points: Vec<(f64, f64)> = errors.iter().map(|&(n, e)| (1.0 / n as f64, e)).collect();
    fit_order(&points).map(|fitted| fitted.order)
}

/// Errors on levels in a few words.
pub(crate) fn listed(errors: &[(usize, f64)]) -> String {
    let parts: Vec<String> = errors.iter().map(|(n, e)| format!("{n}: {}", short(*e))).collect();
    parts.join(", ")
}
