//! Time, unknowns and entries at a given error, interpolated between the levels that were run.

use serde::Serialize;

use crate::inequality::Outcome;
use crate::measure::ErrorNorm;
use crate::study::row::Row;
use crate::study::series::{by_scene, series_of};
use crate::study::{Series, Variant};

/// The error of a row in a norm; none where the run did not converge.
fn error_in(norm: ErrorNorm, row: &Row) -> Option<f64> {
    let value = match norm {
        ErrorNorm::L2 => row.error.l2,
        ErrorNorm::H1 => row.error.h1,
        ErrorNorm::Energy => row.error.broken_energy,
        ErrorNorm::Bound => row.bound.discrete,
    };
    value.filter(|e| row.converged() && e.is_finite() && *e > 0.0)
}

/// The work (seconds, unknowns or entries) at which a given error is reached, on straight lines between neighbouring
/// levels in logarithmic scales. Levels have their error and its work, none where the run failed, and are ordered from
/// coarse to fine. None where no two neighbours that both converged have the error between them: nothing is
/// extrapolated, and no level that failed is bridged.
fn work_at(levels: &[Option<(f64, f64)>], error: f64) -> Option<f64> {
    levels.windows(2).find_map(|pair| {
        let [(coarse, before), (fine, after)] = [pair[0]?, pair[1]?];
        let positive = before > 0.0 && after > 0.0;
        if !(positive && fine <= error && error <= coarse && fine < coarse) {
            return None;
        }
        let share = (coarse.ln() - error.ln()) / (coarse.ln() - fine.ln());
        let (before, after) = (before.ln(), after.ln());
        Some((before + share * (after - before)).exp())
    })
}

/// Where an error stands among the errors of the levels of a variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Standing {
    /// Between two neighbouring levels that converged.
    Reached,
    /// The finest level has a larger error, and no finer one was asked for.
    NotReached,
    /// The coarsest level has a smaller error already.
    Undercut,
    /// The level that would decide did not converge.
    Failed,
    /// The variant was not run on the scene, or a level that was asked for and is finer than those run
    /// was not.
    NotRun,
    /// The variant has no error in this norm.
    Unknown,
}

/// Time, unknowns and entries with which a variant reaches an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct WorkAtError {
    /// The variant.
    #[serde(flatten)]
    pub variant: Variant,
    /// The norm, or the bound.
    pub norm: ErrorNorm,
    /// The error.
    pub error: f64,
    /// Where the error stands among those of the levels.
    pub standing: Standing,
    /// Seconds, from the smallest times; none unless the error is reached.
    pub seconds: Option<f64>,
    /// Seconds of the coarsest level if that undercuts the error, of the finest one if the error is not
    /// reached.
    pub seconds_bound: Option<f64>,
    /// The median of the times of repeated runs over the smallest one.
    pub median_over_least: Option<f64>,
    /// Seconds over those of the fastest variant of the scene.
    pub ratio: Option<f64>,
    /// Number of unknowns.
    pub unknowns: Option<f64>,
    /// Entries stored in the matrix.
    pub entries: Option<f64>,
}

/// All variants of the report at all errors worth comparing at: for every scene and norm the numbers 1,
/// 2 and 5 times powers of ten that at least two variants reach, or the only one there is.
pub(crate) fn work_at_errors(rows: &[Row]) -> Vec<WorkAtError> {
    let mut all = Vec::new();
    let series = series_of(rows);
    for (scene, own) in by_scene(&series) {
        let run: Vec<Curve<'_>> = own.into_iter().map(Curve::of).collect();
        let mut curves = run.clone();
        for other in series.iter().map(|of| &of.variant) {
            let variant = Variant { scene: scene.to_owned(), ..other.clone() };
            if !curves.iter().any(|of| of.variant == variant) {
                curves.push(Curve { variant, rows: &[], begun: Vec::new() });
            }
        }
        for norm in ErrorNorm::ALL {
            for error in targets(&run, norm) {
                all.extend(work_of_variants_at(&curves, norm, error));
            }
        }
    }
    all
}

