//! The tables of a report: for every scene what was run, where the time went, what it costs to reach one
//! error, and how long it takes to reach others.

use super::measured::{Failure, Measured, Phases, scenes, variants};
use super::verdict::at_common_error;
use super::work_at_error::{Standing, WorkAtError};
use crate::measure::ErrorNorm;
use crate::study::Variant;
use crate::study::row::distinct;
use crate::table::{Cell, Table};

/// Columns of errors that fit into a line.
const MOST_ERRORS: usize = 5;

/// What stands in the place of a time.
const MARKS: &str = "> t: not reached by the finest level, which takes t; < t: undercut by the coarsest \
    level, which takes t; not run: the scheme was not run on this scene or on a finer level that was \
    asked for; failed: the level that would decide did not converge";

/// Costs and times to reach errors, scene by scene: the summary of a report.
pub(crate) fn summary(all: &[Measured], failures: &[Failure], reach: &[WorkAtError]) -> Vec<Table> {
    let variants = variants(all);
    let mut tables = Vec::new();
    for scene in scenes(all, failures) {
        tables.extend(costs(scene, &at_common_error(reach, scene), &variants));
        for norm in ErrorNorm::ALL {
            let here = |r: &&WorkAtError| r.variant.scene == scene && r.norm == norm;
            let reach: Vec<&WorkAtError> = reach.iter().filter(here).collect();
            let of_scene = || all.iter().filter(|m| m.row.scene == scene);
            let says_nothing =
                norm == ErrorNorm::Energy && of_scene().all(|m| m.row.error.is_energy_h1());
            if !reach.is_empty() && !says_nothing {
                tables.push(times(scene, norm, &reach, &variants));
            }
        }
    }
    tables
}

/// What was run and where the time went, scene by scene.
pub(crate) fn details(all: &[Measured], failures: &[Failure]) -> Vec<Table> {
    let variants = variants(all);
    let of_scene = |scene| {
        let rows: Vec<&Measured> = all.iter().filter(|m| m.row.scene == scene).collect();
        [runs(failures, scene, &rows, &variants), phases(scene, &rows, &variants)]
    };
    scenes(all, failures).into_iter().flat_map(of_scene).collect()
}

