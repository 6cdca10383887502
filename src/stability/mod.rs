//! Stability study: difficult cases, each with sweeps, criteria, and a verdict on each figure.

mod at;
mod case;
mod cases;
mod meshes;
mod place;
mod report;
mod row;
mod table;

pub use case::{Criterion, Effort};
pub use cases::{STABILITY_CASES, criteria};
pub use meshes::slivers;
pub use report::StabilityReport;
pub use row::{ExpectedRange, StabilityRow, Verdict};

use std::fmt;
use std::path::PathBuf;

use crate::error::Error;
use crate::in_its_dimension;
use crate::mesh::Mesh;
use crate::scheme::NamedScheme;
use crate::study::row::distinct;
use at::{At, Ran, Run};
use case::{Asked, Column, Plan, Sweep};
use cases::CASES;

/// A function that receives the case and the scheme that begin.
type Observer<'a> = Box<dyn Fn(&str, &str) + 'a>;

/// The stability study.
///
/// ```
/// use unilateral::stability::{Effort, Stability};
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let report = Stability::new(Effort::Quick).cases(["scaling"]).schemes(["p1", "sipg"]).run()?;
/// assert!(report.rows.iter().all(|row| row.case == "scaling"));
/// # Ok(())
/// # }
/// ```
pub struct Stability<'a> {
    effort: Effort,
    cases: Vec<String>,
    schemes: Vec<String>,
    meshes: Vec<(String, Mesh<3>)>,
    command: Option<String>,
    directory: Option<PathBuf>,
    observer: Observer<'a>,
}

impl fmt::Debug for Stability<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stability")
            .field("effort", &self.effort)
            .field("cases", &self.cases)
            .field("schemes", &self.schemes)
            .finish_non_exhaustive()
    }
}

impl<'a> Stability<'a> {
    /// The schemes there are, with the placement of their bounds after a colon if it is not the default. All but the
    /// last are compared in every case.
    pub const SCHEMES: [&'static str; 7] =
        ["p1", "cr", "sipg", "wopsip", "wopsip:facet-means", "p2", "nipg"];

    /// A study of all cases and schemes.
    #[must_use]
    pub fn new(effort: Effort) -> Self {
        Self {
            effort,
            cases: Vec::new(),
            schemes: Vec::new(),
            meshes: Vec::new(),
            command: None,
            directory: None,
            observer: Box::new(|_, _| {}),
        }
    }
    /// Runs these cases only, by name: see [`STABILITY_CASES`].
    pub fn cases<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.cases = names.into_iter().map(Into::into).collect();
        self
    }
    /// Runs these schemes only, written as [`NamedScheme`] reads them: [`Stability::SCHEMES`] with all
    /// choices of penalties that cases make, others with their own in every case that compares schemes.
    pub fn schemes<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.schemes = names.into_iter().map(Into::into).collect();
        self
    }
    /// Adds a mesh of tetrahedra under a name.
    #[must_use]
    pub fn mesh(mut self, name: &str, mesh: Mesh<3>) -> Self {
        self.meshes.push((name.to_owned(), mesh));
        self
    }
    /// States the command that makes the report again.
    #[must_use]
    pub fn command(mut self, command: Option<String>) -> Self {
        self.command = command;
        self
    }
    /// Writes the report to this directory after every sweep.
    #[must_use]
    pub fn write_to(mut self, directory: impl Into<PathBuf>) -> Self {
        self.directory = Some(directory.into());
        self
    }
    /// Sets a function that receives the case and the scheme that begin.
    #[must_use]
    pub fn observer(mut self, observer: impl Fn(&str, &str) + 'a) -> Self {
        self.observer = Box::new(observer);
        self
    }

    /// Checks cases and schemes without running any. Returns the schemes that are asked for.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a case that does not exist or a scheme that is wrong.
    pub fn check(&self) -> Result<Vec<NamedScheme>, Error> {
        if let Some(name) = self.cases.iter().find(|name| !STABILITY_CASES.contains(&&name[..])) {
            let allowed = format!("there are: {}", STABILITY_CASES.join(", "));
            return Err(Error::parameter("case", name, allowed));
        }
        NamedScheme::list(self.schemes.iter().map(String::as_str))
            .map_err(|why| Error::parameter("scheme", self.schemes.join(","), why))
    }

    /// Runs everything.
    ///
    /// # Errors
    /// Those of [`Self::check`], before anything runs; [`Error::Write`]. Errors of a run are listed in
    /// [`StabilityReport::failures`].
    pub fn run(&self) -> Result<StabilityReport, Error> {
        let wanted = self.check()?;
        let plan = Plan { effort: self.effort, meshes: &self.meshes };
        let mut report = StabilityReport::new(self.effort);
        report.program.command.clone_from(&self.command);
        self.save(&report)?;
        for case in &CASES {
            if !self.cases.is_empty() && !self.cases.iter().any(|name| name == case.name) {
                continue;
            }
            let sweeps = (case.sweeps)(&plan).unwrap_or_else(|why| {
                report.failures.push(format!("{}: {why}", case.name));
                Vec::new()
            });
            for sweep in sweeps {
                self.run_sweep(case.name, &sweep, &wanted, &mut report);
                // rows are saved early, so that an interrupted study keeps them
                self.save(&report)?;
            }
        }
        report.complete = true;
        self.save(&report)?;
        Ok(report)
    }

    /// Runs the schemes of a sweep at all places, those first to which figures refer, and adds the rows of those that are
    /// asked for.
    fn run_sweep(
        &self,
        case: &str,
        sweep: &Sweep,
        wanted: &[NamedScheme],
        report: &mut StabilityReport,
    ) {
        let judged = judged(sweep, wanted);
        let beside = sweep.beside.iter().filter(|_| !judged.is_empty());
        let mut ran = Ran { parameter: sweep.parameter, places: &sweep.places, runs: Vec::new() };
        for &scheme in distinct(beside.chain(&judged)) {
            (self.observer)(case, &scheme.to_string());
            let mut run = |place| {
                at::run(place, &scheme).unwrap_or_else(|why| {
                    report.failures.push(format!("{case}, {scheme}: {why}"));
                    Run::default()
                })
            };
            let runs = sweep.places.iter().map(&mut run).collect();
            ran.runs.push((scheme, runs));
        }
        for scheme in (0..ran.runs.len()).filter(|&k| judged.contains(&ran.runs[k].0)) {
            for place in 0..sweep.places.len() {
                let at = At { ran: &ran, scheme, place };
                let is_last = place + 1 == sweep.places.len();
                let columns = sweep.columns.iter().filter(|of| is_last || !of.is_of_all);
                let columns = columns.filter(|_| !at.rows().is_empty());
                report.rows.extend(columns.filter_map(|of| row_of(case, &at, of)));
            }
        }
    }

    fn save(&self, report: &StabilityReport) -> Result<(), Error> {
        match &self.directory {
            Some(directory) => report.write(directory).map(|_| ()),
            None => Ok(()),
        }
    }
}

