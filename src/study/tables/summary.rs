//! The summary of a report: one table for each scene at the finest level of every series, and how the runs ended.

use super::levels::{above_norm, marked, quotient, scenes, unproven};
use super::remarks::{ReasonsGiven, warnings};
use crate::study::row::{Row, distinct};
use crate::study::series::{Series, series_of};
use crate::table::{Cell, Table, digits, fixed, seconds};

/// The name of the column of effectivities.
const BOUND: &str = "bound/error";

/// A number that is compared, its text and a remark.
type Figure = (f64, String, Option<String>);

/// A column of the summary.
struct Column {
    name: &'static str,
    cell: fn(&Row) -> Option<Figure>,
    /// Whether the least number is the best.
    has_best: bool,
}

/// One sentence: what was compared and how it ended, with the runs that did not converge.
pub(crate) fn lead(rows: &[Row]) -> String {
    let names = |names: Vec<&str>, what: &str| match &names[..] {
        names if names.len() <= 4 => names.join(", "),
        names => format!("{} {what}", names.len()),
    };
    let schemes = names(distinct(rows.iter().map(|r| r.label.as_str())), "schemes");
    let scenes = names(distinct(rows.iter().map(|r| r.scene.as_str())), "scenes");
    let levels = distinct(rows.iter().map(|r| r.level));
    let levels = match (levels.iter().min(), levels.iter().max()) {
        (Some(least), Some(most)) if least < most => format!("levels {least} to {most}"),
        (Some(level), _) => format!("level {level}"),
        _ => "no level".to_owned(),
    };
    let failed: Vec<&Row> = rows.iter().filter(|r| !r.converged()).collect();
    let end = match failed.len() {
        0 => format!("all {} runs converged", rows.len()),
        n => {
            let name = |r: &&Row| format!("{} on {} at {}", r.label, r.scene, r.level);
            let named: Vec<String> = failed.iter().take(3).map(name).collect();
            let more = if n > 3 { format!(" and {} more", n - 3) } else { String::new() };
            format!("{n} of {} runs did not converge: {}{more}", rows.len(), named.join(", "))
        }
    };
    format!("{schemes} on {scenes}, {levels}: {end}.")
}

/// The tables of all scenes: at most eight columns, the best number of a column marked.
pub(crate) fn summaries(rows: &[Row]) -> Vec<Table> {
    let tables = scenes(rows).into_iter();
    tables
        .map(|(title, rows)| summary(&title, rows[0].theta.is_some(), &series_of(&rows)))
        .collect()
}