fn head(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

/// Counts, errors, time and memory of every case, failures below.
fn runs(failures: &[Failure], scene: &str, rows: &[&Measured], variants: &[Variant]) -> Table {
    let line = |m: &&Measured| {
        let row = &m.row;
        vec![
            Cell::Words(m.variant().name_among(variants)),
            Cell::whole(Some(row.level)),
            Cell::whole(row.unknowns),
            Cell::whole(row.iterations.outer),
            Cell::whole(Some(row.iterations.linear)),
            Cell::scientific(row.error.l2),
            Cell::scientific(row.error.h1),
            Cell::scientific(row.error.broken_energy),
            Cell::scientific(row.bound.discrete),
            Cell::scientific(Some(row.certificate.largest())),
            Cell::scientific(Some(m.smallest.total)),
            megabytes(row.peak_memory_bytes.map(|b| b as f64)),
        ]
    };
    let failures = failures.iter().filter(|f| f.case.variant.scene == scene);
    Table {
        title: format!("{scene}: runs"),
        columns: head(&[
            "scheme", "n", "unknowns", "outer", "inner", "L2", "H1", "energy", "bound", "certif.",
            "least", "MB",
        ]),
        rows: rows.iter().map(line).collect(),
        remarks: failures
            .map(|f| {
                let name = f.case.variant.name_among(variants);
                format!("failed: {name}, level {}: {}", f.case.level, f.why)
            })
            .collect(),
    }
}

fn megabytes(bytes: Option<f64>) -> Cell {
    Cell::number(bytes.map(|b| format!("{:.0}", b / 1e6)))
}

/// The column of the median over the least time.
const SPREAD: &str = "spread";
const WHAT_SPREAD_IS: &str =
    "spread: the median time of repeated runs over the least; - for what ran once";

/// What is reached, in words, with its value if there is one.
fn reached(norm: ErrorNorm, value: Option<f64>) -> String {
    let value = value.map_or_else(String::new, |value| format!(" of {value:e}"));
    match norm {
        ErrorNorm::Bound => format!("error bound{value}"),
        of_error => format!("error{value} in {}", of_error.name()),
    }
}

/// Time, unknowns and stored entries at one error.
fn costs(scene: &str, reach: &[&WorkAtError], variants: &[Variant]) -> Option<Table> {
    let (error, norm) = reach.first().map(|r| (r.error, r.norm))?;
    let whole = |x: Option<f64>| Cell::whole(x.map(|x| x.round() as usize));
    let line = |r: &&WorkAtError| {
        vec![
            Cell::Words(r.variant.name_among(variants)),
            time(r),
            Cell::fixed(r.median_over_least),
            whole(r.unknowns),
            whole(r.entries),
        ]
    };
    Some(Table {
        title: format!("{scene}: costs at an {}", reached(norm, Some(error))),
        columns: head(&["scheme", "seconds", SPREAD, "unknowns", "entries"]),
        rows: reach.iter().map(line).collect(),
        remarks: vec![WHAT_SPREAD_IS.to_owned()],
    })
}

/// The time to reach an error with the ratio to the fastest, or why there is none.
fn time(at: &WorkAtError) -> Cell {
    let bound = |sign: &str| {
        at.seconds_bound.map_or(Cell::Nothing, |s| Cell::Number(format!("{sign} {s:.2e}"), None))
    };
    match at.standing {
        Standing::Reached => at.seconds.zip(at.ratio).map_or(Cell::Nothing, |(seconds, ratio)| {
            Cell::Number(format!("{seconds:.2e}"), Some(format!("{ratio:.2}")))
        }),
        Standing::NotReached => bound(">"),
        Standing::Undercut => bound("<"),
        Standing::Failed => Cell::Number("failed".to_owned(), None),
        Standing::NotRun => Cell::Number("not run".to_owned(), None),
        Standing::Unknown => Cell::Nothing,
    }
}

/// Where the time of the fastest run went, and how far the run in the middle is from it.
fn phases(scene: &str, rows: &[&Measured], variants: &[Variant]) -> Table {
    let line = |m: &&Measured| {
        let Phases { mesh, assemble, coarse, solve, bound, total } = m.smallest;
        let mut cells = vec![
            Cell::Words(m.variant().name_among(variants)),
            Cell::Words(m.row.linear.clone()),
            Cell::whole(Some(m.row.level)),
        ];
        let seconds = [Some(mesh), Some(assemble), Some(coarse), Some(solve), bound, Some(total)];
        cells.extend(seconds.map(Cell::scientific));
        cells.push(Cell::fixed(m.median_over_least));
        cells.push(Cell::whole(Some(m.runs)));
        cells
    };
    Table {
        title: format!("{scene}: phases of the fastest run"),
        columns: head(&[
            "scheme", "linear", "n", "mesh", "assembly", "start", "solve", "bound", "total",
            SPREAD, "runs",
        ]),
        rows: rows.iter().map(line).collect(),
        remarks: vec![WHAT_SPREAD_IS.to_owned()],
    }
}

/// Times to reach errors, with the ratio to the fastest.
fn times(scene: &str, norm: ErrorNorm, reach: &[&WorkAtError], variants: &[Variant]) -> Table {
    let errors = distinct(reach.iter().map(|r| r.error));
    // the smallest is what matters most, the others as evenly as it goes
    let n = errors.len().min(MOST_ERRORS);
    let errors: Vec<f64> =
        (0..n).map(|k| errors[(errors.len() - 1) * (k + 1) / n.max(1)]).collect();
    let line = |variant: Variant| {
        let mut cells = vec![Cell::Words(variant.name_among(variants))];
        for &error in &errors {
            let at = reach.iter().find(|r| r.variant == variant && r.error == error);
            cells.push(at.map_or(Cell::Nothing, |r| time(r)));
        }
        cells
    };
    let mut columns = head(&["scheme"]);
    columns.extend(errors.iter().map(|e| format!("{e:e}")));
    let mut remarks = vec![format!("in parentheses the ratio to the fastest; {MARKS}")];
    let spreads = reach.iter().filter(|r| errors.contains(&r.error));
    let largest = spreads.filter_map(|r| r.median_over_least).fold(0.0, f64::max);
    if largest > 0.0 {
        remarks.push(format!(
            "the median of repeated runs is up to {largest:.2} times the least: a smaller ratio of two \
             times is no difference"
        ));
    }
    Table {
        title: format!("{scene}: time to reach an {}", reached(norm, None)),
        columns,
        rows: distinct(reach.iter().map(|r| r.variant.clone())).into_iter().map(line).collect(),
        remarks,
    }
}