/// The row of a run in a column; none if nothing is asked of it.
fn row_of(case: &str, at: &At<'_>, column: &Column) -> Option<StabilityRow> {
    let limits = column.criterion.limits;
    let expected = match (column.asked)(at) {
        Asked::NoRow => return None,
        Asked::Report => ExpectedRange::default(),
        Asked::Limit(number) => limits[number],
        Asked::Failure(number) => ExpectedRange { to_fail: true, ..limits[number] },
    };
    let measured = (column.figure)(at).filter(|figure| figure.is_finite());
    let (place, value) = (at.place(), at.value());
    Some(StabilityRow {
        case: case.to_owned(),
        criterion: column.criterion.name.to_owned(),
        scheme: at.scheme().label_without_choices(),
        label: at.scheme().to_string(),
        precision: place.precision.name().to_owned(),
        problem: in_its_dimension!(&place.scene, |scene| scene.name.clone()),
        level: place.shown.filter(|_| !column.is_of_all),
        parameter: value.map_or("", |_| at.ran.parameter).to_owned(),
        value,
        quantity: column.quantity.clone(),
        expected,
        measured,
        detail: at.figures(),
        verdict: Verdict::on(&expected, measured),
    })
}

/// The schemes of a sweep whose rows are asked for, by the schemes themselves or without choices of penalties.
fn judged(sweep: &Sweep, wanted: &[NamedScheme]) -> Vec<NamedScheme> {
    let known = Stability::SCHEMES;
    let besides = wanted.iter().filter(|scheme| !known.contains(&&scheme.to_string()[..]));
    let compared = known[..6].iter().map(|name| place::scheme(name)).chain(besides.copied());
    let mut all =
        distinct(compared.filter(|_| sweep.compares).chain(sweep.schemes.iter().copied()));
    all.retain(|scheme| {
        let names = [scheme.to_string(), scheme.label_without_choices()];
        wanted.is_empty() || wanted.iter().any(|of| names.contains(&of.to_string()))
    });
    all
}
