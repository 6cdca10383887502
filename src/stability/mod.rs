//! Stability: hard cases, each with a sweep, a criterion, and a verdict made from the figures.

mod cases;
mod choice;
mod claim;
mod criteria;
mod limit;
mod meshes;
mod report;
mod row;
mod runs;
mod summary;

pub use criteria::{CRITERIA, Criterion, STABILITY_CASES};
pub use report::StabilityReport;
pub use row::{Expected, StabilityRow, Verdict};

use std::fmt;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::error::Error;
use crate::mesh::Mesh;
use choice::Choice;

/// How long finished rows may wait to be written.
const PATIENCE: Duration = Duration::from_millis(500);

/// How much is run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// The coarsest meshes: figures mean little, but every criterion has its rows.
    Trial,
    /// Coarse meshes and few places of each sweep; every criterion has its rows.
    #[default]
    Quick,
    /// All sweeps.
    Full,
}

/// What a study tells whoever watches it.
#[derive(Debug)]
pub enum StabilityProgress<'a> {
    /// This many pieces of work will follow.
    Planned(usize),
    /// A piece begins: case, and scheme or problem.
    Started(&'a str, &'a str),
    /// A row is there.
    Row(&'a StabilityRow),
    /// The piece ended.
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
    given: Vec<(String, Mesh<f64, 3>)>,
    directory: Option<PathBuf>,
    observer: Box<dyn Fn(StabilityProgress<'_>) + 'a>,
}

/// Takes rows as they are made.
type Sink<'s> = &'s mut dyn FnMut(StabilityRow);

/// Makes rows.
type Run<'p> = Box<dyn Fn(Sink<'_>) -> Result<(), Error> + 'p>;

/// A piece of work: its rows do not depend on any other's.
struct Job<'p> {
    case: &'static str,
    label: String,
    run: Run<'p>,
}

/// What will be run.
struct Plan<'p> {
    effort: Effort,
    schemes: &'p [String],
    given: &'p [(String, Mesh<f64, 3>)],
    jobs: Vec<Job<'p>>,
}

impl<'p> Plan<'p> {
    fn is_full(&self) -> bool {
        self.effort == Effort::Full
    }
    /// One of two, by effort.
    fn pick<T>(&self, quick: T, full: T) -> T {
        if self.is_full() { full } else { quick }
    }
    /// The same with something smaller for a trial.
    fn pick_of<T>(&self, trial: T, quick: T, full: T) -> T {
        if self.effort == Effort::Trial { trial } else { self.pick(quick, full) }
    }
    /// Adds work on a scheme, if that scheme is wanted.
    fn add(
        &mut self,
        case: &'static str,
        choice: Choice,
        what: &str,
        run: impl Fn(&Choice, Sink<'_>) -> Result<(), Error> + 'p,
    ) {
        if self.schemes.is_empty() || self.schemes.iter().any(|s| s == choice.scheme) {
            let label = format!("{} {} {what}", choice.scheme, choice.words());
            let run = Box::new(move |sink: Sink<'_>| run(&choice, sink));
            self.jobs.push(Job { case, label, run });
        }
    }
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
            directory: None,
            observer: Box::new(|_| {}),
        }
    }
    /// Runs these cases only, by name: see [`STABILITY_CASES`].
    pub fn cases<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.cases = names.into_iter().map(Into::into).collect();
        self
    }
    /// Runs these schemes only: see [`Stability::SCHEMES`].
    pub fn schemes<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.schemes = names.into_iter().map(Into::into).collect();
        self
    }
    /// Adds a mesh of tetrahedra under a name.
    #[must_use]
    pub fn mesh(mut self, name: &str, mesh: Mesh<f64, 3>) -> Self {
        self.given.push((name.to_owned(), mesh));
        self
    }
    /// Writes the report to this directory as rows come, twice a second at most, and at the end.
    #[must_use]
    pub fn write_to(mut self, directory: impl Into<PathBuf>) -> Self {
        self.directory = Some(directory.into());
        self
    }
    /// Sets who is told of progress.
    #[must_use]
    pub fn observer(mut self, observer: impl Fn(StabilityProgress<'_>) + 'a) -> Self {
        self.observer = Box::new(observer);
        self
    }
    /// The schemes there are, with the placement of their bounds after a colon if it is not the
    /// default.
    pub const SCHEMES: [&'static str; 7] = choice::NAMES;

    /// Runs everything.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the name of a case or scheme that does not exist, before anything
    /// runs; [`Error::Write`]. What goes wrong within a case is told by its rows.
    pub fn run(&self) -> Result<StabilityReport, Error> {
        let check = |parameter, names: &[String], known: &[&str]| match names
            .iter()
            .find(|name| !known.contains(&name.as_str()))
        {
            None => Ok(()),
            Some(name) => Err(Error::Parameter {
                parameter,
                value: name.clone(),
                allowed: format!("there are: {}", known.join(", ")),
            }),
        };
        check("case", &self.cases, &STABILITY_CASES)?;
        check("scheme", &self.schemes, &Self::SCHEMES)?;
        let plan = self.plan();
        (self.observer)(StabilityProgress::Planned(plan.jobs.len()));
        let mut report = StabilityReport::new(self.effort);
        let mut written = Instant::now();
        for job in &plan.jobs {
            (self.observer)(StabilityProgress::Started(job.case, &job.label));
            let mut saved = Ok(());
            let mut take = |row: StabilityRow| {
                (self.observer)(StabilityProgress::Row(&row));
                report.rows.push(row);
                // whoever interrupts the study keeps the rows that are there
                if written.elapsed() > PATIENCE && saved.is_ok() {
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
        report.provenance.complete = true;
        self.save(&report)?;
        Ok(report)
    }

    fn save(&self, report: &StabilityReport) -> Result<(), Error> {
        match &self.directory {
            Some(directory) => report.write(directory).map(|_| ()),
            None => Ok(()),
        }
    }

    fn plan(&self) -> Plan<'_> {
        let (schemes, given) = (&self.schemes, &self.given);
        let mut plan = Plan { effort: self.effort, schemes, given, jobs: Vec::new() };
        for case in STABILITY_CASES {
            if !self.cases.is_empty() && !self.cases.iter().any(|c| c == case) {
                continue;
            }
            match case {
                "round-off" => {
                    cases::round_off::plan(&mut plan);
                    limit::plan(&mut plan);
                }
                "penalty-factor" => {
                    cases::over_penalty::plan(&mut plan);
                    cases::condition::plan(&mut plan);
                }
                "stretched-cells" => cases::anisotropy::plan(&mut plan),
                "graded-meshes" => cases::grading::plan(&mut plan),
                "contrast" => cases::contrast::plan(&mut plan),
                "coercivity" => cases::coercivity::plan(&mut plan),
                "curved-obstacle" => cases::curved_obstacle::plan(&mut plan),
                "biactive" => cases::biactive::plan(&mut plan),
                "scaling" => cases::scaling::plan(&mut plan),
                "contact-ends" => cases::contact_ends::plan(&mut plan),
                "orders" => cases::orders::plan(&mut plan),
                _ => cases::slivers::plan(&mut plan),
            }
        }
        plan
    }
}
