//! The tables of work against precision: for every scene where the time went, what it costs to reach one error, and how
//! long it takes to reach others.

use super::verdict::at_common_error;
use super::work_at_error::{Standing, WorkAtError};
use crate::measure::ErrorNorm;
use crate::study::row::distinct;
use crate::study::series::series_of;
use crate::study::{Row, Seconds, Series, Variant};
use crate::table::{Cell, Table, fixed};

/// Columns of errors that fit into a line.
const MOST_ERRORS: usize = 5;

/// The remark that explains the marks in place of a time.
const MARKS: &str = "> t: not reached by the finest level, which takes t; < t: undercut by the coarsest \
    level, which takes t; not run: the scheme was not run on this scene or on a finer level that was \
    asked for; failed: the level that would decide did not converge";

/// Costs and times to reach errors, scene by scene.
pub(super) fn costs_and_times(all: &[Row], reach: &[WorkAtError]) -> Vec<Table> {
    let variants: Vec<Variant> = series_of(all).into_iter().map(|series| series.variant).collect();
    let mut tables = Vec::new();
    for scene in distinct(all.iter().map(|row| row.scene.as_str())) {
        tables.extend(costs(scene, &at_common_error(reach, scene), &variants));
        for norm in ErrorNorm::ALL {
            let here = |r: &&WorkAtError| r.variant.scene == scene && r.norm == norm;
            let reach: Vec<&WorkAtError> = reach.iter().filter(here).collect();
            let of_scene = || all.iter().filter(|row| row.scene == scene);
            let says_nothing =
                norm == ErrorNorm::Energy && of_scene().all(|row| row.error.is_energy_h1());
            if !reach.is_empty() && !says_nothing {
                tables.push(times(scene, norm, &reach, &variants));
            }
        }
    }
    tables
}

/// The remark that explains the column of spreads.
const SPREAD: &str = "spread: the median time of repeated runs over the least; - for what ran once";

/// The error or bound that is reached, in words, with its value if there is one.
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
        detail: format!(" at an {}", reached(norm, Some(error))),
        remarks: vec![SPREAD.to_owned()],
        ..Table::new(
            format!("{scene}: costs"),
            "scheme,seconds,spread,unknowns,entries",
            reach.iter().map(line).collect(),
        )
    })
}

/// The time to reach an error with the ratio to the fastest, or why there is none.
fn time(at: &WorkAtError) -> Cell {
    let bound =
        |sign: &str| Cell::number(at.seconds_bound.map(|seconds| format!("{sign} {seconds:.2e}")));
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
pub(super) fn phases(scene: &str, series: &[&Series<'_>]) -> Table {
    let line = |(name, row): (&String, &Row)| {
        let Seconds { mesh, assemble, solve, start, bound, total } = row.seconds;
        let mut cells = vec![Cell::Words(name.clone()), Cell::whole(Some(row.level))];
        let solve = solve - start.unwrap_or(0.0);
        let seconds = [Some(mesh), Some(assemble), start, Some(solve), bound, Some(total)];
        cells.extend(seconds.map(|x| Cell::digits(x, 2)));
        cells.push(Cell::number(row.median_over_least().map(fixed)));
        cells.push(Cell::whole(row.runs.as_ref().map(Vec::len)));
        cells
    };
    let rows = series.iter().flat_map(|of| of.rows.iter().map(move |&row| (&of.name, row)));
    let rows = rows.filter(|(_, row)| row.runs.is_some()).map(line).collect();
    Table {
        remarks: vec![SPREAD.to_owned()],
        ..Table::new(
            format!("{scene}: phases of the fastest run, in seconds"),
            "scheme,n,mesh,assembly,start,solve,bound,total,spread,runs",
            rows,
        )
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
    let heads = errors.iter().map(|error| format!(",{error:e}")).collect::<String>();
    let mut remarks = vec![format!("in parentheses the ratio to the fastest; {MARKS}")];
    let spreads = reach.iter().filter(|r| errors.contains(&r.error));
    let largest = spreads.filter_map(|r| r.median_over_least).fold(0.0, f64::max);
    if largest > 0.0 {
        remarks.push(format!(
            "the median of repeated runs is up to {largest:.2} times the least: a smaller ratio of two \
             times is no difference"
        ));
    }
    let lines = distinct(reach.iter().map(|r| r.variant.clone())).into_iter().map(line).collect();
    let title = format!("{scene}: time to reach an {}", reached(norm, None));
    Table { remarks, ..Table::new(title, &format!("scheme{heads}"), lines) }
}
