//! Measured rows with the times of several runs, and failures.

use std::borrow::{Borrow, BorrowMut};

use serde::Serialize;

use crate::measure::ErrorNorm;
use crate::study::row::distinct;
use crate::study::series::series_of;
use crate::study::{Meshes, Row, Seconds, Variant};

/// A variant on a level, or on all its adaptive meshes: the unit of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// The variant.
    #[serde(flatten)]
    pub variant: Variant,
    /// Subdivisions of the shortest side, or refinements; of a variant on adaptive meshes zero, as all its steps are
    /// one run.
    pub level: usize,
}

impl Case {
    /// Whether the case is all steps of a variant on adaptive meshes.
    pub fn is_adaptive(&self) -> bool {
        self.variant.meshes.is_adaptive()
    }
}

/// Wall times of one run in seconds. They add up to the total, but for the bound of a uniform mesh; on an
/// adaptive mesh they are those of all steps so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Phases {
    /// Making the mesh and all coarser ones it is refined from.
    pub mesh: f64,
    /// Assembly of matrix, load and bounds.
    pub assemble: f64,
    /// The start: conforming P1 on coarser levels and, for other schemes, on this one; on adaptive meshes a
    /// part of the solve.
    pub coarse: f64,
    /// The solve on this level.
    pub solve: f64,
    /// The error bound: on adaptive meshes a part of the total, on uniform ones beside it. None without one.
    pub bound: Option<f64>,
    /// The sum.
    pub total: f64,
}

impl Phases {
    /// The phases of a row whose start took these seconds.
    pub(crate) fn new(seconds: &Seconds, coarse: f64) -> Self {
        let Seconds { mesh, assemble, solve, bound, total } = *seconds;
        Phases { mesh, assemble, coarse, solve: solve - coarse, bound, total }
    }

    /// The times as a row states them, with the start as a part of the solve.
    fn seconds(&self) -> Seconds {
        let Phases { mesh, assemble, coarse, solve, bound, total } = *self;
        Seconds { total, bound, ..Seconds::new(mesh, assemble, solve + coarse) }
    }
}

/// A row with the times of all its runs. Its `seconds` are those of the fastest run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Counts, errors and certificate. `peak_memory_bytes` is the peak of the process during this case.
    #[serde(flatten)]
    pub row: Row,
    /// The meshes.
    pub meshes: Meshes,
    /// Number of runs so far.
    pub runs: usize,
    /// The run with the smallest total.
    pub smallest: Phases,
    /// The run whose total is in the middle, of two in the middle the slower.
    pub median: Phases,
    /// The total of the median run over that of the smallest: a measure of the spread that one disturbed
    /// run does not change. None for a single run.
    pub median_over_least: Option<f64>,
    /// The largest total over the smallest. None for a single run.
    pub largest_over_least: Option<f64>,
    #[serde(skip)]
    all: Vec<Phases>,
}

impl Measured {
    /// The result of a first run.
    pub fn new(row: Row, phases: Phases) -> Self {
        Measured {
            meshes: Meshes::of(&row),
            row,
            runs: 1,
            smallest: phases,
            median: phases,
            median_over_least: None,
            largest_over_least: None,
            all: vec![phases],
        }
    }

    /// Adds a further run. Times may differ, counts may not: if they do, a warning says so.
    pub fn add(&mut self, again: &Row, phases: Phases) {
        let counts = |r: &Row| (r.status, r.unknowns, r.nonzeros, r.iterations.clone(), r.active);
        if counts(again) != counts(&self.row) {
            let warning = "status or counts differ between runs";
            if !self.row.warnings.iter().any(|w| w == warning) {
                self.row.warnings.push(warning.to_owned());
            }
        }
        let at = self.all.partition_point(|p| p.total <= phases.total);
        self.all.insert(at, phases);
        self.runs = self.all.len();
        self.smallest = self.all[0];
        self.median = self.all[self.runs / 2];
        let over_least = |p: &Phases| p.total / self.smallest.total;
        self.median_over_least = Some(over_least(&self.median));
        self.largest_over_least = self.all.last().map(over_least);
        self.row.seconds = self.smallest.seconds();
        if let Some(peak) = again.peak_memory_bytes {
            self.row.peak_memory_bytes =
                Some(self.row.peak_memory_bytes.map_or(peak, |p| p.min(peak)));
        }
    }

    /// The variant it belongs to.
    pub fn variant(&self) -> Variant {
        Variant::of(&self.row)
    }

    /// The seconds of the fastest run that lead to an error in this norm: those of the run, and for the bound of a
    /// uniform mesh its own besides.
    pub fn seconds_to(&self, norm: ErrorNorm) -> f64 {
        match norm {
            ErrorNorm::Bound => self.row.seconds_with_bound(),
            _ => self.smallest.total,
        }
    }

    /// Variant and level, or step.
    pub fn case(&self) -> Case {
        Case { variant: self.variant(), level: self.row.level }
    }
}

impl Borrow<Row> for Measured {
    fn borrow(&self) -> &Row {
        &self.row
    }
}

impl BorrowMut<Row> for Measured {
    fn borrow_mut(&mut self) -> &mut Row {
        &mut self.row
    }
}

/// A case without a solution, and the reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Failure {
    /// The case.
    #[serde(flatten)]
    pub case: Case,
    /// The outcome of the solve, or the reason for which the case was not run.
    pub why: String,
}

impl Failure {
    /// A case that failed for this reason.
    #[must_use]
    pub fn new(case: Case, why: &str) -> Self {
        Self { case, why: why.to_owned() }
    }
}

/// The scenes of rows and failures, in the order in which they first occur.
pub(crate) fn scenes<'a>(rows: &'a [Measured], failures: &'a [Failure]) -> Vec<&'a str> {
    let of_rows = rows.iter().map(|m| m.row.scene.as_str());
    distinct(of_rows.chain(failures.iter().map(|f| f.case.variant.scene.as_str())))
}

/// The variants of rows, in the order in which they first occur.
pub(crate) fn variants(rows: &[Measured]) -> Vec<Variant> {
    series_of(rows).into_iter().map(|series| series.variant).collect()
}