fn summary(title: &str, is_adaptive: bool, series: &[Series<'_>]) -> Table {
    let finest: Vec<&Row> =
        series.iter().filter_map(|series| series.rows.last().copied()).collect();
    let columns = columns(&finest);
    let best: Vec<Option<f64>> = columns.iter().map(|column| best(column, &finest)).collect();
    let cell = |column: &Column, best: Option<f64>, row: &Row| match (column.cell)(row) {
        Some((x, text, remark)) if best == Some(x) && row.converged() => Cell::Best(text, remark),
        Some((_, text, remark)) => Cell::Number(text, remark),
        None => Cell::Nothing,
    };
    let mut reasons = ReasonsGiven::default();
    let levels = distinct(finest.iter().map(|r| r.level));
    let line = |(series, row): (&Series<'_>, &&Row)| {
        let numbers = columns.iter().zip(&best).map(|(column, &best)| cell(column, best, row));
        let status = Cell::Words(reasons.status(row));
        let name = match levels.len() {
            1 => series.name.clone(),
            _ => format!("{} at {}", series.name, row.level),
        };
        [Cell::Words(name)].into_iter().chain(numbers).chain([status]).collect()
    };
    let lines = series.iter().zip(&finest).map(line).collect();
    let names = columns.iter().map(|column| column.name);
    let references = distinct(finest.iter().filter_map(|r| r.reference()));
    let references = references.iter().map(|reference| format!("; errors against {reference}"));
    let kind = if is_adaptive { "step" } else { "level" };
    let place = match levels[..] {
        [level] => format!(", {kind} {level}"),
        _ => format!(", each scheme at its last {kind}"),
    };
    let failed: Vec<(String, String)> = series
        .iter()
        .filter_map(|of| Some((&of.name, of.rows.split_last()?.1)))
        .flat_map(|(name, rows)| rows.iter().map(move |row| (name, row)))
        .filter(|(_, row)| !row.converged())
        .map(|(name, row)| (format!("{name} at {}", row.level), reasons.message(row)))
        .collect();
    let remark = |message: &String| {
        let of = failed.iter().filter(|of| of.1 == *message).map(|of| of.0.as_str());
        format!("{}: {message}", of.collect::<Vec<_>>().join(", "))
    };
    let remarks = distinct(failed.iter().map(|of| &of.1)).into_iter().map(remark);
    let warnings = warnings(&finest).into_iter().map(|(labels, text)| format!("{labels}: {text}"));
    Table {
        title: title.to_owned(),
        detail: place + &references.collect::<String>(),
        columns: ["scheme"].into_iter().chain(names).chain(["status"]).map(str::to_owned).collect(),
        rows: lines,
        remarks: remarks
            .chain(warnings)
            .chain(above_norm(&finest))
            .chain(unproven(&finest))
            .collect(),
    }
}

/// The least number of a column where it is the best and there is a larger one.
fn best(column: &Column, rows: &[&Row]) -> Option<f64> {
    let numbers: Vec<f64> = rows
        .iter()
        .filter(|row| row.converged())
        .filter_map(|row| (column.cell)(row))
        .map(|(x, ..)| x)
        // a bound below the error is none
        .filter(|x| x.is_finite() && (column.name != BOUND || *x >= 1.0))
        .collect();
    let least = numbers.iter().copied().min_by(f64::total_cmp)?;
    (column.has_best && numbers.iter().any(|&x| x > least)).then_some(least)
}

/// The columns between scheme and status: errors and bound where the solution is known, else the figures of the
/// solution; then seconds, beside several solvers with the number of linear systems.
fn columns(rows: &[&Row]) -> Vec<Column> {
    let any = |cell: fn(&Row) -> Option<f64>| rows.iter().any(|r| cell(r).is_some());
    let column = |name, has_best, cell| Column { name, cell, has_best };
    let mut columns =
        vec![column("unknowns", false, |r| r.unknowns.map(|n| (n as f64, n.to_string(), None)))];
    let has_errors = any(|r| r.error.l2) || any(|r| r.error.h1);
    let is_adaptive = rows.iter().any(|r| r.theta.is_some());
    if is_adaptive && has_errors {
        columns.push(column("energy norm", true, |r| figure(r.error.broken_energy, None)));
    } else if has_errors {
        columns.push(column("L2 (order)", true, |r| figure(r.error.l2, r.order.l2)));
        columns.push(column("H1 (order)", true, |r| figure(r.error.h1, r.order.h1)));
    }
    if any(|r| r.bound.effectivity) && !is_adaptive {
        columns.push(column(BOUND, true, |r| {
            r.bound.effectivity.zip(quotient(r)).map(|(x, text)| (x, text, None))
        }));
    } else if any(|r| r.bound.discrete) {
        columns.push(column("bound (order)", true, |r| {
            let (x, text, order) = figure(r.bound.discrete, r.order.bound)?;
            Some((x, marked(r, text), order))
        }));
    }
    if any(|r| r.contact.contact_area_error) {
        columns.push(column("contact error", true, |r| figure(r.contact.contact_area_error, None)));
    } else if !has_errors {
        columns.push(column("energy", false, |r| r.energy.map(|x| (x, format!("{x:.5e}"), None))));
        columns.push(column("contact", false, |r| figure(r.contact_measure, None)));
        columns.push(column("resultant", false, |r| figure(r.resultant, None)));
    }
    if rows.iter().any(|r| r.solver != rows[0].solver) {
        columns.push(column("seconds (systems)", true, |r| {
            let systems = r.iterations.systems.map(|n| n.to_string());
            Some((r.seconds.total, seconds(r.seconds.total), systems))
        }));
    } else {
        columns.push(column("seconds", true, |r| {
            Some((r.seconds.total, seconds(r.seconds.total), None))
        }));
    }
    columns
}

/// An error in three digits with its order.
fn figure(x: Option<f64>, order: Option<f64>) -> Option<Figure> {
    x.map(|x| (x, digits(x, 2), order.map(fixed)))
}
