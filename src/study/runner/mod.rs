//! A study: schemes on a scene, level by level.

mod adaptive;
#[cfg(feature = "report")]
mod cases;
mod files;
mod judge;
mod memory;
mod on_parts;
mod reference;
mod rows;
mod settings;

use std::cell::OnceCell;
use std::fmt;
#[cfg(feature = "report")]
use std::path::PathBuf;
use std::sync::Arc;

use crate::assemble::DataQuadrature;
use crate::error::Error;
use crate::inequality::{ActiveSet, InequalitySolver, StepCounter};
use crate::instances::compiled;
use crate::nested::{Adaptivity, Hierarchy, NestedIteration, Phase, Solved, check_level};
use crate::problem::Problem;
use crate::real::Precision;
use crate::scenes::Scene;
use crate::scheme::Scheme;
use crate::study::compatibility::{check_fit, check_names, check_scheme};
#[cfg(feature = "report")]
use crate::study::fields::FieldFiles;
#[cfg(feature = "report")]
use crate::study::journal::Journal;
use crate::study::memory::memory_of_process;
use crate::study::orders::fill_orders;
use crate::study::program::Program;
use crate::study::reference::Reference;
use crate::study::report::Report;
use crate::study::row::{Row, RowKey};

/// Progress of a study.
#[derive(Debug)]
#[non_exhaustive]
pub enum Progress<'a> {
    /// A run begins: scene, label of the scheme, level.
    Started(&'a str, &'a str, usize),
    /// The run, or the study before its first run, enters a phase.
    Entered(Phase),
    /// A run ended.
    Finished(&'a Row),
    /// The journal has the row of an earlier run.
    Kept(&'a Row),
}

/// Schemes side by side on one scene.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let report = Study::<2>::new(scenes::radial(1.0))
///     .scheme(ConformingP1)
///     .scheme(Wopsip::default())
///     .levels([4, 8])
///     .run()?;
/// assert_eq!(report.rows.len(), 4);
/// # Ok(())
/// # }
/// ```
pub struct Study<'a, const D: usize> {
    scene: Scene<D>,
    entries: Vec<Entry<'a, D>>,
    levels: Vec<usize>,
    adaptive: Option<Adaptivity>,
    /// The result of [`check_fit`], once known.
    fit: OnceCell<Option<String>>,
    /// Why a stated solution does not solve the problem, or none, as the first row found it.
    not_exact: OnceCell<Option<String>>,
    reference: Option<Reference<'a, D>>,
    solvers: Vec<Arc<dyn InequalitySolver<f64> + 'a>>,
    quadrature: DataQuadrature,
    repeat: usize,
    keeps_history: bool,
    has_cold_start: bool,
    tolerance: Option<f64>,
    #[cfg(feature = "report")]
    journal: Option<&'a Journal>,
    #[cfg(feature = "report")]
    fields: FieldFiles,
    #[cfg(feature = "report")]
    inequalities: Option<PathBuf>,
    each_solution: Option<EachSolution<'a, D>>,
    steps: StepCounter,
    observer: Box<dyn Fn(Progress<'_>) + 'a>,
}

/// A function that receives a solution with its label (of several solvers `LABEL-SOLVER`) and its level.
type EachSolution<'a, const D: usize> =
    Box<dyn Fn(&str, usize, &Solved<'_, D>) -> Result<(), Error> + 'a>;

/// A scheme with its problem: that of the scene, perhaps with another constraint set.
#[derive(Clone)]
struct Entry<'a, const D: usize> {
    scheme: Arc<dyn Scheme<D> + 'a>,
    problem: Problem<D>,
    /// The label of its rows.
    label: String,
}

impl<const D: usize> fmt::Debug for Study<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let schemes: Vec<&str> = self.entries.iter().map(|e| e.scheme.name()).collect();
        f.debug_struct("Study")
            .field("scene", &self.scene.name)
            .field("schemes", &schemes)
            .field("levels", &self.levels)
            .field("solvers", &self.solvers().iter().map(|s| s.name()).collect::<Vec<_>>())
            .field("repeat", &self.repeat)
            .finish_non_exhaustive()
    }
}

