//! A study on meshes that follow the error bound: the rows of the steps of each scheme.

use super::{Progress, Study};
use crate::error::Error;
use crate::mesh::{Domain, Mesh};
use crate::nested::{AdaptiveIteration, AdaptiveMeshes, AdaptiveStep, Adaptivity};
use crate::nested::{Hierarchy, NestedIteration, Phase, check_level};
use crate::scheme::ExpectedOrders;
use crate::study::memory::memory_of_process;
use crate::study::report::Report;
use crate::study::row::{Row, Seconds};

/// Subdivisions of the shortest side of a domain in the first mesh where no level is set.
const FIRST_LEVEL: usize = 4;

impl<const D: usize> Study<'_, D> {
    /// Runs every scheme on meshes that follow its error bound, in place of levels. The level of a row is the
    /// number of refinements. [`Study::levels`] may set the level of the first mesh; else that is the mesh
    /// given, or four subdivisions of the shortest side.
    ///
    /// Times are those of all steps so far, bounds included: what the error of the row costs.
    ///
    /// ```
    /// use unilateral::prelude::*;
    /// # fn main() -> Result<(), unilateral::error::Error> {
    /// let report = Study::<2>::new(scenes::lshape_2d())
    ///     .scheme(ConformingP1)
    ///     .adaptive(Adaptivity::default().steps(3))
    ///     .run()?;
    /// assert_eq!(report.rows.len(), 4);
    /// assert!(report.rows[3].bound.total < report.rows[0].bound.total);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn adaptive(mut self, adaptivity: Adaptivity) -> Self {
        self.adaptive = Some(adaptivity);
        self
    }

    /// The level of the first mesh of adaptive refinement.
    pub(super) fn first_level(&self) -> usize {
        let default = if self.scene.domain.is_mesh() { 0 } else { FIRST_LEVEL };
        self.levels.first().copied().unwrap_or(default)
    }
    fn first_mesh(&self) -> Result<Mesh<D>, Error> {
        let hierarchy = Hierarchy::of_domain(&self.scene.domain, self.first_level())?;
        Ok(hierarchy.finest().clone())
    }

    /// Checks what adaptive refinement asks of a study besides.
    pub(super) fn check_adaptive(&self, adaptivity: &Adaptivity) -> Result<(), Error> {
        let refuse = |parameter, value: String, allowed: &str| {
            Err(Error::parameter(parameter, value, allowed))
        };
        adaptivity.check()?;
        if let [_, _, ..] = self.levels[..] {
            let value = self.levels.len().to_string();
            let allowed = "adaptive refinement has one first mesh, of one level at most";
            return refuse("number of levels", value, allowed);
        }
        if let Some(reference) = &self.reference {
            let allowed = "none: a reference needs uniform refinements of all meshes";
            return refuse("level of the reference", reference.level.to_string(), allowed);
        }
        if matches!(self.scene.domain, Domain::Disc { .. }) {
            let allowed = "one with a polygon as its boundary: bisection does not follow a circle";
            return refuse("domain of an adaptive study", "a disc".to_owned(), allowed);
        }
        check_level(&self.scene.domain, self.first_level(), 1)?;
        for entry in &self.entries {
            self.check_level(&*entry.scheme, self.first_level(), memory_of_process())?;
        }
        let mesh = self.first_mesh()?;
        for entry in &self.entries {
            let of_entry = NestedIteration::new(&entry.problem, &mesh).check_bound(&*entry.scheme);
            // data that are bad on a mesh are for the rows
            if let Err(error @ Error::NotAdaptive(_)) = of_entry {
                return Err(error);
            }
        }
        Ok(())
    }

    /// The report of all schemes and solvers.
    pub(super) fn run_adaptive(&self, adaptivity: Adaptivity) -> Result<Report, Error> {
        (self.observer)(Progress::Entered(Phase::Mesh));
        let mut rows = Vec::new();
        #[cfg(feature = "report")]
        let mut unwritten = None;
        let first = self.first_mesh()?;
        for entry in &self.entries {
            for solver in self.solvers() {
                let meshes = AdaptiveMeshes::new(first.clone());
                let nested = NestedIteration::new(&entry.problem, &meshes);
                let nested = self.with_settings(nested, &solver);
                let mut steps = AdaptiveIteration::new(nested, &*entry.scheme, adaptivity)?;
                for level in 0.. {
                    (self.observer)(Progress::Started(&self.scene.name, &entry.label, level));
                    let cells = meshes.finest().n_cells();
                    let place = (format!("step {level} with {cells} cells"), cells as f64);
                    let fits = self.check_fits(&*entry.scheme, place, memory_of_process());
                    if let Err(error) = fits {
                        let place = (level, solver.name(), cells as f64);
                        let row = self.row_without_memory(entry, place, error)?;
                        self.finish(row, &mut rows)?;
                        break;
                    }
                    let step = match steps.next() {
                        Some(Ok(step)) => step,
                        Some(Err(error)) => {
                            let place = (level, solver.name(), meshes.finest());
                            let row = self.row_without(entry, place, error)?;
                            self.finish(row, &mut rows)?;
                            break;
                        }
                        None => break,
                    };
                    let row = self.row_of(entry, (level, solver.name()), &step.solved, None)?;
                    let row = adaptive_row(row, &step);
                    #[cfg(feature = "report")]
                    {
                        // files are named after the last step: whether there is another one is known
                        let last = level + usize::from(step.stop.is_none());
                        let levels: Vec<usize> = (0..=last).collect();
                        self.write_files(&row, &levels, &step.solved, None, &mut unwritten);
                    }
                    let row = self.finish(row, &mut rows)?;
                    self.hand_over(row, &step.solved)?;
                    if step.stop.is_some() {
                        break;
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
}

/// The row of a step: the times of all steps so far, and no order that theory promises for uniform meshes.
fn adaptive_row<const D: usize>(row: Row, step: &AdaptiveStep<'_, D>) -> Row {
    let seconds = Seconds {
        assemble: step.assemble_seconds,
        solve: step.solve_seconds,
        start: None,
        bound: Some(step.bound_seconds),
        total: step.seconds(),
        ..row.seconds
    };
    Row { seconds, expected_order: ExpectedOrders::default(), ..row }
}
