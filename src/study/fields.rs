//! Files of fields that a study writes.

use std::path::PathBuf;

use super::file_name::file_name;
use crate::error::Error;
use crate::files::replace;
use crate::nested::Solved;
use crate::paraview::{FieldScalar, write_pvd};
use crate::real::Real;

/// Where a study writes the fields of which levels, and with which scalar.
#[derive(Clone, Debug, Default)]
pub(super) struct FieldFiles {
    pub directory: Option<PathBuf>,
    pub scalar: FieldScalar,
    pub all_levels: bool,
}

impl FieldFiles {
    /// Writes the fields of a solution if its level is wanted: `SCENE-LABEL.vtu` for the finest of the
    /// levels; with all levels also `SCENE-LABEL-LEVEL.vtu` for the others and `SCENE-LABEL.pvd`, which
    /// lists the files that are there. Where there is a reference the error is the difference from it.
    pub fn write<T: Real, const D: usize>(
        &self,
        (scene, label): (&str, &str),
        level: usize,
        levels: &[usize],
        solved: &Solved<'_, T, D>,
        reference: Option<&Solved<'_, T, D>>,
    ) -> Result<(), Error> {
        let finest = levels.iter().max();
        let Some(directory) = &self.directory else { return Ok(()) };
        if !solved.has_iterate() || !(self.all_levels || finest == Some(&level)) {
            return Ok(());
        }
        let stem = file_name(&format!("{scene}-{label}"));
        let path = |level: usize| match finest == Some(&level) {
            true => directory.join(format!("{stem}.vtu")),
            false => directory.join(format!("{stem}-{level}.vtu")),
        };
        replace(&path(level), |draft| {
            solved.write_vtu_against(draft, reference, |file| {
                file.number("level", level as f64).scalar(self.scalar)
            })
        })?;
        if !self.all_levels {
            return Ok(());
        }
        let mut done: Vec<usize> = levels.iter().copied().filter(|&l| path(l).exists()).collect();
        done.sort_unstable();
        let series: Vec<(f64, PathBuf)> =
            done.into_iter().map(|level| (level as f64, path(level))).collect();
        let list = directory.join(format!("{stem}.pvd"));
        replace(&list, |draft| write_pvd(draft, &series)).map(|_| ())
    }
}
