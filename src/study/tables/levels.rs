//! All levels: the tables of each scene.

use super::remarks::{ReasonsGiven, warnings};
use super::values::values_of;
use crate::inequality::Outcome;
use crate::study::extrapolate::{Limit, extrapolate};
use crate::study::orders::rates::rates;
use crate::study::part_figures::PartFigures;
use crate::study::row::{Row, distinct};
use crate::study::series::{Series, series_of};
use crate::table::{Cell, Table, digits, fixed};

/// The rows of each table with its title: those of a scene, in the order in which scenes first occur. Where a scene has
/// uniform and adaptive meshes, each kind has its table, since their columns differ.
pub(crate) fn scenes(rows: &[Row]) -> Vec<(String, Vec<&Row>)> {
    let of = |scene: &str| {
        let of_scene = rows.iter().filter(|r| r.scene == scene);
        let (adaptive, uniform): (Vec<&Row>, Vec<&Row>) = of_scene.partition(|r| r.theta.is_some());
        match (uniform.is_empty(), adaptive.is_empty()) {
            (false, false) => vec![
                (format!("{scene}, uniform meshes"), uniform),
                (format!("{scene}, adaptive meshes"), adaptive),
            ],
            (true, _) => vec![(scene.to_owned(), adaptive)],
            (_, true) => vec![(scene.to_owned(), uniform)],
        }
    };
    distinct(rows.iter().map(|r| r.scene.as_str())).into_iter().flat_map(of).collect()
}

/// The tables of a scene. The first has all levels; times are in seconds. `certif.` is the largest of the four numbers
/// of the certificate, `systems` the number of linear systems, `effect.` the error bound over the true error in the
/// broken energy norm, `bound` the bound on that error, with a mark where a term of it is not proven; a last column says
/// why rows did not converge. Where no error is known there are columns of error bound, energy, contact measure and
/// resultant, and their limits below; where errors are known a second table has these, for the finest level of each
/// series, with the stages that ran. A third one has what rows say of several processes.
pub(crate) fn tables_of(scene: &str, rows: &[&Row]) -> Vec<Table> {
    let series = series_of(rows);
    let sorted: Vec<&Row> = series.iter().flat_map(|s| s.rows.iter().copied()).collect();
    let finest: Vec<&Row> = series.iter().filter_map(|s| s.rows.last().copied()).collect();
    let mut columns = columns(rows);
    if rows.iter().any(|row| !row.converged()) {
        columns.push(("", |_| Cell::Words(String::new())));
    }
    let mut first = table(scene.to_owned(), &columns, &sorted);
    first.detail = format!(": {}", heading(rows));
    let mut reasons = ReasonsGiven::default();
    for (cells, row) in first.rows.iter_mut().zip(&sorted).filter(|(_, row)| !row.converged()) {
        let status = reasons.status(row);
        let status = Cell::Words(match row.status {
            Outcome::TimeLimit => status,
            _ => format!("did not converge: {status}"),
        });
        *cells.last_mut().expect("a table has columns") = status;
    }
    let warning = |(labels, warning): (String, &str)| format!("warning, {labels}: {warning}");
    first.remarks = warnings(rows).into_iter().map(warning).collect();
    if !has_errors(rows) {
        first.remarks.extend(limits(rows));
    }
    first.remarks.extend(rates(rows).into_iter().chain(above_norm(rows)).chain(unproven(rows)));
    let further = |what: &str, columns: Vec<Column>| {
        let columns = Some(columns).filter(|columns| !columns.is_empty())?;
        let table = table(format!("{scene}: {what}"), &[names(rows), columns].concat(), &finest);
        Some(Table { detail: ", at the finest level of each scheme".to_owned(), ..table })
    };
    let mut second = further("totals and stages", totals(rows));
    if let Some(second) = second.as_mut().filter(|_| has_errors(rows)) {
        second.remarks = limits(rows);
    }
    let third = further("several processes", of_processes(rows));
    [Some(first), second, third, values_of(scene, rows)].into_iter().flatten().collect()
}

