//! Construction of rows, and their figures.

use super::choice::Choice;
use super::criterion::Criterion;
use super::row::{ExpectedRange, StabilityRow, Verdict, short};
use crate::measure::fit_order;
use crate::study::Row;

/// A row under construction, without its case: criterion, scheme and place first, then the figure.
#[derive(Clone)]
pub(crate) struct RowBuilder {
    criterion: &'static Criterion,
    row: StabilityRow,
}

impl RowBuilder {
    /// A row of a scheme for a criterion, with its first limit if it has any.
    pub fn new(criterion: &'static Criterion, choice: &Choice) -> Self {
        let row = StabilityRow {
            case: String::new(),
            criterion: criterion.name.to_owned(),
            scheme: choice.scheme(),
            label: choice.label(),
            precision: "f64".to_owned(),
            problem: String::new(),
            level: None,
            parameter: String::new(),
            value: None,
            quantity: String::new(),
            expected: criterion.limits.first().copied().unwrap_or_default(),
            measured: None,
            underlying: None,
            underlying_quantity: String::new(),
            detail: String::new(),
            verdict: Verdict::Reported,
            missed_by: None,
        };
        Self { criterion, row }
    }
    /// The limit of the criterion with this number.
    pub fn limit(mut self, number: usize) -> Self {
        self.row.expected = self.criterion.limits[number];
        self
    }
    /// Marks a choice that is known to miss the limits.
    pub fn known_to_fail(mut self, to_fail: bool) -> Self {
        self.row.expected.to_fail = to_fail;
        self
    }
    /// Removes the limits if the figure is not judged, so that it is reported without a verdict.
    pub fn judged_if(mut self, is_judged: bool) -> Self {
        if !is_judged {
            self.row.expected = ExpectedRange::default();
        }
        self
    }
    /// On which problem.
    pub fn on(mut self, problem: &str) -> Self {
        self.row.problem = problem.to_owned();
        self
    }
    /// In which precision it is solved.
    pub fn precision(mut self, name: &str) -> Self {
        self.row.precision = name.to_owned();
        self
    }
    /// On which level.
    pub fn level(mut self, level: usize) -> Self {
        self.row.level = Some(level);
        self
    }
    /// At which place of the sweep.
    pub fn at(mut self, parameter: &str, value: f64) -> Self {
        self.row.parameter = parameter.to_owned();
        self.row.value = Some(value);
        self
    }
    /// The quantity that is measured.
    pub fn quantity(mut self, quantity: &str) -> Self {
        self.row.quantity = quantity.to_owned();
        self
    }
    /// The error or condition number itself, of which the figure is a ratio.
    pub fn underlying(mut self, quantity: &str, value: Option<f64>) -> Self {
        self.row.underlying_quantity = quantity.to_owned();
        self.row.underlying = value;
        self
    }
    /// Further figures.
    pub fn detail(mut self, detail: impl Into<String>) -> Self {
        self.row.detail = detail.into();
        self
    }
    /// The row with this figure.
    pub fn measured(mut self, figure: Option<f64>) -> StabilityRow {
        self.row.measured = figure;
        self.row.judged()
    }
    /// The row with the answer to a question: 1 for yes, 0 for no.
    pub fn answered(self, is_so: bool) -> StabilityRow {
        self.measured(Some(f64::from(u8::from(is_so))))
    }
    /// The row with the order fitted to an error over the levels of some rows; none unless all converged.
    pub fn fitted(self, rows: &[Row], error: impl Fn(&Row) -> Option<f64>) -> StabilityRow {
        let errors: Vec<(usize, f64)> =
            rows.iter().filter_map(|row| Some((row.level, of(row, &error)?))).collect();
        let points: Vec<(f64, f64)> = errors.iter().map(|&(n, e)| (1.0 / n as f64, e)).collect();
        let fitted = fit_order(&points).filter(|_| errors.len() == rows.len());
        let listed: Vec<String> =
            errors.iter().map(|(n, e)| format!("{n}: {}", short(*e))).collect();
        self.detail(format!("error {}", listed.join(", "))).measured(fitted.map(|fit| fit.order))
    }
    /// The row of something that does not apply, and why.
    pub fn not_applicable(self, why: impl Into<String>) -> StabilityRow {
        let row = self.judged_if(false).detail(why).row.judged();
        StabilityRow { verdict: Verdict::NotApplicable, ..row }
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

/// The error in the jump seminorm: the penalty's part of the energy norm.
pub(crate) fn jumps(row: &Row) -> Option<f64> {
    let (energy, h1) = (row.error.energy?, row.error.h1?);
    Some((energy * energy - h1 * h1).max(0.0).sqrt())
}
