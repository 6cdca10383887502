//! The memory that the runs of a study will need.

use super::{Entry, Study};
use crate::error::Error;
use crate::inequality::Outcome;
use crate::instances::compiled;
use crate::scheme::Scheme;
use crate::study::memory::{
    estimate, estimate_without_factors, memory_of_process, peak_memory_bytes, unknowns_about,
};
use crate::study::row::Row;

impl<const D: usize> Study<'_, D> {
    /// Bytes, scheme and level of the largest run, with factors if the solver computes them from the start; none for a
    /// study without schemes or levels. The largest run of adaptive refinement has as many unknowns as are allowed, and
    /// at least those of its first mesh.
    fn largest_run(&self) -> Option<(f64, &str, usize)> {
        let level = match &self.adaptive {
            Some(_) => self.first_level(),
            None => self.levels.iter().copied().max()?,
        };
        let bytes = |scheme: &dyn Scheme<D>, level: usize| {
            let most = self
                .adaptive
                .map_or(0.0, |of| of.unknowns as f64 / unknowns_about(D, scheme.layout(), 1.0));
            self.memory_of(scheme, self.scene.domain.cells(level).max(most))
        };
        let runs = self.entries.iter().map(|entry| (&*entry.scheme, level));
        let runs = runs.chain(self.reference.iter().map(|of| (&*of.scheme, of.level)));
        let runs = runs.map(|(scheme, level)| (bytes(scheme, level), scheme.name(), level));
        runs.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Bytes that the process needs for a scheme on so many cells.
    fn memory_of(&self, scheme: &dyn Scheme<D>, cells: f64) -> f64 {
        let layout = scheme.layout();
        let unknowns = unknowns_about(D, layout, cells) as usize;
        let solvers = self.solvers();
        match D > 1 && solvers.iter().all(|s| s.uses_coarse_spaces(unknowns)) {
            true => estimate_without_factors(D, layout, cells, self.precision()),
            false => {
                let obstacle = self.scene.problem.has_obstacle();
                estimate(D, layout, cells, obstacle)
            }
        }
    }

    /// An estimate of the bytes that the process needs for the largest run, which [`Self::check_memory`] compares with
    /// the memory there is; none for a study without schemes or levels. On obstacle and Signorini scenes the estimate is
    /// right to a third. No mesh is built.
    pub fn memory_bytes(&self) -> Option<f64> {
        compiled!(const D: fn(&Study<'_, D>) -> Option<f64>
                = |study| study.largest_run().map(|(bytes, ..)| bytes)
        )(self)
    }

    /// Checks before any mesh is built that the largest run fits into the memory that the machine, the limits of the
    /// process and its control group leave. A study that runs all the same has rows `out-of-memory` for runs that do
    /// not fit.
    ///
    /// # Errors
    /// [`Error::NotEnoughMemory`].
    pub fn check_memory(&self) -> Result<(), Error> {
        compiled!(const D: fn(&Study<'_, D>) -> Result<(), Error>
                = |study| study.check_largest_run()
        )(self)
    }
    fn check_largest_run(&self) -> Result<(), Error> {
        let Some((bytes, scheme, level)) = self.largest_run() else { return Ok(()) };
        let what = match &self.adaptive {
            Some(of) => format!("{} unknowns", of.unknowns),
            None => format!("level {level}"),
        };
        self.check_bytes(bytes, memory_of_process(), || format!("scheme {scheme}, {what}"))
    }

    /// Checks that a scheme on a level fits into so many bytes.
    pub(super) fn check_level(
        &self,
        scheme: &dyn Scheme<D>,
        level: usize,
        available: Option<u64>,
    ) -> Result<(), Error> {
        let run = || format!("scheme {}, level {level}", scheme.name());
        let bytes = self.memory_of(scheme, self.scene.domain.cells(level));
        self.check_bytes(bytes, available, run)
    }
    /// Checks that a scheme on the next mesh of adaptive refinement fits into the memory.
    pub(super) fn check_step(
        &self,
        scheme: &dyn Scheme<D>,
        (step, cells): (usize, usize),
    ) -> Result<(), Error> {
        let run = || format!("scheme {}, step {step} with {cells} cells", scheme.name());
        self.check_bytes(self.memory_of(scheme, cells as f64), memory_of_process(), run)
    }
    /// Refuses a run that needs more bytes than there are, where the system tells.
    fn check_bytes(
        &self,
        needed: f64,
        available: Option<u64>,
        run: impl Fn() -> String,
    ) -> Result<(), Error> {
        let remedy = if self.adaptive.is_some() { "fewer unknowns" } else { "a lower level" };
        match available.map(|bytes| bytes as f64) {
            Some(available) if needed > available => Err(Error::NotEnoughMemory(format!(
                "{}: would need about {:.1} GB of memory, {:.1} GB are available; choose {remedy}",
                run(),
                needed / 1e9,
                available / 1e9
            ))),
            _ => Ok(()),
        }
    }

    /// The row of a run that does not fit into the memory, on so many cells.
    pub(super) fn row_without_memory(
        &self,
        entry: &Entry<'_, D>,
        (level, cells): (usize, f64),
        solver: &str,
        error: Error,
    ) -> Result<Row, Error> {
        let row = Row {
            cells: cells as usize,
            solver: solver.to_owned(),
            peak_memory_bytes: peak_memory_bytes(),
            ..Row::new(&self.scene.name, D, entry.scheme.name(), level, Outcome::OutOfMemory)
        };
        self.named(entry, row, None).with_error(error)
    }
}
