//! Runs that do not fit into the memory.

use super::{Entry, Study};
use crate::error::Error;
use crate::inequality::Outcome;
use crate::scheme::Scheme;
use crate::study::memory::{bytes_about, unknowns_about};
use crate::study::row::Row;

impl<const D: usize> Study<'_, D> {
    /// Bytes that the process needs for a run on so many cells, about.
    fn bytes_of(&self, scheme: &dyn Scheme<D>, cells: f64) -> f64 {
        let layout = scheme.layout();
        let unknowns = unknowns_about(D, layout, cells) as usize;
        let has_factors = !self.solvers().iter().all(|of| of.uses_coarse_spaces(unknowns));
        bytes_about(D, layout, cells, has_factors)
    }

    /// Checks that a scheme on a level fits into so many bytes.
    pub(super) fn check_level(
        &self,
        scheme: &dyn Scheme<D>,
        level: usize,
        available: Option<u64>,
    ) -> Result<(), Error> {
        let cells = self.scene.domain.cells(level);
        self.check_fits(scheme, (format!("level {level}"), cells), available)
    }

    /// Refuses a scheme on so many cells that needs more bytes than there are, where the system tells.
    ///
    /// # Errors
    /// [`Error::NotEnoughMemory`].
    pub(super) fn check_fits(
        &self,
        scheme: &dyn Scheme<D>,
        (place, cells): (String, f64),
        available: Option<u64>,
    ) -> Result<(), Error> {
        let needed = self.bytes_of(scheme, cells);
        match available.map(|bytes| bytes as f64) {
            Some(available) if needed > available => Err(Error::NotEnoughMemory(format!(
                "scheme {}, {place}: would need about {:.1} GB of memory, {:.1} GB are available; choose {}",
                scheme.name(),
                needed / 1e9,
                available / 1e9,
                if self.adaptive.is_some() { "fewer unknowns" } else { "a lower level" }
            ))),
            _ => Ok(()),
        }
    }

    /// The row of a run that does not fit into the memory, on so many cells.
    pub(super) fn row_without_memory(
        &self,
        entry: &Entry<'_, D>,
        (level, solver, cells): (usize, &str, f64),
        error: Error,
    ) -> Result<Row, Error> {
        let row = self.empty_row(entry, (level, solver), Outcome::OutOfMemory);
        Row { cells: cells as usize, ..row }.with_error(error)
    }
}