/// A table without remarks.
fn table(title: String, columns: &[Column], rows: &[&Row]) -> Table {
    let line = |row: &&Row| columns.iter().map(|(_, cell)| cell(row)).collect();
    Table {
        title,
        columns: columns.iter().map(|(name, _)| (*name).to_owned()).collect(),
        rows: rows.iter().map(line).collect(),
        ..Table::default()
    }
}

/// Whether the rows are those of meshes that follow the error bound.
fn is_adaptive(rows: &[&Row]) -> bool {
    rows.iter().any(|r| r.theta.is_some())
}

/// Whether an error in L2 or H1 is known.
fn has_errors(rows: &[&Row]) -> bool {
    rows.iter().any(|r| r.error.l2.is_some() || r.error.h1.is_some())
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

/// The mark of a bound that stands in place of its quotient.
const ABOVE_NORM: char = '†';

/// The name of a column of a table, and its cell in a row.
type Column = (&'static str, fn(&Row) -> Cell);

/// The columns that tell the rows of a scene apart.
fn names(rows: &[&Row]) -> Vec<Column> {
    let mut columns: Vec<Column> = vec![("scheme", |r| Cell::Words(r.label.clone()))];
    if rows.iter().any(|r| r.solver != rows[0].solver) {
        columns.push(("solver", |r| Cell::Words(r.solver.clone())));
    }
    if rows.iter().any(|r| r.linear_asked != rows[0].linear_asked) {
        columns.push(("linear", |r| Cell::Words(r.linear_asked.clone().unwrap_or_default())));
    }
    let name = if is_adaptive(rows) { "step" } else { "n" };
    columns.push((name, |r| Cell::whole(Some(r.level))));
    columns
}

/// The columns of the first table of `rows`: those in which at least one row has an entry.
fn columns(rows: &[&Row]) -> Vec<Column> {
    let any = |get: fn(&Row) -> Option<f64>| rows.iter().any(|r| get(r).is_some());
    let mut columns = names(rows);
    let is_adaptive = is_adaptive(rows);
    // the orders of errors are over it
    if !is_adaptive && has_errors(rows) {
        columns.push(("h", |r| Cell::digits(Some(r.mesh_size).filter(|h| h.is_finite()), 2)));
    }
    columns.push(("unknowns", |r| Cell::whole(r.unknowns)));
    let has_effectivity = any(|r| r.bound.effectivity);
    let has_bound = any(|r| r.bound.discrete) && (is_adaptive || !has_effectivity);
    if is_adaptive {
        columns.push(("bound", |r| bound(r, 1)));
        columns.push(("order", |r| Cell::fixed(r.order.bound)));
    } else if any(|r| r.error.l2) {
        columns.push(("L2", |r| Cell::digits(r.error.l2, 2)));
        columns.push(("order", |r| Cell::fixed(r.order.l2)));
    }
    if has_bound && rows.iter().any(|r| !r.error.is_energy_h1()) {
        // beside a bound only the norm that it bounds
        columns.push(("energy norm", |r| Cell::digits(r.error.broken_energy, 2)));
    } else if any(|r| r.error.h1) {
        columns.push(("H1", |r| Cell::digits(r.error.h1, 2)));
        columns.push(("order", |r| Cell::fixed(r.order.h1)));
    }
    // the errors say the rest where they are known, and lines stay within their width
    if has_effectivity {
        columns.push(("effect.", |r| Cell::number(quotient(r))));
    } else if !is_adaptive && has_bound {
        columns.push(("bound", |r| bound(r, 1)));
    }
    if !has_errors(rows) {
        columns.extend(of_the_solution(rows));
    }
    columns.push(("active", |r| Cell::whole(r.active)));
    columns.push(("certif.", |r| {
        Cell::digits(Some(r.certificate.largest()).filter(|c| c.is_finite()), 1)
    }));
    columns.push(("systems", |r| Cell::whole(r.iterations.systems)));
    columns.push(("assem.", |r| Cell::seconds(r.seconds.assemble)));
    columns.push(("solve", |r| Cell::seconds(r.seconds.solve)));
    if is_adaptive {
        columns.push(("total", |r| Cell::seconds(r.seconds.total)));
    }
    columns
}

/// The error bound of a row.
fn bound(row: &Row, places: usize) -> Cell {
    Cell::number(row.bound.discrete.map(|x| marked(row, digits(x, places))))
}

/// A bound, or a ratio of it, with a mark where a term of it is not proven.
pub(super) fn marked(row: &Row, bound: String) -> String {
    if row.bound.guaranteed == Some(false) { bound + "*" } else { bound }
}

/// A bound over the error, or the bound itself where it exceeds the norm of the solution.
pub(super) fn quotient(row: &Row) -> Option<String> {
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

/// The remark that explains the marks of bounds: the terms that are not proven, with their schemes where these differ in
/// them. None without marks.
pub(super) fn unproven(rows: &[&Row]) -> Option<String> {
    let words = |row: &&Row| row.bound.unproven_words();
    let sets = distinct(rows.iter().map(words).filter(|words| !words.is_empty()));
    let of_schemes = |set: &String| {
        let rows = rows.iter().filter(|row| words(row) == *set);
        let labels = distinct(rows.map(|row| row.label.as_str()));
        format!("{set} ({})", labels.join(", "))
    };
    let all = match &sets[..] {
        [] => return None,
        [set] => set.clone(),
        several => several.iter().map(of_schemes).collect::<Vec<_>>().join("; "),
    };
    Some(format!("* bound with terms that are not proven: {all}"))
}

/// Energy, contact measure and resultant, where they are known.
fn of_the_solution(rows: &[&Row]) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    if rows.iter().any(|r| r.energy.is_some()) {
        columns.push(("energy", |r| Cell::digits(r.energy, 5)));
    }
    if rows.iter().any(|r| r.contact_measure.is_some()) {
        columns.push(("contact", |r| Cell::digits(r.contact_measure, 3)));
        columns.push(("resultant", |r| Cell::digits(r.resultant, 4)));
    }
    columns
}

/// The columns of the figures that the first table leaves out.
fn totals(rows: &[&Row]) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    if has_errors(rows) {
        columns.extend(of_the_solution(rows));
        if !is_adaptive(rows) && rows.iter().any(|r| r.bound.discrete.is_some()) {
            columns.push(("bound", |r| bound(r, 2)));
        }
    }
    if rows.iter().any(|r| !r.iterations.stages.is_empty()) {
        columns.push(("stages (outer)", |r| {
            let stages = r.iterations.stages.iter().map(|s| format!("{} ({})", s.stage, s.outer));
            Cell::Words(stages.collect::<Vec<_>>().join(", "))
        }));
    }
    columns
}

/// The columns of what rows say of several processes: shares of ghosts, imbalance, seconds by phase as least and
/// most. None if the rows are those of one process.
fn of_processes(rows: &[&Row]) -> Vec<Column> {
    if rows.iter().all(|r| r.ranks.is_none()) {
        return Vec::new();
    }
    fn figure(row: &Row, get: fn(&PartFigures) -> String) -> Cell {
        Cell::number(row.ranks.as_ref().map(get))
    }
    fn range([least, most]: [f64; 2]) -> String {
        format!("{least:.2}-{most:.2}")
    }
    vec![
        ("ranks", |r| figure(r, |p| p.count.to_string())),
        ("ghosts", |r| figure(r, |p| format!("{:.1}%", 100.0 * p.ghosts))),
        ("imbal.", |r| figure(r, |p| format!("{:.3}", p.imbalance))),
        ("linear", |r| Cell::whole(Some(r.iterations.linear))),
        ("assem.", |r| figure(r, |p| range(p.seconds.assemble))),
        ("number", |r| figure(r, |p| range(p.seconds.number))),
        ("start", |r| figure(r, |p| range(p.seconds.start))),
        ("solve", |r| figure(r, |p| range(p.seconds.solve))),
        ("MB", |r| {
            let memory = r.peak_memory_bytes.map(|bytes| format!("{:.0}", bytes as f64 / 1e6));
            Cell::number(memory)
        }),
    ]
}
