//! Work against precision: schemes, linear solvers and levels under one clock.

mod case;
#[cfg(feature = "plot")]
mod figures;
mod measured;
mod report;
mod rounds;
mod slots;
mod tables;
mod verdict;
mod work_at_error;

pub use crate::real::Precision;
pub use crate::study::Variant;
pub use measured::{Case, Failure, Measured, Phases};
pub use report::WorkReport;
pub use work_at_error::{Standing, WorkAtError};

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use crate::constraint::ConstraintSet;
use crate::error::Error;
use crate::instances::compiled;
use crate::linear::LinearMethod;
use crate::nested::Adaptivity;
use crate::scenes::Scene;
use crate::scheme::{NamedScheme, Scheme};
use case::Candidate;

/// Progress of a study.
#[derive(Debug)]
#[non_exhaustive]
pub enum WorkProgress<'a> {
    /// The number of runs that follow, fewer if some exceed the time limit.
    Planned(usize),
    /// A run begins, in this round from 0.
    Started(&'a Case, usize),
    /// The run ended, or was not needed.
    Finished,
}

/// A study of work against precision on one scene.
///
/// In every round each case runs once and reuses nothing of other runs: its time includes its mesh
/// and its start from coarser levels. Rounds alternate in direction, so that drift of the machine
/// affects all cases equally. Before the first one every variant runs once unmeasured.
///
/// ```
/// use unilateral::prelude::*;
/// use unilateral::work_precision::WorkPrecision;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let report = WorkPrecision::<2>::new(scenes::radial(1.0))
///     .scheme(ConformingP1)
///     .scheme(Wopsip::default())
///     .levels([4, 8])
///     .rounds(2)
///     .run()?;
/// assert_eq!(report.rows.len(), 4);
/// print!("{}", report.to_text());
/// # Ok(())
/// # }
/// ```
pub struct WorkPrecision<'a, const D: usize> {
    scene: Scene<D>,
    candidates: Vec<Candidate<'a, D>>,
    linear: Vec<LinearMethod>,
    precision: Precision,
    levels: Vec<usize>,
    adaptive: Option<Adaptivity>,
    /// The scheme and the level of the solution against which errors are.
    reference: Option<(Candidate<'a, D>, usize)>,
    rounds: usize,
    limit: f64,
    subject: String,
    directory: Option<PathBuf>,
    observer: Box<dyn Fn(WorkProgress<'_>) + 'a>,
}

impl<const D: usize> fmt::Debug for WorkPrecision<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WorkPrecision")
            .field("scene", &self.scene.name)
            .field("linear", &self.linear)
            .field("precision", &self.precision)
            .field("levels", &self.levels)
            .field("adaptive", &self.adaptive)
            .field("rounds", &self.rounds)
            .field("limit", &self.limit)
            .field("subject", &self.subject)
            .field("directory", &self.directory)
            .finish_non_exhaustive()
    }
}

