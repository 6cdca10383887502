//! All levels: the tables of each scene.

use super::columns::{Shown, columns};
use super::remarks::remarks;
use super::values::values_of;
use crate::study::extrapolate::{Limit, extrapolate};
use crate::study::row::{Row, distinct};
use crate::study::series::{Series, series_of};
use crate::table::{Cell, Table};

/// The rows of each scene, in the order in which scenes first occur.
pub(crate) fn scenes(rows: &[Row]) -> Vec<(&str, Vec<&Row>)> {
    let of = |scene| (scene, rows.iter().filter(|r| r.scene == scene).collect());
    distinct(rows.iter().map(|r| r.scene.as_str())).into_iter().map(of).collect()
}

/// The tables of a scene: all levels; at the finest level of each series the figures that the first leaves out, with the
/// stages that ran and the limits of three levels; values by name.
pub(crate) fn tables_of(scene: &str, rows: &[&Row]) -> Vec<Table> {
    let series = series_of(rows);
    let sorted: Vec<&Row> = series.iter().flat_map(|s| s.rows.iter().copied()).collect();
    let finest: Vec<&Row> = series.iter().filter_map(|s| s.rows.last().copied()).collect();
    let columns = columns(rows);
    let of = |shown: &[Shown], rows: &[&Row]| -> Vec<(&str, Vec<Cell>)> {
        let shown = columns.iter().filter(|column| shown.contains(&column.shown));
        shown.map(|column| (column.name, column.cells(rows, false))).collect()
    };
    let mut first = table(scene, &sorted, of(&[Shown::Everywhere, Shown::AtLevels], &sorted));
    first.detail = format!(": {}", heading(rows));
    first.remarks = remarks(&series, &series);
    let mut beside = of(&[Shown::Beside], &finest);
    let has_limits_below = beside.is_empty();
    if rows.iter().any(|r| !r.iterations.stages.is_empty()) {
        beside.push(("stages (outer)", finest.iter().map(|row| stages(row)).collect()));
    }
    let has_second = !beside.is_empty();
    let mut second = table(&format!("{scene}: totals and stages"), &finest, beside);
    second.detail = ", at the finest level of each scheme".to_owned();
    let limited = if has_limits_below { &mut first } else { &mut second };
    limited.remarks.extend(limits(rows));
    let second = Some(second).filter(|_| has_second);
    [Some(first), second, values_of(scene, rows)].into_iter().flatten().collect()
}

/// A table of rows without remarks: the columns that tell them apart, then others.
fn table(title: &str, rows: &[&Row], columns: Vec<(&str, Vec<Cell>)>) -> Table {
    let all = |cell: fn(&Row) -> Cell| rows.iter().map(|row| cell(row)).collect::<Vec<_>>();
    let mut names = vec![("scheme", all(|r| Cell::Words(r.label.clone())))];
    if rows.iter().any(|r| r.solver != rows[0].solver) {
        names.push(("solver", all(|r| Cell::Words(r.solver.clone()))));
    }
    let is_adaptive = rows.iter().any(|r| r.theta.is_some());
    names.push((if is_adaptive { "step" } else { "n" }, all(|r| Cell::whole(Some(r.level)))));
    names.extend(columns);
    let line = |k: usize| names.iter().map(|(_, cells)| cells[k].clone()).collect();
    Table {
        title: title.to_owned(),
        columns: names.iter().map(|(name, _)| (*name).to_owned()).collect(),
        rows: (0..rows.len()).map(line).collect(),
        ..Table::default()
    }
}

/// The stages that ran, with their outer steps.
fn stages(row: &Row) -> Cell {
    let stages = row.iterations.stages.iter().map(|s| format!("{} ({})", s.stage, s.outer));
    Cell::Words(stages.collect::<Vec<_>>().join(", "))
}

/// The limits of energy, contact measure and resultant of each series.
fn limits(rows: &[&Row]) -> Vec<String> {
    let limit = |name: &str, limit: Option<Limit>| {
        let Limit { value, order } = limit?;
        let order = order.map_or_else(|| "on three levels".to_owned(), |p| format!("order {p:.2}"));
        Some(format!("{name} {value:.6e} ({order})"))
    };
    let of_series = |series: Series<'_>| {
        let found = extrapolate(&series.rows).pop()?;
        let limits = [
            limit("energy", found.energy),
            limit("contact", found.contact_measure),
            limit("resultant", found.resultant),
        ];
        let limits: Vec<String> = limits.into_iter().flatten().collect();
        let line = format!("extrapolated, {}: {}", series.name, limits.join(", "));
        (!limits.is_empty()).then_some(line)
    };
    series_of(rows).into_iter().filter_map(of_series).collect()
}

/// The heading after the name of the scene: what levels count, solvers, and the orders that theory promises.
fn heading(rows: &[&Row]) -> String {
    let solvers = distinct(rows.iter().map(|r| match &r.linear[..] {
        "" => r.solver.clone(),
        linear => format!("{}/{linear}", r.solver),
    }));
    let mut text = match rows.first().and_then(|row| row.level_kind.as_deref()) {
        Some("subdivisions") => "n subdivisions of the shortest side; ".to_owned(),
        Some("refinements") => "n refinements of the mesh; ".to_owned(),
        _ => String::new(),
    };
    if let Some(constants) = rows.first().map(|row| &row.constants).filter(|c| !c.is_empty()) {
        let words = constants.iter().map(|(name, value)| format!("{name} = {value}"));
        text += &format!("{}; ", words.collect::<Vec<_>>().join(", "));
    }
    text += &format!("solver {}", solvers.join(", "));
    let references = distinct(rows.iter().filter_map(|r| r.reference()));
    if !references.is_empty() {
        text += &format!("; errors against {}", references.join(", "));
    }
    let promises = promises(rows);
    if !promises.is_empty() {
        text += &format!("; expected order {}", promises.join(", "));
    }
    text
}

/// The orders that theory promises, each with its schemes where some are promised something else, or nothing.
fn promises(rows: &[&Row]) -> Vec<String> {
    let promise = |row: &Row| {
        let both = [("L2", row.expected_order.l2), ("H1", row.expected_order.h1)];
        let known = both.iter().filter_map(|(name, p)| p.map(|p| format!("{name} {p}")));
        known.collect::<Vec<_>>().join(" ")
    };
    let labels = |of: &dyn Fn(&Row) -> bool| {
        distinct(rows.iter().filter(|row| of(row)).map(|row| row.label.as_str()))
    };
    let n_labels = labels(&|_| true).len();
    let once = distinct(rows.iter().map(|row| promise(row)).filter(|known| !known.is_empty()));
    let is_only = once.len() == 1;
    let named = |known: String| {
        let schemes = labels(&|row| promise(row) == known);
        match is_only && schemes.len() == n_labels {
            true => known,
            false => format!("{known} ({})", schemes.join(" ")),
        }
    };
    once.into_iter().map(named).collect()
}
