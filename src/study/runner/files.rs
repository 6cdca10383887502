//! The files of fields and inequalities that a study writes.

#[cfg(feature = "report")]
use std::path::PathBuf;

use super::Study;
#[cfg(feature = "report")]
use super::reference::FoundReference;
use crate::error::Error;
#[cfg(feature = "report")]
use crate::exchange::{write_constants, write_inequality};
#[cfg(feature = "report")]
use crate::files::replace;
use crate::nested::Solved;
#[cfg(feature = "report")]
use crate::paraview::write_pvd;
#[cfg(feature = "report")]
use crate::study::file_name::file_name;
use crate::study::row::Row;

/// Where a study writes the fields of which levels.
#[cfg(feature = "report")]
#[derive(Clone, Debug, Default)]
pub(super) struct FieldFiles {
    pub directory: Option<PathBuf>,
    pub all_levels: bool,
}

#[cfg(feature = "report")]
impl FieldFiles {
    /// The file of a level: `SCENE-LABEL.vtu` of the finest, `SCENE-LABEL-LEVEL.vtu` of others; none where no fields of
    /// the level are wanted.
    fn path(
        &self,
        (scene, label): (&str, &str),
        level: usize,
        levels: &[usize],
    ) -> Option<PathBuf> {
        let (directory, stem) = (self.directory.as_ref()?, file_name(&format!("{scene}-{label}")));
        match levels.iter().max() == Some(&level) {
            true => Some(directory.join(format!("{stem}.vtu"))),
            false => self.all_levels.then(|| directory.join(format!("{stem}-{level}.vtu"))),
        }
    }

    /// Writes the fields of a solution if its level is wanted; with all levels also `SCENE-LABEL.pvd`, which lists the
    /// files that are there. Where there is a reference the error is the difference from it.
    fn write<const D: usize>(
        &self,
        (scene, label): (&str, &str),
        level: usize,
        levels: &[usize],
        solved: &Solved<'_, D>,
        reference: Option<&Solved<'_, D>>,
    ) -> Result<(), Error> {
        let path = |level: usize| self.path((scene, label), level, levels);
        let (Some(directory), Some(file)) = (&self.directory, path(level)) else { return Ok(()) };
        if !solved.has_iterate() {
            return Ok(());
        }
        replace(&file, |draft| {
            solved.write_vtu_against(draft, reference, |file| file.number("level", level as f64))
        })?;
        if !self.all_levels {
            return Ok(());
        }
        let mut done: Vec<usize> = levels.to_vec();
        done.sort_unstable();
        let files = done.into_iter().filter_map(|level| Some((level as f64, path(level)?)));
        let series: Vec<(f64, PathBuf)> = files.filter(|(_, path)| path.exists()).collect();
        let stem = file_name(&format!("{scene}-{label}"));
        write_pvd(&directory.join(format!("{stem}.pvd")), &series)
    }
}

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
