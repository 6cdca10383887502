//! All levels as text for a terminal: one table for each scene.

use std::fmt;

use super::remarks::{failure, warnings};
use crate::study::extrapolate::{Limit, extrapolate};
use crate::study::orders::rates::rates;
use crate::study::part_figures::PartFigures;
use crate::study::row::{Row, distinct};
use crate::study::series::series_of;
use crate::table::{WIDTH, wrapped};

/// The cell of a number that does not apply.
const NONE: &str = "-";

/// Writes one table for each scene, in the order in which scenes first occur, with a blank line
/// between series; times are in seconds. `certif.` is the largest of the four numbers of the
/// certificate, `effect.` the error bound over the true error in the broken energy norm, `bound` the bound on that
/// error, with a mark where a term of it is not proven. A row that did not converge is followed by
/// the reason. Where no error is known there are columns of error bound, energy, contact measure and
/// resultant, and their limits below; where errors are known a second table has these, for the finest level
/// of each series, and the stages that ran.
pub(super) fn write_tables(f: &mut impl fmt::Write, rows: &[Row]) -> fmt::Result {
    for (i, (scene, rows)) in scenes(rows).into_iter().enumerate() {
        if i > 0 {
            writeln!(f)?;
        }
        write_scene(f, &scene, &rows)?;
    }
    Ok(())
}

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

