//! Time, unknowns and memory at a given error, interpolated between the levels that were run.

use serde::Serialize;

use super::measured::{Measured, Variant};
use crate::measure::ErrorNorm;
use crate::study::table::distinct;

/// The error of a row in a norm; none where the run did not converge.
fn error_in(norm: ErrorNorm, measured: &Measured) -> Option<f64> {
    let error = &measured.row.error;
    let value = match norm {
        ErrorNorm::L2 => error.l2,
        ErrorNorm::H1 => error.h1,
        ErrorNorm::Energy => error.energy,
    };
    value.filter(|e| measured.row.converged() && e.is_finite() && *e > 0.0)
}

/// Error and work of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkPoint {
    /// The error; none where the run failed.
    pub error: Option<f64>,
    /// Seconds, unknowns or bytes.
    pub work: f64,
}

/// The work at which a given error is reached, on straight lines between neighbouring levels in
/// logarithmic scales. Points are ordered from coarse to fine. None where no two neighbours that
/// both converged have the error between them: nothing is extrapolated, and no level that failed is
/// bridged.
///
/// ```
/// use unilateral::work_precision::{work_at, WorkPoint};
/// let points = [1e-1, 1e-3].map(|error| WorkPoint { error: Some(error), work: 1.0 / error });
/// assert!((work_at(&points, 1e-2).unwrap() - 100.0).abs() < 1e-10);
/// assert_eq!(work_at(&points, 1e-4), None);
/// ```
pub fn work_at(points: &[WorkPoint], error: f64) -> Option<f64> {
    points.windows(2).find_map(|pair| {
        let (coarse, fine) = (pair[0].error?, pair[1].error?);
        let positive = pair[0].work > 0.0 && pair[1].work > 0.0;
        if !(positive && fine <= error && error <= coarse && fine < coarse) {
            return None;
        }
        let share = (coarse.ln() - error.ln()) / (coarse.ln() - fine.ln());
        let (before, after) = (pair[0].work.ln(), pair[1].work.ln());
        Some((before + share * (after - before)).exp())
    })
}

/// Time, unknowns and memory with which a variant reaches an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct WorkAtError {
    /// The variant.
    #[serde(flatten)]
    pub variant: Variant,
    /// The norm.
    pub norm: ErrorNorm,
    /// The error.
    pub error: f64,
    /// Seconds, from the smallest times; none outside the range measured.
    pub seconds: Option<f64>,
    /// Seconds over those of the fastest variant of the scene.
    pub ratio: Option<f64>,
    /// Number of unknowns.
    pub unknowns: Option<f64>,
    /// Peak of memory.
    pub memory_bytes: Option<f64>,
}

/// All variants at all errors worth comparing at: for every scene and norm the numbers 1, 2 and 5
/// times powers of ten that at least two variants reach, or the only one there is.
pub(crate) fn work_at_errors(rows: &[Measured]) -> Vec<WorkAtError> {
    let mut all = Vec::new();
    for scene in distinct(rows.iter().map(|m| m.row.scene.as_str())) {
        let curves = curves(rows, scene);
        for norm in ErrorNorm::ALL {
            for error in targets(&curves, norm) {
                all.extend(work_of_variants_at(&curves, norm, error));
            }
        }
    }
    all
}

/// The levels of every variant of a scene, in order.
pub(crate) fn curves<'a>(rows: &'a [Measured], scene: &str) -> Vec<(Variant, Vec<&'a Measured>)> {
    let of_scene = || rows.iter().filter(|m| m.row.scene == scene);
    let variants = distinct(of_scene().map(Measured::variant));
    let levels = |variant: Variant| {
        let mut levels: Vec<&Measured> = of_scene().filter(|m| m.variant() == variant).collect();
        levels.sort_by_key(|m| m.row.level);
        (variant, levels)
    };
    variants.into_iter().map(levels).collect()
}

type Curves<'a> = [(Variant, Vec<&'a Measured>)];

fn work_of_variants_at(curves: &Curves<'_>, norm: ErrorNorm, error: f64) -> Vec<WorkAtError> {
    let at = |levels: &[&Measured], work: fn(&Measured) -> Option<f64>| {
        let point = |m: &&Measured| {
            let work = work(m);
            WorkPoint {
                error: error_in(norm, m).filter(|_| work.is_some()),
                work: work.unwrap_or(0.0),
            }
        };
        work_at(&levels.iter().map(point).collect::<Vec<_>>(), error)
    };
    let seconds: Vec<Option<f64>> =
        curves.iter().map(|(_, levels)| at(levels, |m| Some(m.smallest.total))).collect();
    let best = seconds.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let of =
        |((variant, levels), seconds): (&(Variant, Vec<&Measured>), Option<f64>)| WorkAtError {
            variant: variant.clone(),
            norm,
            error,
            seconds,
            ratio: seconds.map(|s| s / best),
            unknowns: at(levels, |m| Some(m.row.unknowns as f64)),
            memory_bytes: at(levels, |m| m.row.peak_memory_bytes.map(|b| b as f64)),
        };
    curves.iter().zip(seconds).map(of).collect()
}

/// Errors to compare at, from large to small.
fn targets(curves: &Curves<'_>, norm: ErrorNorm) -> Vec<f64> {
    let errors = || curves.iter().flat_map(|c| &c.1).filter_map(|m| error_in(norm, m));
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
