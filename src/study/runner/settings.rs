//! The settings of a study.

#[cfg(feature = "report")]
use std::path::PathBuf;
use std::sync::Arc;

use super::{Entry, Progress, Study};
use crate::assemble::DataQuadrature;
use crate::constraint::ConstraintSet;
use crate::error::Error;
use crate::inequality::{InequalitySolver, StepCounter};
use crate::nested::Solved;
use crate::problem::Problem;
use crate::scheme::{NamedScheme, Scheme};
#[cfg(feature = "report")]
use crate::study::journal::Journal;
use crate::study::reference::Reference;

impl<'a, const D: usize> Study<'a, D> {
    /// Measures all rows against the solution of this scheme on a level, in place of the exact one: errors,
    /// orders, multiplier and contact set. On a domain the level is a power of two times every other level
    /// and at least four times the finest; on a mesh it is at least two refinements finer.
    ///
    /// ```
    /// use unilateral::prelude::*;
    /// # fn main() -> Result<(), Error> {
    /// let report = Study::<2>::new(scenes::radial(1.0))
    ///     .scheme(ConformingP1)
    ///     .levels([8, 16])
    ///     .reference(ConformingP2, 64)
    ///     .run()?;
    /// assert_eq!(report.rows[1].against.as_deref(), Some("p2 at level 64"));
    /// assert!(report.rows[1].order.h1 > Some(0.9));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn reference(mut self, scheme: impl Scheme<D> + 'a, level: usize) -> Self {
        let problem = self.scene.problem.clone();
        self.reference = Some(Reference { scheme: Arc::new(scheme), problem, level });
        self
    }
    /// As [`Study::reference`], with a scheme as users write it.
    #[must_use]
    pub fn named_reference(mut self, scheme: &NamedScheme, level: usize) -> Self {
        let problem = self.problem_on(scheme.constraint_set());
        self.reference = Some(Reference { scheme: scheme.make().into(), problem, level });
        self
    }
    /// Adds a scheme, with the constraint set of the problem.
    #[must_use]
    pub fn scheme(self, scheme: impl Scheme<D> + 'a) -> Self {
        self.entry(Arc::new(scheme), None)
    }
    /// Adds a scheme with a constraint set of its own, so that one scheme may stand beside itself with
    /// other bounds.
    #[must_use]
    pub fn scheme_on(self, scheme: impl Scheme<D> + 'a, set: impl ConstraintSet + 'static) -> Self {
        self.entry(Arc::new(scheme), Some(Arc::new(set)))
    }
    /// Adds a scheme chosen at run time, with the constraint set of the problem.
    #[must_use]
    pub fn boxed_scheme(self, scheme: Box<dyn Scheme<D> + 'a>) -> Self {
        self.entry(scheme.into(), None)
    }
    /// Adds a scheme chosen at run time, with a constraint set of its own.
    #[must_use]
    pub fn boxed_scheme_on(
        self,
        scheme: Box<dyn Scheme<D> + 'a>,
        set: impl ConstraintSet + 'static,
    ) -> Self {
        self.entry(scheme.into(), Some(Arc::new(set)))
    }
    /// Adds a scheme as users write it; without a placement it has the constraint set of the problem.
    #[must_use]
    pub fn named_scheme(self, scheme: &NamedScheme) -> Self {
        self.entry(scheme.make().into(), scheme.constraint_set())
    }
    /// Adds a scheme. `set`, if given, replaces the constraint set of the problem.
    fn entry(
        mut self,
        scheme: Arc<dyn Scheme<D> + 'a>,
        set: Option<Arc<dyn ConstraintSet>>,
    ) -> Self {
        let problem = self.problem_on(set);
        let label = scheme.label_on(problem.constraint_set());
        self.entries.push(Entry { scheme, problem, label });
        self
    }
    /// The problem of the scene, on another constraint set if one is given.
    fn problem_on(&self, set: Option<Arc<dyn ConstraintSet>>) -> Problem<D> {
        let mut problem = self.scene.problem.clone();
        problem.constraint_set = set.or(problem.constraint_set);
        problem
    }
    /// Sets the levels: subdivisions of the shortest side, or refinements of a domain that is a mesh.
    #[must_use]
    pub fn levels(mut self, levels: impl IntoIterator<Item = usize>) -> Self {
        self.levels = levels.into_iter().collect();
        self
    }
    /// Adds a solver of the inequality; without one, the active set method runs. Several solvers stand
    /// side by side: every scheme runs with each of them, also on coarser levels for its start.
    #[must_use]
    pub fn solver(self, solver: impl InequalitySolver<f64> + 'a) -> Self {
        self.boxed_solver(Box::new(solver))
    }
    /// Adds a solver of the inequality chosen at run time.
    #[must_use]
    pub fn boxed_solver(mut self, solver: Box<dyn InequalitySolver<f64> + 'a>) -> Self {
        self.solvers.push(solver.into());
        self
    }
    /// Sets whether schemes start without contact and without coarser levels.
    #[must_use]
    pub fn cold_start(mut self, has_cold_start: bool) -> Self {
        self.has_cold_start = has_cold_start;
        self
    }
    /// Makes solves end where the bound on their algebraic error is at most this share of the rest of the error bound, in
    /// place of the limit of the certificate: see [`NestedIteration::tolerance`](crate::nested::NestedIteration::tolerance). Rows
    /// say the share; a reference is solved to rounding.
    ///
    /// ```
    /// use unilateral::prelude::*;
    /// # fn main() -> Result<(), Error> {
    /// let study = Study::<2>::new(scenes::hill()).scheme(Sipg::default()).levels([16]);
    /// let row = &study.tolerance(0.1).run()?.rows[0];
    /// assert_eq!((row.status.name(), row.tolerance), ("converged", Some(0.1)));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn tolerance(mut self, share: f64) -> Self {
        self.tolerance = Some(share);
        self
    }
    /// Sets the quadrature of data.
    #[must_use]
    pub fn quadrature(mut self, quadrature: DataQuadrature) -> Self {
        self.quadrature = quadrature;
        self
    }
    /// Makes every time the smallest of this many runs.
    #[must_use]
    pub fn repeat(mut self, times: usize) -> Self {
        self.repeat = times.max(1);
        self
    }
    /// Sets whether rows have the key `history`, of one more solve on their own level, from the same start. Times of
    /// rows do not contain it, and its seconds contain neither start nor assembly.
    ///
    /// ```
    /// use unilateral::prelude::*;
    /// # fn main() -> Result<(), Error> {
    /// let study = Study::<2>::new(scenes::radial(1.0)).scheme(Sipg::default()).levels([8]);
    /// let report = study.history(true).run()?;
    /// let history = report.rows[0].history.as_ref().unwrap();
    /// let (systems, _seconds, certificate) = *history.last().unwrap();
    /// assert_eq!(Some(systems), report.rows[0].iterations.systems);
    /// assert!(certificate < Some(1e-9));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn history(mut self, keeps_history: bool) -> Self {
        self.keeps_history = keeps_history;
        self
    }
    /// Writes the fields of every scheme on the finest level to this directory, as `SCENE-LABEL.vtu`, of
    /// several solvers as `SCENE-LABEL-SOLVER.vtu`, with `-` for what is neither a letter, a digit, a dot, `_` nor `-`.
    #[cfg(feature = "report")]
    #[must_use]
    pub fn fields_to(mut self, directory: impl Into<PathBuf>) -> Self {
        self.fields.directory = Some(directory.into());
        self
    }
    /// Writes the fields of every level, and `SCENE-LABEL.pvd`, which lists the files.
    #[cfg(feature = "report")]
    #[must_use]
    pub fn fields_of_all_levels(mut self) -> Self {
        self.fields.all_levels = true;
        self
    }
    /// Sets a function that receives every solution that has values, with its label, of several solvers as
    /// `LABEL-SOLVER`, and its level, after the row of the solution is finished. An error ends the study.
    #[must_use]
    pub fn each_solution(
        mut self,
        f: impl Fn(&str, usize, &Solved<'_, D>) -> Result<(), Error> + 'a,
    ) -> Self {
        self.each_solution = Some(Box::new(f));
        self
    }
    /// Writes the inequality of every scheme on every level to this directory, each to its folder
    /// `SCENE-LABEL-LEVEL`, by [`write_inequality`](crate::exchange::write_inequality).
    #[cfg(feature = "report")]
    #[must_use]
    pub fn inequalities_to(mut self, directory: impl Into<PathBuf>) -> Self {
        self.inequalities = Some(directory.into());
        self
    }
    /// Adds each row to a journal as soon as it is finished, and takes those that the journal has from an
    /// earlier run.
    #[cfg(feature = "report")]
    #[must_use]
    pub fn journal(mut self, journal: &'a Journal) -> Self {
        self.journal = Some(journal);
        self
    }
    /// Sets what receives the number of each outer step of a solve.
    #[must_use]
    pub fn steps(mut self, steps: StepCounter) -> Self {
        self.steps = steps;
        self
    }
    /// Sets a function that receives the progress of the study.
    #[must_use]
    pub fn observer(mut self, observer: impl Fn(Progress<'_>) + 'a) -> Self {
        self.observer = Box::new(observer);
        self
    }
}
