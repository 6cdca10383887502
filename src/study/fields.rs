//! The files of fields that a study writes.

use std::path::PathBuf;

use super::file_name::file_name;
use crate::error::Error;
use crate::files::replace;
use crate::nested::Solved;
use crate::paraview::write_pvd;

/// Where a study writes the fields of which levels.
#[derive(Clone, Debug, Default)]
pub(in crate::study) struct FieldFiles {
    pub directory: Option<PathBuf>,
    pub all_levels: bool,
}

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
    pub fn write<const D: usize>(
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
