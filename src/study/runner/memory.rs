//! Runs that do not fit into the memory.

use super::{Entry, Study};
use crate::error::Error;
use crate::inequality::Outcome;
use crate::scheme::Scheme;
use crate::study::memory::{bytes_about, peak_memory_bytes, unknowns_about};
use crate::study::row::Row;

impl<const D: usize> Study<'_, D> {
    /// Bytes that the process needs for the largest run of a scheme on a level, about: right to a factor of two without
    /// factors of matrices, of three with them; the reference solution and adaptive meshes do not count. None for a study
    /// without schemes or levels. No mesh is built.
    pub fn memory_bytes(&self) -> Option<f64> {
        let schemes = self.entries.iter().map(|entry| &*entry.scheme);
        let of = |scheme| {
            self.levels.iter().map(move |&k| self.bytes_of(scheme, self.scene.domain.cells(k)))
        };
        schemes.flat_map(of).max_by(f64::total_cmp)
    }

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
