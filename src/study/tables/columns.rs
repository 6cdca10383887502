//! The columns of the tables of a report: what each shows, in which table, and whether its least number is the best.

use crate::study::row::Row;
use crate::table::{Cell, digits, fixed, seconds};

/// A number that is compared, its text and a remark.
type Figure = (f64, String, Option<String>);

/// The tables that show a column.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Shown {
    /// The summary, and the table of all levels.
    Everywhere,
    /// At the finest level of every series.
    InSummary,
    /// At all levels.
    AtLevels,
    /// Beside the table of all levels, at the finest.
    Beside,
}

/// A column of numbers.
pub(super) struct Column {
    pub name: &'static str,
    pub figure: fn(&Row) -> Option<Figure>,
    pub shown: Shown,
    /// Whether the least number is the best.
    has_best: bool,
}

/// The name of the column of effectivities.
const EFFECTIVITY: &str = "bound/error";

/// The columns of rows in which at least one has an entry: errors and bound where the solution is known, else the figures
/// of the solution; counts and seconds. Where errors are known the figures of the solution stand beside. `certif.` is the
/// largest of the four numbers of the certificate, `systems` the number of linear systems, `bound/error` the error bound
/// over the true error in the broken energy norm, `bound` the bound on that error, with a mark where a term of it is not
/// proven.
pub(super) fn columns(rows: &[&Row]) -> Vec<Column> {
    use Shown::{AtLevels, Beside, Everywhere, InSummary};
    let any = |has: fn(&Row) -> bool| rows.iter().any(|row| has(row));
    let has_errors = any(|r| r.error.l2.is_some() || r.error.h1.is_some());
    let is_adaptive = any(|r| r.theta.is_some());
    let has_effectivity = any(|r| r.bound.effectivity.is_some());
    let has_bound = any(|r| r.bound.discrete.is_some());
    let has_contact_error = any(|r| r.contact.contact_area_error.is_some());
    let mut columns: Vec<Column> = Vec::new();
    let mut add = |is_shown: bool, shown, name, has_best, figure: fn(&Row) -> Option<Figure>| {
        if is_shown {
            columns.push(Column { name, figure, shown, has_best });
        }
    };
    // the orders of errors are over it
    add(!is_adaptive && has_errors, AtLevels, "h", false, |r| {
        number(Some(r.mesh_size).filter(|h| h.is_finite()), 2)
    });
    add(true, Everywhere, "unknowns", false, |r| count(r.unknowns));
    add(!is_adaptive && has_errors, Everywhere, "L2 (order)", true, |r| {
        with_order(r.error.l2, r.order.l2)
    });
    add(!is_adaptive && has_errors, Everywhere, "H1 (order)", true, |r| {
        with_order(r.error.h1, r.order.h1)
    });
    add(is_adaptive && has_errors, Everywhere, "energy norm", true, |r| {
        number(r.error.broken_energy, 2)
    });
    let shown = if is_adaptive { AtLevels } else { Everywhere };
    add(has_effectivity, shown, EFFECTIVITY, true, |r| {
        Some((r.bound.effectivity?, quotient(r)?, None))
    });
    let bound: fn(&Row) -> Option<Figure> = |r| {
        let (x, text, order) = with_order(r.bound.discrete, r.order.bound)?;
        Some((x, marked(r, text), order))
    };
    // lines of all levels stay within their width
    let short_bound: fn(&Row) -> Option<Figure> = |r| {
        let (x, text, _) = number(r.bound.discrete, 1)?;
        Some((x, marked(r, text), None))
    };
    let stands_alone = has_bound && !is_adaptive && !has_effectivity;
    let shown = if is_adaptive { Everywhere } else { InSummary };
    add(has_bound && is_adaptive || stands_alone, shown, "bound (order)", true, bound);
    add(stands_alone, AtLevels, "bound", false, short_bound);
    add(has_contact_error, InSummary, "contact error", true, |r| {
        number(r.contact.contact_area_error, 2)
    });
    let shown = match (has_errors, has_contact_error) {
        (true, _) => Beside,
        (false, true) => AtLevels,
        (false, false) => Everywhere,
    };
    let has_contact = any(|r| r.contact_measure.is_some());
    add(any(|r| r.energy.is_some()), shown, "energy", false, |r| number(r.energy, 5));
    add(has_contact, shown, "contact", false, |r| number(r.contact_measure, 3));
    add(has_contact, shown, "resultant", false, |r| number(r.resultant, 4));
    add(has_errors && has_bound && !is_adaptive, Beside, "bound", false, bound);
    add(true, AtLevels, "active", false, |r| count(r.active));
    add(true, AtLevels, "certif.", false, |r| {
        number(Some(r.certificate.largest()).filter(|x| x.is_finite()), 1)
    });
    add(true, AtLevels, "systems", false, |r| count(r.iterations.systems));
    add(true, AtLevels, "assem.", false, |r| time(r.seconds.assemble));
    add(true, AtLevels, "solve", false, |r| time(r.seconds.solve));
    add(is_adaptive, AtLevels, "total", false, |r| time(r.seconds.total));
    let has_solvers = rows.iter().any(|r| r.solver != rows[0].solver);
    add(has_solvers, InSummary, "seconds (systems)", true, |r| {
        let systems = r.iterations.systems.map(|n| n.to_string());
        Some((r.seconds.total, seconds(r.seconds.total), systems))
    });
    add(!has_solvers, InSummary, "seconds", true, |r| time(r.seconds.total));
    columns
}

