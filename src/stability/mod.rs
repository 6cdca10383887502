//! Stability study: difficult cases, each with a sweep, a criterion, and a verdict on each figure.

mod case;
mod cases;
mod choice;
mod criterion;
#[cfg(feature = "plot")]
mod figures;
mod meshes;
mod plan;
mod report;
mod row;
mod row_builder;
mod runs;
mod summary;
mod unweighted;

pub use cases::{STABILITY_CASES, criteria};
pub use criterion::Criterion;
pub use meshes::slivers;
pub use plan::Effort;
pub use report::StabilityReport;
pub use row::{ExpectedRange, StabilityRow, Verdict};

use std::fmt;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::error::Error;
use crate::mesh::Mesh;
use crate::scheme::NamedScheme;
use cases::CASES;
use plan::Plan;

/// The least time between two writes of finished rows.
const WRITE_INTERVAL: Duration = Duration::from_millis(500);

/// Progress of a study.
#[derive(Debug)]
#[non_exhaustive]
pub enum StabilityProgress<'a> {
    /// The number of jobs that follow.
    Planned(usize),
    /// A job begins: case, and scheme or problem.
    Started(&'a str, &'a str),
    /// The job ended.
    Finished,
}

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
    given: Vec<(String, Mesh<3>)>,
    command: Option<String>,
    directory: Option<PathBuf>,
    observer: Box<dyn Fn(StabilityProgress<'_>) + 'a>,
}

impl fmt::Debug for Stability<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let meshes: Vec<&str> = self.given.iter().map(|(name, _)| &**name).collect();
        f.debug_struct("Stability")
            .field("effort", &self.effort)
            .field("cases", &self.cases)
            .field("schemes", &self.schemes)
            .field("meshes", &meshes)
            .field("directory", &self.directory)
            .finish_non_exhaustive()
    }
}

impl<'a> Stability<'a> {
    /// A study of all cases and schemes.
    #[must_use]
    pub fn new(effort: Effort) -> Self {
        Self {
            effort,
            cases: Vec::new(),
            schemes: Vec::new(),
            given: Vec::new(),
            command: None,
            directory: None,
            observer: Box::new(|_| {}),
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
        self.given.push((name.to_owned(), mesh));
        self
    }
    /// States the command that makes the report again.
    #[must_use]
    pub fn command(mut self, command: Option<String>) -> Self {
        self.command = command;
        self
    }
    /// Writes the report to this directory as rows come, twice a second at most, and at the end.
    #[must_use]
    pub fn write_to(mut self, directory: impl Into<PathBuf>) -> Self {
        self.directory = Some(directory.into());
        self
    }
    /// Sets a function that receives the progress of the study.
    #[must_use]
    pub fn observer(mut self, observer: impl Fn(StabilityProgress<'_>) + 'a) -> Self {
        self.observer = Box::new(observer);
        self
    }
    /// The schemes there are, with the placement of their bounds after a colon if it is not the
    /// default.
    pub const SCHEMES: [&'static str; 7] = choice::NAMES;

    /// Checks cases and schemes without running any.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a case that does not exist or a scheme that is wrong.
    pub fn check(&self) -> Result<(), Error> {
        self.plan().map(|_| ())
    }

    /// Runs everything.
    ///
    /// # Errors
    /// Those of [`Self::check`], before anything runs; [`Error::Write`]. Errors of a job are listed in
    /// [`StabilityReport::failures`].
    pub fn run(&self) -> Result<StabilityReport, Error> {
        let plan = self.plan()?;
        (self.observer)(StabilityProgress::Planned(plan.jobs.len()));
        let mut report = StabilityReport::new(self.effort);
        report.program.command.clone_from(&self.command);
        let mut written = Instant::now();
        for job in &plan.jobs {
            (self.observer)(StabilityProgress::Started(job.case, &job.label));
            let mut saved = Ok(());
            let mut take = |row: StabilityRow| {
                report.rows.push(StabilityRow { case: job.case.to_owned(), ..row });
                // rows are saved early, so that an interrupted study keeps them
                if written.elapsed() > WRITE_INTERVAL && saved.is_ok() {
                    saved = self.save(&report);
                    written = Instant::now();
                }
            };
            if let Err(why) = (job.run)(&mut take) {
                report.failures.push(format!("{}, {}: {why}", job.case, job.label));
            }
            saved?;
            (self.observer)(StabilityProgress::Finished);
        }
        report.complete = true;
        self.save(&report)?;
        Ok(report)
    }

    fn save(&self, report: &StabilityReport) -> Result<(), Error> {
        match &self.directory {
            Some(directory) => report.write(directory).map(|_| ()),
            None => Ok(()),
        }
    }

    fn plan(&self) -> Result<Plan<'_>, Error> {
        if let Some(name) = self.cases.iter().find(|name| !STABILITY_CASES.contains(&&name[..])) {
            let allowed = format!("there are: {}", STABILITY_CASES.join(", "));
            return Err(Error::parameter("case", name, allowed));
        }
        let wanted = NamedScheme::list(self.schemes.iter().map(String::as_str))
            .map_err(|why| Error::parameter("scheme", self.schemes.join(","), why))?;
        let (effort, given) = (self.effort, &self.given[..]);
        let mut plan = Plan { effort, wanted, given, case: "", jobs: Vec::new() };
        let is_chosen = |case: &str| self.cases.is_empty() || self.cases.iter().any(|c| c == case);
        for case in CASES.into_iter().filter(|case| is_chosen(case.name)) {
            plan.case = case.name;
            (case.plan)(&mut plan);
        }
        Ok(plan)
    }
}
