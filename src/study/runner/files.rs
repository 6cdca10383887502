//! The files of fields and inequalities that a study writes.

use super::Study;
use crate::error::Error;
#[cfg(feature = "report")]
use crate::exchange::{write_constants, write_inequality};
use crate::nested::Solved;
#[cfg(feature = "report")]
use crate::study::file_name::file_name;
#[cfg(feature = "report")]
use crate::study::reference::FoundReference;
use crate::study::row::Row;

impl<const D: usize> Study<'_, D> {
    /// The name of a row in its files, after the scene: the label, with the solver where there are several.
    fn name_of_files(&self, row: &Row) -> String {
        match self.solvers.len() {
            0 | 1 => row.label.clone(),
            _ => format!("{}-{}", row.label, row.solver),
        }
    }

    /// Writes the files of a solution before its row is finished, so that a row that is kept has its files; `levels` are
    /// those that have some. The first file that cannot be written goes to `unwritten`: it is no reason for the other rows
    /// not to run.
    #[cfg(feature = "report")]
    pub(super) fn write_files<'p>(
        &self,
        row: &Row,
        levels: &[usize],
        solved: &Solved<'p, D>,
        reference: Option<&FoundReference<'p, D>>,
        unwritten: &mut Option<Error>,
    ) {
        let Row { scene, label, level, .. } = row;
        let reference = reference.and_then(|found| found.as_ref().ok());
        let reference = reference.map(|found| &found.solved);
        let place = (&scene[..], &self.name_of_files(row)[..]);
        let fields = self.fields.write(place, *level, levels, solved, reference);
        let dumped = self.inequalities.as_ref().map_or(Ok(()), |directory| {
            let folder = directory.join(file_name(&format!("{scene}-{label}-{level}")));
            write_inequality(&folder, solved.inequality(), solved.mesh())?;
            write_constants(folder, &solved.solution().constants)
        });
        *unwritten = unwritten.take().or(fields.err()).or(dumped.err());
    }

    /// Hands a solution whose row is finished to the function that receives each.
    pub(super) fn hand_over(&self, row: &Row, solved: &Solved<'_, D>) -> Result<(), Error> {
        match self.each_solution.as_ref().filter(|_| solved.has_iterate()) {
            Some(f) => f(&self.name_of_files(row), row.level, solved),
            None => Ok(()),
        }
    }
}