impl Column {
    /// The cells of rows; the least of the numbers that converged is marked as the best where there is a larger one.
    pub fn cells(&self, rows: &[&Row], marks_best: bool) -> Vec<Cell> {
        let figures: Vec<_> = rows.iter().map(|row| (self.figure)(row)).collect();
        let compared = rows.iter().zip(&figures).filter(|(row, _)| row.converged());
        let compared = compared.filter_map(|(_, figure)| Some(figure.as_ref()?.0));
        // a bound below the error is none
        let compared = compared.filter(|&x| self.name != EFFECTIVITY || x >= 1.0);
        let compared: Vec<f64> = compared.filter(|x| x.is_finite()).collect();
        let least = compared.iter().copied().fold(f64::INFINITY, f64::min);
        let has_best = marks_best && self.has_best && compared.iter().any(|&x| x > least);
        let cell = |(row, figure): (&&Row, Option<Figure>)| match figure {
            Some((x, text, remark)) if has_best && x == least && row.converged() => {
                Cell::Best(text, remark)
            }
            Some((_, text, remark)) => Cell::Number(text, remark),
            None => Cell::Nothing,
        };
        rows.iter().zip(figures).map(cell).collect()
    }
}

/// A number with so many digits.
fn number(x: Option<f64>, places: usize) -> Option<Figure> {
    x.map(|x| (x, digits(x, places), None))
}

/// An error in three digits with its order.
fn with_order(x: Option<f64>, order: Option<f64>) -> Option<Figure> {
    x.map(|x| (x, digits(x, 2), order.map(fixed)))
}

fn count(n: Option<usize>) -> Option<Figure> {
    n.map(|n| (n as f64, n.to_string(), None))
}

fn time(x: f64) -> Option<Figure> {
    Some((x, seconds(x), None))
}

/// The mark of a bound that stands in place of its quotient.
const ABOVE_NORM: char = '†';

/// A bound, or a ratio of it, with a mark where a term of it is not proven.
fn marked(row: &Row, bound: String) -> String {
    if row.bound.guaranteed == Some(false) { bound + "*" } else { bound }
}

/// A bound over the error, or the bound itself where it exceeds the norm of the solution.
fn quotient(row: &Row) -> Option<String> {
    let effectivity = row.bound.effectivity?;
    Some(match row.bound.discrete.filter(|_| exceeds_norm(row)) {
        Some(bound) => marked(row, format!("{}{ABOVE_NORM}", digits(bound, 1))),
        None => marked(row, fixed(effectivity)),
    })
}

/// Whether the bound of a row says nothing.
fn exceeds_norm(row: &Row) -> bool {
    row.bound.exceeds_norm == Some(true) && row.bound.effectivity.is_some()
}

/// The remark on bounds without a quotient, if there are any.
pub(super) fn above_norm(rows: &[&Row]) -> Option<String> {
    rows.iter().any(|row| exceeds_norm(row)).then(|| {
        format!("{ABOVE_NORM} the bound itself: it exceeds the energy norm of the solution")
    })
}