impl<'a, const D: usize> WorkPrecision<'a, D> {
    /// A study of a scene, without schemes or levels yet.
    #[must_use]
    pub fn new(scene: Scene<D>) -> Self {
        Self {
            scene,
            candidates: Vec::new(),
            linear: vec![LinearMethod::BySize],
            precision: Precision::Double,
            levels: Vec::new(),
            adaptive: None,
            reference: None,
            rounds: 3,
            limit: f64::INFINITY,
            subject: String::new(),
            directory: None,
            observer: Box::new(|_| {}),
        }
    }
    /// Takes errors against the solution of this scheme on a level, as
    /// [`Study::reference`](crate::study::Study::reference) does, for cases over `f64`. Every case is solved once
    /// more for its errors, outside the clock, also those above the limit of seconds.
    #[must_use]
    pub fn reference(mut self, scheme: impl Scheme<D> + 'a, level: usize) -> Self {
        self.reference = Some((Candidate::new(scheme), level));
        self
    }
    /// As [`Self::reference`], with a scheme as users write it.
    #[must_use]
    pub fn named_reference(mut self, scheme: &NamedScheme, level: usize) -> Self {
        self.reference = Some((Candidate::named(scheme), level));
        self
    }
    /// Adds a scheme.
    #[must_use]
    pub fn scheme(mut self, scheme: impl Scheme<D> + 'a) -> Self {
        self.candidates.push(Candidate::new(scheme));
        self
    }
    /// Adds a scheme with a constraint set of its own.
    #[must_use]
    pub fn scheme_on(
        mut self,
        scheme: impl Scheme<D> + 'a,
        set: impl ConstraintSet + 'static,
    ) -> Self {
        let set: Option<Arc<dyn ConstraintSet>> = Some(Arc::new(set));
        self.candidates.push(Candidate { set, ..Candidate::new(scheme) });
        self
    }
    /// Adds a scheme as users write it.
    #[must_use]
    pub fn named_scheme(mut self, scheme: &NamedScheme) -> Self {
        self.candidates.push(Candidate::named(scheme));
        self
    }
    /// Sets the linear solvers inside the active-set method; one chosen by size otherwise.
    #[must_use]
    pub fn linear(mut self, linear: impl IntoIterator<Item = LinearMethod>) -> Self {
        self.linear = linear.into_iter().collect();
        self
    }
    /// Sets the precision of solves; `f64` otherwise.
    #[must_use]
    pub fn precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }
    /// Sets the levels: subdivisions of the shortest side, or refinements of a domain that is a mesh.
    #[must_use]
    pub fn levels(mut self, levels: impl IntoIterator<Item = usize>) -> Self {
        self.levels = levels.into_iter().collect();
        self.levels.sort_unstable();
        self.levels.dedup();
        self
    }
    /// Runs every scheme also on meshes that follow its error bound, from the coarsest level on, as
    /// [`Study::adaptive`](crate::study::Study::adaptive) does. All steps are one run, and the time of a step is that
    /// of all steps so far with their bounds: what its error costs. Memory is not measured for them.
    #[must_use]
    pub fn adaptive(mut self, adaptivity: Adaptivity) -> Self {
        self.adaptive = Some(adaptivity);
        self
    }
    /// Sets how often each case runs, at least once; three times otherwise.
    #[must_use]
    pub fn rounds(mut self, rounds: usize) -> Self {
        self.rounds = rounds.max(1);
        self
    }
    /// A run that took longer than this many seconds is not repeated, and no finer level of its
    /// variant is tried: that is listed among the failures.
    #[must_use]
    pub fn limit(mut self, seconds: f64) -> Self {
        self.limit = seconds;
        self
    }
    /// Sets the label of the scheme that verdicts compare with the others; the fastest one by default.
    #[must_use]
    pub fn subject(mut self, label: &str) -> Self {
        self.subject = label.to_owned();
        self
    }
    /// Writes the report to this directory after every round, and within one every second.
    #[must_use]
    pub fn write_to(mut self, directory: impl Into<PathBuf>) -> Self {
        self.directory = Some(directory.into());
        self
    }
    /// Sets a function that receives the progress of the study.
    #[must_use]
    pub fn observer(mut self, observer: impl Fn(WorkProgress<'_>) + 'a) -> Self {
        self.observer = Box::new(observer);
        self
    }

    /// Checks everything without a run. Returns the cases, each of which runs once in every round unless
    /// some exceed the time limit.
    ///
    /// # Errors
    /// Those of [`Study::check`](crate::study::Study::check) of each case; [`Error::EqualNames`]; [`Error::Parameter`]
    /// for a reference that does not fit the levels; [`Error::NotEnoughMemory`], which [`Self::run`] has for the
    /// reference only: it lists the other cases that do not fit.
    pub fn check(&self) -> Result<Vec<Case>, Error> {
        compiled!(
            const D: fn(&WorkPrecision<'_, D>) -> Result<Vec<Case>, Error> = |study| {
                let slots = study.slots()?;
                study.study_against_reference()?;
                slots.iter().try_for_each(|slot| slot.study.check_memory())?;
                Ok(slots.into_iter().map(|slot| slot.case).collect())
            }
        )(self)
    }

    /// Runs everything.
    ///
    /// # Errors
    /// Those of [`Self::check`], before anything runs. An [`Error::Write`] ends the study. A case that
    /// fails is no error: the report lists it.
    pub fn run(&self) -> Result<WorkReport, Error> {
        let mut report = WorkReport::new("work-precision", self.rounds);
        self.run_into(&mut report)?;
        report.provenance.complete = true;
        if let Some(directory) = &self.directory {
            report.write_data(directory)?;
        }
        Ok(report)
    }

    /// Runs everything, adds it to a report of other scenes and draws its figures. That the report
    /// is complete is for the caller to say.
    ///
    /// # Errors
    /// Those of [`Self::run`].
    pub fn run_into(&self, report: &mut WorkReport) -> Result<(), Error> {
        compiled!(
            const D: fn(&WorkPrecision<'_, D>, &mut WorkReport) -> Result<(), Error>
                = |study, report| study.run_cases(report)
        )(self, report)
    }
}
