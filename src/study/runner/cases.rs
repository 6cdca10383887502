//! The cases of a study: what runs alone, and reuses nothing of other runs.

use super::{Progress, Study};
use crate::error::Error;
use crate::inequality::Outcome;
use crate::study::{Row, Variant};

impl<'a, const D: usize> Study<'a, D> {
    /// The cases, each as a study of its own: one scheme with one solver on one level, or on all adaptive meshes. They
    /// have no reference, no files and no observer.
    pub(crate) fn cases(&self) -> Vec<Self> {
        let mut cases = Vec::new();
        let levels: Vec<Vec<usize>> = match self.adaptive {
            Some(_) => vec![self.levels.clone()],
            None => self.levels.iter().map(|&level| vec![level]).collect(),
        };
        for entry in &self.entries {
            for solver in self.solvers() {
                cases.extend(levels.iter().map(|levels| Self {
                    entries: vec![entry.clone()],
                    levels: levels.clone(),
                    adaptive: self.adaptive,
                    fit: self.fit.clone(),
                    solvers: vec![solver.clone()],
                    quadrature: self.quadrature,
                    has_cold_start: self.has_cold_start,
                    tolerance: self.tolerance,
                    ..Self::new(self.scene.clone())
                }));
            }
        }
        cases
    }

    /// The row of a case that is not run since a coarser level took too long, for this reason.
    ///
    /// # Panics
    /// If the study has no scheme or no level.
    pub(crate) fn row_not_run(&self, why: String) -> Row {
        let (level, solver) = (self.first_level(), &self.solvers()[0]);
        let row = self.empty_row(&self.entries[0], (level, solver.name()), Outcome::TimeLimit);
        Row { cells: self.scene.domain.cells(level) as usize, message: Some(why), ..row }
    }

    /// The variant of the rows of a case, with its level; of adaptive meshes that is zero.
    pub(crate) fn variant(&self) -> (Variant, usize) {
        let row = self.row_not_run(String::new());
        (Variant::of(&row), if self.is_adaptive() { 0 } else { row.level })
    }

    /// Whether the study runs on adaptive meshes.
    pub(crate) fn is_adaptive(&self) -> bool {
        self.adaptive.is_some()
    }

    /// The rows of all schemes and levels against the reference of the study; none without one.
    pub(crate) fn rows_against_reference(&self) -> Result<Vec<Row>, Error> {
        self.reference.as_ref().map_or_else(|| Ok(Vec::new()), |_| Ok(self.run()?.rows))
    }

    /// Tells the observer.
    pub(crate) fn notify(&self, progress: Progress<'_>) {
        (self.observer)(progress);
    }
}