impl<'a, const D: usize> Study<'a, D> {
    /// A study of a scene, without schemes or levels yet.
    #[must_use]
    pub fn new(scene: Scene<D>) -> Self {
        Self {
            scene,
            entries: Vec::new(),
            levels: Vec::new(),
            adaptive: None,
            fit: OnceCell::new(),
            not_exact: OnceCell::new(),
            reference: None,
            solvers: Vec::new(),
            quadrature: DataQuadrature::default(),
            repeat: 1,
            keeps_history: false,
            has_cold_start: false,
            tolerance: None,
            #[cfg(feature = "report")]
            journal: None,
            #[cfg(feature = "report")]
            fields: FieldFiles::default(),
            #[cfg(feature = "report")]
            inequalities: None,
            each_solution: None,
            steps: StepCounter::default(),
            observer: Box::new(|_| {}),
        }
    }

    /// Checks schemes, levels and domain, without assembly on a built-in one.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an empty list of levels or schemes or a level of zero, [`Error::EqualNames`],
    /// [`Error::NothingToBound`], [`Error::UnsupportedForm`], [`Error::UnfitMesh`], [`Error::Mesh`].
    pub fn check(&self) -> Result<(), Error> {
        compiled!(const D: fn(&Study<'_, D>) -> Result<(), Error>
                = |study| study.check_for(1)
        )(self)
    }

    /// Checks schemes, levels and domain, for so many parts of the meshes.
    fn check_for(&self, parts: usize) -> Result<(), Error> {
        let levels = self.levels.len() + usize::from(self.adaptive.is_some());
        let lengths = [("schemes", self.entries.len()), ("levels", levels)];
        if let Some(&(parameter, _)) = lengths.iter().find(|(_, length)| *length == 0) {
            let allowed = format!("a study needs {parameter}: at least one");
            return Err(Error::parameter(parameter, "none", allowed));
        }
        let labels = self.entries.iter().map(|entry| &entry.label[..]);
        check_names(labels, self.solvers().iter().map(|solver| solver.name()))?;
        if self.solvers().iter().any(|solver| solver.precision() != self.precision()) {
            let allowed = "one precision for all solvers of a study";
            return Err(Error::parameter("precision", "f64 and f32", allowed));
        }
        if let Some(share) = self.tolerance.filter(|share| !(*share > 0.0 && share.is_finite())) {
            let allowed = "a share of the error bound is positive and finite";
            return Err(Error::parameter("tolerance", share.to_string(), allowed));
        }
        let domain = &self.scene.domain;
        self.levels.iter().try_for_each(|&level| check_level(domain, level, parts))?;
        for entry in &self.entries {
            check_scheme(&*entry.scheme, entry.problem.clone(), self.quadrature)?;
        }
        if let Some(adaptivity) = &self.adaptive {
            self.check_adaptive(adaptivity)?;
        } else if let Some(reference) = &self.reference {
            reference.check(domain, &self.levels)?;
            check_level(domain, reference.level, 1)?;
            self.check_level(&*reference.scheme, reference.level, memory_of_process())?;
        }
        // the scene does not change: a second check finds the same
        let _ = self.fit.set(check_fit(&self.scene)?);
        Ok(())
    }

    /// The point at which the exact solution of the scene breaks the contact condition of a mesh, once that is checked.
    fn where_exact_fails(&self) -> Option<&str> {
        self.fit.get()?.as_deref()
    }

    /// Runs every scheme with every solver on every level.
    ///
    /// # Errors
    /// Errors of [`Self::check`], and [`Error::Write`] for the journal, and after the last row for fields and
    /// inequalities. A run that fails is no
    /// error: its row has the outcome and the message, also where data are not finite on a mesh, or leave
    /// no room for a solution.
    pub fn run(&self) -> Result<Report, Error> {
        compiled!(const D: fn(&Study<'_, D>) -> Result<Report, Error>
                = |study| study.run_all()
        )(self)
    }
    fn run_all(&self) -> Result<Report, Error> {
        self.check_for(1)?;
        if let Some(adaptivity) = self.adaptive {
            return self.run_adaptive(adaptivity);
        }
        let kept: Vec<Option<Row>> = self.keys().iter().map(|key| self.kept(key)).collect();
        (self.observer)(Progress::Entered(Phase::Mesh));
        let available = memory_of_process();
        let hierarchies = match kept.iter().all(Option::is_some) {
            true => Vec::new(),
            false => self.hierarchies(available)?,
        };
        let reference = self.find_reference(&hierarchies);
        let reference = reference.as_ref();
        let mut by_solver: Vec<Vec<NestedIteration<'_, D>>> = self
            .solvers()
            .iter()
            .map(|solver| {
                let nested = |h| NestedIteration::new(&self.scene.problem, h);
                hierarchies.iter().map(|h| self.with_settings(nested(h), solver)).collect()
            })
            .collect();
        let mut kept = kept.into_iter();
        let mut rows = Vec::new();
        #[cfg(feature = "report")]
        let mut unwritten = None;
        for entry in &self.entries {
            for (nested, solver) in by_solver.iter_mut().zip(self.solvers()) {
                for &level in &self.levels {
                    if let Some(row) = kept.next().expect("one entry for each row") {
                        (self.observer)(Progress::Kept(&row));
                        rows.push(row);
                        continue;
                    }
                    (self.observer)(Progress::Started(&self.scene.name, &entry.label, level));
                    let place = (level, solver.name());
                    let (row, solved) = self.row(nested, entry, place, reference, available)?;
                    #[cfg(feature = "report")]
                    if let Some(solved) = &solved {
                        self.write_files(&row, &self.levels, solved, reference, &mut unwritten);
                    }
                    let row = self.finish(row, &mut rows)?;
                    if let Some(solved) = &solved {
                        self.hand_over(row, solved)?;
                    }
                }
            }
        }
        #[cfg(feature = "report")]
        if let Some(error) = unwritten {
            return Err(error);
        }
        Ok(self.report(rows))
    }

    /// The report of all rows.
    fn report(&self, mut rows: Vec<Row>) -> Report {
        fill_orders(&mut rows);
        let program = || {
            Program::new(
                "study",
                self.precision().name(),
                rayon::current_num_threads(),
                self.repeat,
            )
        };
        #[cfg(feature = "report")]
        let program = || self.journal.map_or_else(program, |journal| journal.program().clone());
        Report::new(program(), rows)
    }

    /// The keys of all rows, in the order in which they run; none of adaptive refinement, whose number of steps is not
    /// known before.
    pub fn keys(&self) -> Vec<RowKey> {
        let mut keys = Vec::new();
        for entry in &self.entries {
            for solver in self.solvers() {
                let levels = self.levels.iter().filter(|_| self.adaptive.is_none());
                keys.extend(levels.map(|&level| RowKey {
                    scene: self.scene.name.clone(),
                    label: entry.label.clone(),
                    solver: solver.name().to_owned(),
                    level,
                }));
            }
        }
        keys
    }

    /// The row that the journal has from an earlier run.
    #[cfg(feature = "report")]
    fn kept(&self, key: &RowKey) -> Option<Row> {
        self.journal.and_then(|journal| journal.take(key))
    }
    #[cfg(not(feature = "report"))]
    fn kept(&self, _: &RowKey) -> Option<Row> {
        None
    }

    /// The meshes of all levels on which some scheme fits into the available bytes; the meshes of a reference are in
    /// the same hierarchy as these levels.
    fn hierarchies(&self, available: Option<u64>) -> Result<Vec<Hierarchy<D>>, Error> {
        match &self.reference {
            None => {
                let mut levels = self.levels.clone();
                levels.retain(|&level| {
                    let fits = |of: &Entry<'_, D>| self.check_level(&*of.scheme, level, available);
                    self.entries.iter().any(|entry| fits(entry).is_ok())
                });
                Hierarchy::all_by(&levels, |level| Hierarchy::of_domain(&self.scene.domain, level))
            }
            Some(reference) => {
                let coarsest = self.levels.iter().copied().min().unwrap_or(1);
                let domain = &self.scene.domain;
                Ok(vec![Hierarchy::of_domain_from(domain, reference.level, coarsest)?])
            }
        }
    }

    /// The solvers; the active set method if there is none.
    fn solvers(&self) -> Vec<Arc<dyn InequalitySolver<f64> + 'a>> {
        match &self.solvers[..] {
            [] => vec![Arc::new(ActiveSet::default())],
            some => some.to_vec(),
        }
    }

    /// The precision of all solvers.
    pub(crate) fn precision(&self) -> Precision {
        self.solvers()[0].precision()
    }

    /// A problem on nested meshes with a solver and the settings of the study.
    fn with_settings<'s>(
        &'s self,
        nested: NestedIteration<'s, D>,
        solver: &Arc<dyn InequalitySolver<f64> + 's>,
    ) -> NestedIteration<'s, D> {
        let nested = match self.tolerance {
            Some(share) => nested.tolerance(share),
            None => nested,
        };
        nested
            .shared_solver(solver.clone())
            .quadrature(self.quadrature)
            .repeat(self.repeat)
            .history(self.keeps_history)
            .cold_start(self.has_cold_start)
            .steps(self.steps.clone())
            .observer(|phase| (self.observer)(Progress::Entered(phase)))
    }
}
