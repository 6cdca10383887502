//! Work against precision: schemes, linear solvers, scalars and levels under one clock.

mod baseline;
mod case;
#[cfg(feature = "plot")]
mod figures;
mod measured;
mod report;
mod tables;
mod verdict;
mod work_at_error;

pub use baseline::{Changes, changes};
pub use case::Precision;
pub use measured::{Case, Failure, Measured, Phases, Variant};
pub use report::WorkReport;
pub use work_at_error::{Standing, WorkAtError, WorkPoint, work_at};

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::constraint::ConstraintSet;
use crate::error::Error;
use crate::inequality::ActiveSet;
use crate::instances::compiled;
use crate::linear::LinearMethod;
use crate::mesh::{BoxDomain, Mesh};
use crate::problem::Problem;
use crate::real::Real;
use crate::scenes::Scene;
use crate::scheme::{AnyScheme, NamedScheme};
use crate::study::{Row, Study, available_memory_bytes};
use case::{Candidate, OneStudy, in_single_precision, resident_memory_bytes};

/// The least time between two writes of finished rows within a round.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

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
/// let report = WorkPrecision::<2>::new(|| scenes::radial(1.0))
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
    scene: Box<dyn Fn() -> Scene<D> + 'a>,
    candidates: Vec<Candidate<'a, D>>,
    linear: Vec<LinearMethod>,
    precisions: Vec<Precision>,
    levels: Vec<usize>,
    mesh: Option<Mesh<f64, D>>,
    /// The scheme and the level of the solution against which errors are.
    reference: Option<(Candidate<'a, D>, usize)>,
    rounds: usize,
    limit: f64,
    subject: String,
    directory: Option<PathBuf>,
    memory: Option<MemoryOf<'a>>,
    empty_memory: Option<u64>,
    observer: Box<dyn Fn(WorkProgress<'_>) + 'a>,
}

/// Measures the peak of memory of a case.
type MemoryOf<'a> = Box<dyn Fn(&Case) -> Option<u64> + 'a>;

/// A case, its study, and its results so far.
struct Slot<'s, const D: usize> {
    case: Case,
    study: OneStudy<'s, D>,
    /// The case one level coarser, by its place in the list.
    coarser: Option<usize>,
    measured: Option<Measured>,
    failure: Option<Failure>,
}

impl<const D: usize> fmt::Debug for WorkPrecision<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WorkPrecision")
            .field("linear", &self.linear)
            .field("precisions", &self.precisions)
            .field("levels", &self.levels)
            .field("rounds", &self.rounds)
            .field("limit", &self.limit)
            .field("subject", &self.subject)
            .field("directory", &self.directory)
            .finish_non_exhaustive()
    }
}