/// The rows of a variant on a scene, from coarse to fine.
#[derive(Clone)]
struct Curve<'r> {
    variant: Variant,
    rows: &'r [&'r Row],
    /// Those that were run: the others took too long, or do not fit into the memory.
    begun: Vec<&'r Row>,
}

impl<'r> Curve<'r> {
    fn of(series: &'r Series<'r>) -> Self {
        let is_begun = |row: &Row| !matches!(row.status, Outcome::TimeLimit | Outcome::OutOfMemory);
        let begun = series.rows.iter().copied().filter(|row| is_begun(row)).collect();
        Self { variant: series.variant.clone(), rows: &series.rows, begun }
    }
}

fn work_of_variants_at(curves: &[Curve<'_>], norm: ErrorNorm, error: f64) -> Vec<WorkAtError> {
    let at = |curve: &Curve<'_>, work: &dyn Fn(&Row) -> Option<f64>| {
        let point = |row: &&Row| error_in(norm, row).zip(work(row));
        work_at(&curve.rows.iter().map(point).collect::<Vec<_>>(), error)
    };
    let seconds: Vec<Option<f64>> =
        curves.iter().map(|curve| at(curve, &|row| Some(row.seconds_to(norm)))).collect();
    let best = seconds.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let of = |(curve, seconds): (&Curve<'_>, Option<f64>)| {
        let standing = match seconds {
            Some(_) => Standing::Reached,
            None => standing(curve, norm, error),
        };
        let bound = match standing {
            Standing::Undercut => curve.begun.first(),
            Standing::NotReached => curve.begun.last(),
            _ => None,
        };
        WorkAtError {
            variant: curve.variant.clone(),
            norm,
            error,
            standing,
            seconds,
            seconds_bound: bound.map(|row| row.seconds_to(norm)),
            median_over_least: at(curve, &Row::median_over_least),
            ratio: seconds.map(|s| s / best),
            unknowns: at(curve, &|row| row.unknowns.map(|n| n as f64)),
            entries: at(curve, &|row| row.nonzeros.map(|n| n as f64)),
        }
    };
    curves.iter().zip(seconds).map(of).collect()
}

/// Where an error stands that is not between two neighbouring levels that converged.
fn standing(curve: &Curve<'_>, norm: ErrorNorm, error: f64) -> Standing {
    let (Some(&first), Some(&last)) = (curve.begun.first(), curve.begun.last()) else {
        return Standing::NotRun;
    };
    let is_below = |row: &Row| error_in(norm, row).is_some_and(|e| e <= error);
    let without_error = |some: &[&Row]| match some.iter().any(|row| !row.converged()) {
        true => Standing::Failed,
        false => Standing::Unknown,
    };
    match () {
        () if is_below(first) => Standing::Undercut,
        // no level that failed is bridged
        () if curve.begun.iter().any(|row| is_below(row)) => without_error(&curve.begun),
        () if error_in(norm, last).is_none() => without_error(&[last]),
        () if curve.begun.len() < curve.rows.len() => Standing::NotRun,
        () => Standing::NotReached,
    }
}

/// Errors to compare at, from large to small.
fn targets(curves: &[Curve<'_>], norm: ErrorNorm) -> Vec<f64> {
    let errors = || curves.iter().flat_map(|c| c.rows).filter_map(|row| error_in(norm, row));
    let low = errors().fold(f64::INFINITY, f64::min);
    let high = errors().fold(0.0, f64::max);
    if low > high {
        return Vec::new();
    }
    let reached = |error: &f64| {
        let seconds =
            work_of_variants_at(curves, norm, *error).into_iter().filter(|r| r.seconds.is_some());
        seconds.count() >= curves.len().min(2)
    };
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let digits = |exponent: i32| [5, 2, 1].map(|digit| format!("{digit}e{exponent}"));
    // read from text, so that the numbers are the nearest to what is written
    let numbers = (first..=last).rev().flat_map(digits).filter_map(|t| t.parse::<f64>().ok());
    numbers.filter(reached).collect()
}
