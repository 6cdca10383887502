//! The tables of a report: for every scene what was run, where the time went, and what it takes to
//! reach given errors.

use super::measured::{Failure, Measured, Phases, Variant, scenes, variants};
use super::work_at_error::WorkAtError;
use crate::measure::ErrorNorm;
use crate::output::Table;
use crate::output::table::Cell;
use crate::study::table::distinct;

/// Columns of errors that fit into a line.
const MOST_ERRORS: usize = 5;

/// All tables, scene by scene.
pub(crate) fn tables(all: &[Measured], failures: &[Failure], reach: &[WorkAtError]) -> Vec<Table> {
    let variants = variants(all);
    let mut tables = Vec::new();
    for scene in scenes(all, failures) {
        let rows: Vec<&Measured> = all.iter().filter(|m| m.row.scene == scene).collect();
        tables.push(runs(failures, scene, &rows, &variants));
        tables.push(phases(scene, &rows, &variants));
        for norm in ErrorNorm::ALL {
            let here = |r: &&WorkAtError| r.variant.scene == scene && r.norm == norm;
            let reach: Vec<&WorkAtError> = reach.iter().filter(here).collect();
            if !reach.is_empty() {
                tables.push(times(scene, norm, &reach, &variants));
            }
        }
    }
    tables
}

fn head(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

/// Counts, errors, time and memory of every case, failures below.
fn runs(failures: &[Failure], scene: &str, rows: &[&Measured], variants: &[Variant]) -> Table {
    let line = |m: &&Measured| {
        let row = &m.row;
        let c = &row.certificate;
        let certificate = [c.feasibility, c.multiplier, c.complementarity, c.residual];
        // what is not a number counts as larger than any
        let worse = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
        vec![
            Cell::Words(m.variant().name_among(variants)),
            Cell::whole(Some(row.level)),
            Cell::whole(Some(row.unknowns)),
            Cell::whole(row.iterations.outer),
            Cell::whole(Some(row.iterations.linear)),
            Cell::scientific(row.error.l2),
            Cell::scientific(row.error.h1),
            Cell::scientific(row.error.energy),
            Cell::scientific(Some(certificate.into_iter().fold(0.0, worse))),
            Cell::scientific(Some(m.smallest.total)),
            row.peak_memory_bytes
                .map_or(Cell::Nothing, |b| Cell::Number(format!("{:.0}", b as f64 / 1e6), None)),
        ]
    };
    let failures = failures.iter().filter(|f| f.case.variant.scene == scene);
    Table {
        title: format!("{scene}: runs"),
        columns: head(&[
            "scheme", "n", "unknowns", "outer", "inner", "L2", "H1", "energy", "certif.", "best",
            "MB",
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

/// Where the time of the fastest run went, and the time of the run in the middle.
fn phases(scene: &str, rows: &[&Measured], variants: &[Variant]) -> Table {
    let line = |m: &&Measured| {
        let Phases { mesh, assemble, coarse, solve, total } = m.smallest;
        let mut cells = vec![
            Cell::Words(m.variant().name_among(variants)),
            Cell::Words(m.row.linear.clone()),
            Cell::whole(Some(m.row.level)),
        ];
        let seconds = [mesh, assemble, coarse, solve, total, m.median.total];
        cells.extend(seconds.map(|s| Cell::scientific(Some(s))));
        cells.push(Cell::whole(Some(m.runs)));
        cells
    };
    Table {
        title: format!("{scene}: phases of the fastest run, and the median of all"),
        columns: head(&[
            "scheme", "linear", "n", "mesh", "assembly", "start", "solve", "total", "median",
            "runs",
        ]),
        rows: rows.iter().map(line).collect(),
        remarks: Vec::new(),
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
            let number = at.and_then(|r| Some((r.seconds?, r.ratio?)));
            cells.push(number.map_or(Cell::Nothing, |(seconds, ratio)| {
                Cell::Number(format!("{seconds:.2e}"), Some(format!("{ratio:.2}")))
            }));
        }
        cells
    };
    let mut columns = head(&["scheme"]);
    columns.extend(errors.iter().map(|e| format!("{e:e}")));
    let mut remarks = vec!["in parentheses the ratio to the fastest".to_owned()];
    if norm == ErrorNorm::Energy {
        remarks.push("every scheme measures its own norm".to_owned());
    }
    Table {
        title: format!("{scene}: time to reach an error in {}", norm.name()),
        columns,
        rows: distinct(reach.iter().map(|r| r.variant.clone())).into_iter().map(line).collect(),
        remarks,
    }
}