impl<'a, const D: usize> WorkPrecision<'a, D> {
    /// A study of the scene this makes, without schemes or levels yet.
    #[must_use]
    pub fn new(scene: impl Fn() -> Scene<D> + 'a) -> Self {
        Self {
            scene: Box::new(scene),
            candidates: Vec::new(),
            linear: vec![LinearMethod::BySize],
            precisions: vec![Precision::Double],
            levels: Vec::new(),
            mesh: None,
            reference: None,
            rounds: 3,
            limit: f64::INFINITY,
            subject: String::new(),
            directory: None,
            memory: None,
            empty_memory: None,
            observer: Box::new(|_| {}),
        }
    }
    /// A study of a problem of one's own on a mesh and its refinements, as
    /// [`Study::of_problem`](crate::study::Study::of_problem) makes it. Without a reference it has no errors.
    ///
    /// # Errors
    /// [`Error::Mesh`] where two data claim one boundary group.
    pub fn of_problem(name: &str, problem: Problem<D>, mesh: Mesh<f64, D>) -> Result<Self, Error> {
        let mesh = problem.bind_boundary(mesh)?;
        // the domain of a scene is not used where there is a mesh
        let scene = Scene::new(name, BoxDomain::centred(1.0), problem);
        Ok(Self::new(move || scene.clone()).on_mesh(mesh))
    }
    /// Takes errors against the solution of this scheme on a level, as
    /// [`Study::reference`](crate::study::Study::reference) does, for cases over `f64`. Every case is solved once
    /// more for its errors, outside the clock, also those above the limit of seconds.
    #[must_use]
    pub fn reference(
        mut self,
        scheme: impl AnyScheme<f64, D> + AnyScheme<f32, D> + 'a,
        level: usize,
    ) -> Self {
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
    pub fn scheme(mut self, scheme: impl AnyScheme<f64, D> + AnyScheme<f32, D> + 'a) -> Self {
        self.candidates.push(Candidate::new(scheme));
        self
    }
    /// Adds a scheme with a constraint set of its own.
    #[must_use]
    pub fn scheme_on(
        mut self,
        scheme: impl AnyScheme<f64, D> + AnyScheme<f32, D> + 'a,
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
    /// Sets the scalars; `f64` otherwise.
    #[must_use]
    pub fn precisions(mut self, precisions: impl IntoIterator<Item = Precision>) -> Self {
        self.precisions = precisions.into_iter().collect();
        self
    }
    /// Sets the levels: subdivisions of the shortest side, or refinements of a given mesh.
    #[must_use]
    pub fn levels(mut self, levels: impl IntoIterator<Item = usize>) -> Self {
        self.levels = levels.into_iter().collect();
        self.levels.sort_unstable();
        self.levels.dedup();
        self
    }
    /// Runs on this mesh and refinements of it instead of the scene's own domain.
    #[must_use]
    pub fn on_mesh(mut self, mesh: Mesh<f64, D>) -> Self {
        self.mesh = Some(mesh);
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
    /// Sets a function that measures the peak of memory of a case; it is called once for each case.
    /// The default is the peak of this process during the run, with all its other memory.
    #[must_use]
    pub fn memory(mut self, memory: impl Fn(&Case) -> Option<u64> + 'a) -> Self {
        self.memory = Some(Box::new(memory));
        self
    }
    /// States the peak of memory of a run without a case, where [`Self::memory`] measures other processes.
    #[must_use]
    pub fn empty_memory(mut self, bytes: Option<u64>) -> Self {
        self.empty_memory = bytes;
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
    /// Those of [`Study::check`] of each case; [`Error::Parameter`] for two schemes of one label, and for a
    /// reference that does not fit the levels or the memory.
    pub fn check(&self) -> Result<Vec<Case>, Error> {
        compiled!(
            const D: fn(&WorkPrecision<'_, D>) -> Result<Vec<Case>, Error> = |study| {
                let cases = study.slots()?.into_iter().map(|slot| slot.case).collect();
                study.study_against_reference()?;
                Ok(cases)
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
    fn run_cases(&self, report: &mut WorkReport) -> Result<(), Error> {
        let mut slots = self.slots()?;
        report.subject.clone_from(&self.subject);
        let of_this_process = || resident_memory_bytes().filter(|_| self.memory.is_none());
        report.empty_memory_bytes = self.empty_memory.or_else(of_this_process);
        for precision in self.precisions.iter().map(|p| p.name()) {
            if !report.program.precision.split(", ").any(|p| p == precision) {
                let comma = if report.program.precision.is_empty() { "" } else { ", " };
                report.program.precision += &format!("{comma}{precision}");
            }
        }
        let measured = match self.study_against_reference()? {
            Some(study) => study.run()?.rows,
            None => Vec::new(),
        };
        let before = (report.rows.len(), report.refused.len());
        (self.observer)(WorkProgress::Planned(slots.len() * self.rounds));
        // threads, pages and instructions are there when the clock starts
        for slot in slots.iter().filter(|s| s.coarser.is_none()) {
            drop(slot.study.run());
        }
        let mut written = Instant::now();
        for round in 0..self.rounds {
            // by level, so that a level that takes too long is known before the next
            let mut order: Vec<usize> = (0..slots.len()).collect();
            order.sort_by_key(|&k| slots[k].case.level);
            if round % 2 == 1 {
                order.reverse();
            }
            for k in order {
                (self.observer)(WorkProgress::Started(&slots[k].case, round));
                self.run_slot(&mut slots, k, round, &measured);
                (self.observer)(WorkProgress::Finished);
                if written.elapsed() > WRITE_INTERVAL {
                    self.save(report, before, &slots)?;
                    written = Instant::now();
                }
            }
            self.save(report, before, &slots)?;
        }
        match (&self.directory, slots.first()) {
            (Some(directory), Some(slot)) => {
                report.write_figures(directory, &slot.case.variant.scene).map(|_| ())
            }
            _ => Ok(()),
        }
    }

    /// Runs a case, unless it has failed, takes too long or would not fit.
    fn run_slot(
        &self,
        slots: &mut [Slot<'_, D>],
        k: usize,
        round: usize,
        against_reference: &[Row],
    ) {
        if let Some(measured) = &slots[k].measured {
            let is_slow = measured.smallest.total > self.limit;
            if is_slow || !measured.row.converged() {
                return;
            }
        } else if round > 0 {
            return;
        }
        if round == 0
            && let Some(why) = self.obstacle_to(slots, k)
        {
            slots[k].failure = Some(Failure::new(slots[k].case.clone(), &why));
            return;
        }
        let slot = &mut slots[k];
        match slot.study.run() {
            Err(e) => {
                slot.failure = Some(Failure::new(slot.case.clone(), &e.to_string()));
            }
            Ok((mut row, phases)) => {
                if let Some(memory) = &self.memory {
                    let known = slot.measured.as_ref().map(|m| m.row.peak_memory_bytes);
                    row.peak_memory_bytes = known.unwrap_or_else(|| memory(&slot.case));
                }
                let is_same = |other: &&Row| {
                    slot.case.variant.precision == f64::NAME
                        && other.label == row.label
                        && other.level == row.level
                };
                if let Some(known) = against_reference.iter().find(is_same) {
                    row.against.clone_from(&known.against);
                    if known.against.is_none() {
                        row.warnings.clone_from(&known.warnings);
                    }
                    (row.error, row.contact) = (known.error, known.contact);
                }
                match &mut slot.measured {
                    Some(measured) => measured.add(&row, phases),
                    None => slot.measured = Some(Measured::new(row, phases, &slot.case)),
                }
            }
        }
    }

    /// The study that measures every scheme on every level against the reference, checked; none where no
    /// reference is asked for.
    fn study_against_reference(&self) -> Result<Option<Study<'_, f64, D>>, Error> {
        let Some((reference, level)) = &self.reference else { return Ok(None) };
        let mut study = Study::<f64, D>::new((self.scene)()).levels(self.levels.iter().copied());
        if let Some(mesh) = &self.mesh {
            study = study.on_mesh(mesh.clone());
        }
        for candidate in &self.candidates {
            study = study.shared_scheme(candidate.double.clone(), candidate.set.clone());
        }
        if self.precisions.contains(&Precision::Single) {
            let allowed =
                "a reference is computed over f64, and errors of f32 would be no like ones";
            return Err(wrong("precision", f32::NAME.to_owned(), allowed));
        }
        let (scheme, set) = (reference.double.clone(), reference.set.clone());
        let study = study.shared_reference(scheme, set, *level);
        if let (Some(need), Some(free)) = (study.memory_estimate(), available_memory_bytes())
            && need.bytes > free as f64
        {
            let (need, free) = (need.bytes / 1e9, free as f64 / 1e9);
            let allowed =
                format!("it would need about {need:.1} GB of memory, {free:.1} GB are available");
            return Err(wrong("level of the reference", level.to_string(), &allowed));
        }
        study.check()?;
        Ok(Some(study))
    }

    /// The reason for which a case is not run.
    fn obstacle_to(&self, slots: &[Slot<'_, D>], k: usize) -> Option<String> {
        if let Some(coarser) = slots[k].coarser.map(|c| &slots[c]) {
            let level = coarser.case.level;
            let Some(measured) = &coarser.measured else {
                return Some(format!("not run: level {level} was not, either"));
            };
            let seconds = measured.smallest.total;
            if seconds > self.limit {
                return Some(format!("not run: level {level} took {seconds:.1} s"));
            }
        }
        let (need, free) = (slots[k].study.memory_estimate()?, available_memory_bytes()?);
        (need.bytes > free as f64).then(|| {
            let (need, free) = (need.bytes / 1e9, free as f64 / 1e9);
            format!("not run: would need about {need:.1} GB of memory, {free:.1} GB are available")
        })
    }

    /// Puts the results so far into the report, after the rows of other scenes, and writes it.
    fn save(
        &self,
        report: &mut WorkReport,
        (rows, refused): (usize, usize),
        slots: &[Slot<'_, D>],
    ) -> Result<(), Error> {
        report.rows.truncate(rows);
        report.rows.extend(slots.iter().filter_map(|s| s.measured.clone()));
        report.refused.truncate(refused);
        report.refused.extend(slots.iter().filter_map(|s| s.failure.clone()));
        fill_orders(&mut report.rows[rows..]);
        match &self.directory {
            Some(directory) => report.write_data(directory).map(|_| ()),
            None => Ok(()),
        }
    }

    /// All cases, variant by variant, each checked.
    fn slots(&self) -> Result<Vec<Slot<'_, D>>, Error> {
        let mut slots: Vec<Slot<'_, D>> = Vec::new();
        for candidate in &self.candidates {
            for &linear in &self.linear {
                for &precision in &self.precisions {
                    let mut coarser = None;
                    for &level in &self.levels {
                        let slot = self.slot(candidate, linear, precision, level)?;
                        slot.study.check()?;
                        if slots.iter().any(|s| s.case == slot.case) {
                            let variant = &slot.case.variant;
                            let name = format!("{} on {}", variant.label, variant.constraint);
                            return Err(wrong("schemes", name, "each must have its own label"));
                        }
                        slots.push(Slot { coarser, ..slot });
                        coarser = Some(slots.len() - 1);
                    }
                }
            }
        }
        if slots.is_empty() {
            let needs = "a study needs a scheme, a linear solver, a scalar and a level";
            return Err(wrong("cases", "none".to_owned(), needs));
        }
        Ok(slots)
    }

    fn slot<'s>(
        &'s self,
        candidate: &Candidate<'s, D>,
        linear: LinearMethod,
        precision: Precision,
        level: usize,
    ) -> Result<Slot<'s, D>, Error> {
        let set = candidate.set.clone();
        let (case, study) = match precision {
            Precision::Double => {
                let (case, mut study) =
                    self.one_study(candidate.double.clone(), set, linear, level);
                if let Some(mesh) = &self.mesh {
                    study = study.on_mesh(mesh.clone());
                }
                (case, OneStudy::Double(study))
            }
            Precision::Single => {
                let (case, mut study) =
                    self.one_study(candidate.single.clone(), set, linear, level);
                if let Some(mesh) = &self.mesh {
                    study = study.on_mesh(in_single_precision(mesh)?);
                }
                (case, OneStudy::Single(study))
            }
        };
        Ok(Slot { case, study, coarser: None, measured: None, failure: None })
    }

    fn one_study<'s, T: Real>(
        &'s self,
        scheme: Arc<dyn AnyScheme<T, D> + 's>,
        set: Option<Arc<dyn ConstraintSet>>,
        linear: LinearMethod,
        level: usize,
    ) -> (Case, Study<'s, T, D>) {
        let scene = (self.scene)();
        let name = LinearMethod::NAMES.iter().find(|l| l.1 == linear).map_or("", |l| l.0);
        let in_force = set.as_deref().unwrap_or(scene.problem.constraint_set());
        let constraint = scheme.constraint_on(in_force);
        let variant = Variant {
            scene: scene.name.clone(),
            scheme: scheme.name().to_owned(),
            constraint: constraint.unwrap_or_else(|| in_force.name().to_owned()),
            label: scheme.label_on(in_force),
            linear_asked: name.to_owned(),
            precision: T::NAME.to_owned(),
        };
        let study = Study::<T, D>::new(scene)
            .solver(ActiveSet::default().linear(linear))
            .shared_scheme(scheme, set)
            .levels([level]);
        (Case { variant, level }, study)
    }
}

/// The error of an invalid request.
fn wrong(parameter: &'static str, value: String, allowed: &str) -> Error {
    Error::Parameter { parameter, value, allowed: allowed.to_owned() }
}

/// Observed orders, variant by variant.
fn fill_orders(rows: &mut [Measured]) {
    for variant in crate::study::row::distinct(rows.iter().map(Measured::variant)) {
        let mut own: Vec<&mut Measured> =
            rows.iter_mut().filter(|m| m.variant() == variant).collect();
        let mut plain: Vec<_> = own.iter().map(|m| m.row.clone()).collect();
        crate::study::fill_orders(&mut plain);
        for (measured, row) in own.iter_mut().zip(plain) {
            measured.row.order = row.order;
        }
    }
}