/// The table of one scene.
fn write_scene(f: &mut impl fmt::Write, scene: &str, rows: &[&Row]) -> fmt::Result {
    write_wrapped(f, &format!("{scene}: {}", heading(rows)))?;
    let lines = Lines::new(columns(rows), rows);
    lines.write(f, |c| c.name.to_owned())?;
    let series = series_of(rows);
    let mut told = Vec::new();
    for (i, of_series) in series.iter().enumerate() {
        if i > 0 {
            writeln!(f)?;
        }
        for row in of_series.plain_rows() {
            lines.write(f, |c| (c.cell)(row))?;
            if !row.converged() {
                let message = failure(row);
                match told.contains(&message) {
                    true => writeln!(f, "  ^ did not converge: {}, as above", row.status)?,
                    false => write_wrapped(f, &format!("  ^ {message}"))?,
                }
                told.push(message);
            }
        }
    }
    for (labels, warning) in warnings(rows) {
        write_wrapped(f, &format!("  warning, {labels}: {warning}"))?;
    }
    if !has_errors(rows) {
        limits(rows).iter().try_for_each(|line| write_wrapped(f, &format!("  {line}")))?;
    }
    for line in rates(rows).iter().chain(&unproven(rows)) {
        write_wrapped(f, &format!("  {line}"))?;
    }
    let finest: Vec<&Row> = series.iter().filter_map(|s| s.plain_rows().next_back()).collect();
    for columns in [totals(rows), of_processes(rows)].into_iter().filter(|c| !c.is_empty()) {
        let lines = Lines::new(columns, &finest);
        writeln!(f)?;
        lines.write(f, |c| c.name.to_owned())?;
        finest.iter().try_for_each(|row| lines.write(f, |c| (c.cell)(row)))?;
    }
    Ok(())
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
pub(crate) fn limits(rows: &[&Row]) -> Vec<String> {
    let mut lines = Vec::new();
    let has_solvers = rows.iter().any(|r| r.solver != rows[0].solver);
    for series in extrapolate(rows) {
        let limit = |name: &str, limit: Option<Limit>| {
            let Limit { value, order } = limit?;
            let order =
                order.map_or_else(|| "on three levels".to_owned(), |p| format!("order {p:.2}"));
            Some(format!("{name} {value:.6e} ({order})"))
        };
        let limits = [
            limit("energy", series.energy),
            limit("contact", series.contact_measure),
            limit("resultant", series.resultant),
        ];
        let limits: Vec<String> = limits.into_iter().flatten().collect();
        if !limits.is_empty() {
            let solver = if has_solvers { format!(", {}", series.solver) } else { String::new() };
            let name = format!("{}{solver}", series.label);
            lines.push(format!("extrapolated, {name}: {}", limits.join(", ")));
        }
    }
    lines
}

/// The heading after the name of the scene: what levels count, solvers, and the orders that theory promises.
pub(crate) fn heading(rows: &[&Row]) -> String {
    let solvers = distinct(rows.iter().map(|r| match &r.linear[..] {
        "" => r.solver.clone(),
        linear => format!("{}/{linear}", r.solver),
    }));
    let mut text = match rows.first().and_then(|row| row.level_kind.as_deref()) {
        Some("subdivisions") => "n subdivisions of the shortest side; ".to_owned(),
        Some("refinements") => "n refinements of the mesh; ".to_owned(),
        _ => String::new(),
    };
    text += &format!("solver {}", solvers.join(", "));
    let references = distinct(rows.iter().filter_map(|r| r.reference()));
    if !references.is_empty() {
        text += &format!("; errors against {}", references.join(", "));
    }
    let mut promises: Vec<(String, Vec<String>)> = Vec::new();
    for row in rows {
        let expected = row.expected_order;
        let both = [("L2", expected.l2), ("H1", expected.h1)];
        let known: Vec<String> =
            both.iter().filter_map(|(name, p)| p.map(|p| format!("{name} {p}"))).collect();
        if known.is_empty() {
            continue;
        }
        let known = known.join(" ");
        match promises.iter_mut().find(|(k, _)| *k == known) {
            Some((_, schemes)) if schemes.contains(&row.label) => {}
            Some((_, schemes)) => schemes.push(row.label.clone()),
            None => promises.push((known, vec![row.label.clone()])),
        }
    }
    // Schemes need naming only where some are promised something else, or nothing.
    let all = promises.len() == 1 && rows.iter().all(|r| promises[0].1.contains(&r.label));
    let promises: Vec<String> = promises
        .into_iter()
        .map(
            |(known, schemes)| {
                if all { known } else { format!("{known} ({})", schemes.join(" ")) }
            },
        )
        .collect();
    if !promises.is_empty() {
        text += &format!("; expected order {}", promises.join(", "));
    }
    text
}

/// Writes text in lines of the width of a table, further lines indented.
fn write_wrapped(f: &mut impl fmt::Write, text: &str) -> fmt::Result {
    f.write_str(&wrapped(text, WIDTH, 4))
}

/// One column of a table.
pub(crate) struct Column {
    /// Head of the column.
    pub name: &'static str,
    /// Whether cells are aligned to the left, as texts are; numbers are aligned to the right.
    pub left: bool,
    /// The cell of a row.
    pub cell: fn(&Row) -> String,
}

/// The columns of the table of `rows`: those in which at least one row has an entry.
pub(crate) fn columns(rows: &[&Row]) -> Vec<Column> {
    let text = |name, cell| Column { name, left: true, cell };
    let number = |name, cell| Column { name, left: false, cell };
    let any = |get: fn(&Row) -> Option<f64>| rows.iter().any(|r| get(r).is_some());
    let mut columns = vec![text("scheme", |r| r.label.clone())];
    if rows.iter().any(|r| r.solver != rows[0].solver) {
        columns.push(text("solver", |r| r.solver.clone()));
    }
    let is_adaptive = is_adaptive(rows);
    columns.push(number(if is_adaptive { "step" } else { "n" }, |r| r.level.to_string()));
    if !is_adaptive {
        columns.push(number("h", |r| scientific(Some(r.mesh_size).filter(|h| h.is_finite()))));
    }
    columns.push(number("unknowns", |r| whole(r.unknowns)));
    columns.push(number("outer", |r| whole(r.iterations.outer)));
    let has_effectivity = any(|r| r.bound.effectivity);
    let has_bound = any(|r| r.bound.discrete) && (is_adaptive || !has_effectivity);
    if is_adaptive {
        columns.push(number("bound", |r| marked(r, scientific(r.bound.discrete))));
        columns.push(number("order", |r| fixed(r.order.bound)));
    } else if any(|r| r.error.l2) {
        columns.push(number("L2", |r| scientific(r.error.l2)));
        columns.push(number("order", |r| fixed(r.order.l2)));
    }
    if has_bound && rows.iter().any(|r| !r.error.is_energy_h1()) {
        // beside a bound only the norm that it bounds
        columns.push(number("energy norm", |r| scientific(r.error.broken_energy)));
    } else if any(|r| r.error.h1) {
        columns.push(number("H1", |r| scientific(r.error.h1)));
        columns.push(number("order", |r| fixed(r.order.h1)));
    }
    // the errors say the rest where they are known, and lines stay within their width
    if has_effectivity {
        columns.push(number("effect.", |r| marked(r, fixed(r.bound.effectivity))));
    } else if !is_adaptive && has_bound {
        columns.push(number("bound", |r| marked(r, digits(r.bound.discrete, 1))));
    }
    if !has_errors(rows) {
        columns.extend(of_the_solution(rows));
    }
    columns.push(number("active", |r| whole(r.active)));
    columns.push(number("certif.", |r| {
        let c = &r.certificate;
        // the largest violation, where NaN counts as larger than any number
        let all = [c.feasibility, c.multiplier, c.complementarity, c.residual];
        let worse = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
        digits(Some(all.into_iter().fold(0.0, worse)).filter(|c| c.is_finite()), 1)
    }));
    columns.push(number("assem.", |r| seconds(r.seconds.assemble)));
    columns.push(number("solve", |r| seconds(r.seconds.solve)));
    if is_adaptive {
        columns.push(number("total", |r| seconds(r.seconds.total)));
    }
    columns
}

/// A bound, or a ratio of it, with a mark where a term of it is not proven.
pub(super) fn marked(row: &Row, bound: String) -> String {
    let is_marked = bound != NONE && row.bound.guaranteed == Some(false);
    if is_marked { bound + "*" } else { bound }
}

/// What the marks of bounds mean, where there are any.
pub(crate) fn unproven(rows: &[&Row]) -> Option<String> {
    let sets =
        distinct(rows.iter().map(|r| r.bound.unproven_words()).filter(|words| !words.is_empty()));
    (!sets.is_empty())
        .then(|| format!("* bound with terms that are not proven: {}", sets.join("; ")))
}

/// Energy, contact measure and resultant, where they are known.
fn of_the_solution(rows: &[&Row]) -> Vec<Column> {
    let number = |name, cell| Column { name, left: false, cell };
    let mut columns = Vec::new();
    if rows.iter().any(|r| r.energy.is_some()) {
        columns.push(number("energy", |r| digits(r.energy, 5)));
    }
    if rows.iter().any(|r| r.contact_measure.is_some()) {
        columns.push(number("contact", |r| digits(r.contact_measure, 3)));
        columns.push(number("resultant", |r| digits(r.resultant, 4)));
    }
    columns
}

/// The columns of the second table of `rows`: the figures that the first table leaves out. None if the rows
/// have no such figure.
pub(crate) fn totals(rows: &[&Row]) -> Vec<Column> {
    let text = |name, cell| Column { name, left: true, cell };
    let number = |name, cell| Column { name, left: false, cell };
    let mut columns = vec![text("scheme", |r| r.label.clone())];
    if rows.iter().any(|r| r.solver != rows[0].solver) {
        columns.push(text("solver", |r| r.solver.clone()));
    }
    let is_adaptive = is_adaptive(rows);
    columns.push(number(if is_adaptive { "step" } else { "n" }, |r| r.level.to_string()));
    let names = columns.len();
    if has_errors(rows) {
        columns.extend(of_the_solution(rows));
        if !is_adaptive && rows.iter().any(|r| r.bound.discrete.is_some()) {
            columns.push(number("bound", |r| marked(r, scientific(r.bound.discrete))));
        }
    }
    if rows.iter().any(|r| !r.iterations.stages.is_empty()) {
        columns.push(text("stages (outer)", |r| {
            let stages = r.iterations.stages.iter().map(|s| format!("{} ({})", s.stage, s.outer));
            stages.collect::<Vec<_>>().join(", ")
        }));
    }
    if columns.len() > names { columns } else { Vec::new() }
}

/// The columns of what rows say of several processes: shares of ghosts, imbalance, seconds by phase as least and
/// most. None if the rows are those of one process.
fn of_processes(rows: &[&Row]) -> Vec<Column> {
    let text = |name, cell| Column { name, left: true, cell };
    let number = |name, cell| Column { name, left: false, cell };
    if rows.iter().all(|r| r.ranks.is_none()) {
        return Vec::new();
    }
    fn figure(row: &Row, get: fn(&PartFigures) -> String) -> String {
        row.ranks.as_ref().map_or_else(|| NONE.to_owned(), get)
    }
    fn range([least, most]: [f64; 2]) -> String {
        format!("{least:.2}-{most:.2}")
    }
    vec![
        text("scheme", |r| r.label.clone()),
        number("n", |r| r.level.to_string()),
        number("ranks", |r| figure(r, |p| p.count.to_string())),
        number("ghosts", |r| figure(r, |p| format!("{:.1}%", 100.0 * p.ghosts))),
        number("imbal.", |r| figure(r, |p| format!("{:.3}", p.imbalance))),
        number("linear", |r| r.iterations.linear.to_string()),
        number("assem.", |r| figure(r, |p| range(p.seconds.assemble))),
        number("number", |r| figure(r, |p| range(p.seconds.number))),
        number("start", |r| figure(r, |p| range(p.seconds.start))),
        number("solve", |r| figure(r, |p| range(p.seconds.solve))),
        number("B/it.", |r| {
            figure(r, |p| {
                p.bytes_per_iteration.map_or_else(|| NONE.to_owned(), |bytes| format!("{bytes:.0}"))
            })
        }),
        number("MB", |r| {
            figure(r, |p| {
                let memory = p.peak_memory_bytes.map(|bytes| bytes.map(|b| b as f64 / 1e6));
                memory.map_or_else(|| NONE.to_owned(), |[a, b]| format!("{a:.0}-{b:.0}"))
            })
        }),
    ]
}

/// The lines of a table: its columns, and how wide they are.
struct Lines {
    columns: Vec<Column>,
    widths: Vec<usize>,
    gap: &'static str,
}

impl Lines {
    /// Two blanks between columns where they fit into the width of a table.
    fn new(columns: Vec<Column>, rows: &[&Row]) -> Self {
        let width = |c: &Column| {
            rows.iter().map(|r| (c.cell)(r).len()).chain([c.name.len()]).max().unwrap_or(0)
        };
        let widths: Vec<usize> = columns.iter().map(width).collect();
        let widest = widths.iter().sum::<usize>() + 2 * (widths.len() - 1);
        Self { columns, widths, gap: if widest <= WIDTH { "  " } else { " " } }
    }
    /// One line, without blanks at its end.
    fn write(&self, f: &mut impl fmt::Write, cell: impl Fn(&Column) -> String) -> fmt::Result {
        let mut line = String::new();
        for (column, &width) in self.columns.iter().zip(&self.widths) {
            let cell = cell(column);
            line +=
                &if column.left { format!("{cell:<width$}") } else { format!("{cell:>width$}") };
            line += self.gap;
        }
        writeln!(f, "{}", line.trim_end())
    }
}

/// A number of things.
fn whole(x: Option<usize>) -> String {
    x.map_or_else(|| NONE.to_owned(), |x| x.to_string())
}

/// Three digits and the power of ten: `1.37e-2`.
pub(super) fn scientific(x: Option<f64>) -> String {
    match x {
        Some(0.0) => "0".to_owned(),
        Some(x) if x.is_finite() => format!("{x:.2e}"),
        Some(x) => x.to_string(),
        None => NONE.to_owned(),
    }
}

/// A number with `n` digits after the point and the power of ten: `1.37281e-2`.
fn digits(x: Option<f64>, n: usize) -> String {
    match x {
        Some(x) if x != 0.0 && x.is_finite() => format!("{x:.n$e}"),
        x => scientific(x),
    }
}

/// Two digits after the point: `1.98`.
pub(super) fn fixed(x: Option<f64>) -> String {
    x.map_or_else(|| NONE.to_owned(), |x| format!("{x:.2}"))
}

/// Seconds in six characters, down to what a clock can tell.
pub(super) fn seconds(x: f64) -> String {
    match x {
        x if x > 0.0 && x < 1e-3 => format!("{x:.1e}"),
        x if x < 10.0 => format!("{x:.4}"),
        x if x < 100.0 => format!("{x:.3}"),
        x if x < 1000.0 => format!("{x:.2}"),
        x => format!("{x:.1}"),
    }
}
