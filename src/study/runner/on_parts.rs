//! A study over the parts of a mesh, one in each process.

use std::rc::Rc;

use super::rows::with_level;
use super::{Entry, Progress, Study};
use crate::distributed::{Process, SolverOnParts};
use crate::error::Error;
use crate::inequality::Outcome;
use crate::mesh::{Layers, Mesh};
use crate::nested::{Hierarchy, NestedIteration, Solved};
use crate::processes::{ExchangeError, agree};
use crate::real::Precision;
#[cfg(feature = "report")]
use crate::study::file_name::file_name;
use crate::study::memory::peak_memory_bytes;
use crate::study::part_figures::{PartFigures, PartSeconds};
use crate::study::report::Report;
use crate::study::row::{Row, Seconds};

impl<const D: usize> Study<'_, D> {
    /// [`Study::check`] for a study over the parts of a mesh: limits of numbers are those of each process.
    ///
    /// # Errors
    /// Those of [`Study::check`].
    pub fn check_on_parts(&self, process: &Process) -> Result<(), Error> {
        self.check_parts()?;
        self.check_for(process.count())
    }

    /// Runs every scheme on every level over the parts of a mesh, of which this process has one. All processes
    /// run the same study, the first with journal and observer; all get the report.
    ///
    /// # Errors
    /// Errors of [`Self::check_on_parts`]; [`Error::Parameter`] for what parts of a mesh do not have: other solvers,
    /// references, adaptive meshes, files of fields and inequalities, a journal of an earlier run. A run that
    /// fails is no error: its row has the outcome and the message.
    pub fn run_on_parts(&self, process: &Process) -> Result<Report, Error> {
        self.check_on_parts(process)?;
        let hierarchies = self.hierarchies_on_parts(process)?;
        let solver = Rc::new(SolverOnParts::new(process.clone()));
        let on_parts = |hierarchy| {
            let nested = NestedIteration::new(&self.scene.problem, hierarchy);
            nested.quadrature(self.quadrature).system_solver(solver.clone())
        };
        let mut nested: Vec<NestedIteration<'_, D>> = hierarchies.iter().map(on_parts).collect();
        let mut rows = Vec::new();
        #[cfg(feature = "report")]
        let mut unwritten = None;
        for entry in &self.entries {
            for &level in &self.levels {
                (self.observer)(Progress::Started(&self.scene.name, &entry.label, level));
                let (position, nested) = with_level(&mut nested, level);
                nested.replace_constraint_set(&entry.problem);
                let solved = nested.solve_on(position, &*entry.scheme);
                let place = (level, nested.mesh(position));
                let failed = |error: &Error| self.row_of_failure(entry, place, error, process);
                let mut row = match &solved {
                    Err(error) => failed(error),
                    Ok(solved) => self
                        .row_on_parts(entry, level, solved, process)
                        .unwrap_or_else(|error| failed(&error)),
                };
                row.solver = nested.solver_name().to_owned();
                agree(self.finish(row, &mut rows).map(|_| ()), &*process.exchange)?;
                #[cfg(feature = "report")]
                if let Ok(solved) = &solved {
                    let written = self.write_on_parts(entry, level, solved);
                    unwritten = unwritten.or(written.err());
                }
            }
        }
        #[cfg(feature = "report")]
        if let Some(error) = unwritten {
            return Err(error);
        }
        Ok(self.report(rows))
    }

    /// The parts of the fewest hierarchies that have all levels.
    fn hierarchies_on_parts(&self, process: &Process) -> Result<Vec<Hierarchy<D>>, Error> {
        let layers = |mesh: &Mesh<D>| {
            let layers = self.entries.iter().map(|entry| entry.scheme.layers(mesh).count).max();
            Layers::across_vertices(layers.unwrap_or(1).max(1))
        };
        let process = (process.number, &process.exchange);
        let domain = &self.scene.domain;
        Hierarchy::all_by(&self.levels, |level| {
            Hierarchy::of_domain_in_parts(domain, level, layers, process)
        })
    }

    /// The row of a run that failed, in all parts.
    fn row_of_failure(
        &self,
        entry: &Entry<'_, D>,
        (level, mesh): (usize, &Mesh<D>),
        error: &Error,
        process: &Process,
    ) -> Row {
        // without a fault of the data the engine has failed
        let outcome = ExchangeError::outcome_of(error).unwrap_or(Outcome::Singular);
        let ranks = PartFigures {
            count: process.count(),
            engine: process.engine.name(),
            ..PartFigures::default()
        };
        Row {
            ranks: Some(ranks),
            message: Some(error.to_string()),
            mesh_size: mesh.mesh_size(),
            ..self.empty_row(entry, (level, ""), outcome)
        }
    }

    /// Refuses what parts of a mesh do not have.
    fn check_parts(&self) -> Result<(), Error> {
        let others = self
            .solvers
            .iter()
            .any(|solver| solver.name() != "active-set" || solver.precision() != Precision::Double);
        let asked = [
            ("solver", others),
            ("adaptive meshes", self.adaptive.is_some()),
            ("reference", self.reference.is_some()),
            ("history", self.keeps_history),
            ("tolerance", self.tolerance.is_some()),
            ("repeat", self.repeat > 1),
            ("cold start", self.has_cold_start),
            ("values", !self.scene.problem.values.is_empty()),
        ];
        match asked.iter().find(|(_, is_asked)| *is_asked) {
            None => Ok(()),
            Some((parameter, _)) => Err(Error::parameter(
                parameter,
                "over several processes",
                "the active set method in `f64` on uniform meshes, with errors against the exact solution, once from coarser levels to rounding, without a history and values by name",
            )),
        }
    }

    /// The row of a solution.
    fn row_on_parts(
        &self,
        entry: &Entry<'_, D>,
        level: usize,
        solved: &Solved<'_, D>,
        process: &Process,
    ) -> Result<Row, Error> {
        let (parts, peak_memory_bytes) = part_figures(solved, process)?;
        let mut row = self.row_of(entry, (level, ""), solved, None)?;
        let PartSeconds { mesh, assemble, number, start, solve } = parts.seconds;
        let in_bound = process.exchange.largest(&[row.seconds.bound.unwrap_or(0.0)])?[0];
        row.seconds = Seconds {
            start: Some(start[1]),
            bound: row.seconds.bound.map(|_| in_bound),
            ..Seconds::new(mesh[1], assemble[1] + number[1], start[1] + solve[1])
        };
        row.peak_memory_bytes = peak_memory_bytes;
        row.ranks = Some(parts);
        Ok(row)
    }

    /// Writes the fields of the finest level, if fields are wanted and there is an iterate.
    #[cfg(feature = "report")]
    fn write_on_parts(
        &self,
        entry: &Entry<'_, D>,
        level: usize,
        solved: &Solved<'_, D>,
    ) -> Result<(), Error> {
        match &self.fields.directory {
            Some(directory) if self.levels.iter().max() == Some(&level) && solved.has_iterate() => {
                let stem = file_name(&format!("{}-{}", self.scene.name, entry.label));
                solved.write_vtu_of_parts(directory, &stem, |file| file)
            }
            _ => Ok(()),
        }
    }
}

/// The figures of all parts, and the largest peak memory of a process.
fn part_figures<const D: usize>(
    solved: &Solved<'_, D>,
    process: &Process,
) -> Result<(PartFigures, Option<u64>), ExchangeError> {
    let inequality = solved.inequality();
    let own = (0..inequality.size()).filter(|&i| inequality.owns(i)).count();
    let ghosts = (inequality.size() - own) as f64;
    let [_, unknowns, _] = solved.sizes();
    let memory = peak_memory_bytes().map_or(f64::NAN, |bytes| bytes as f64);
    let own_numbers = [
        solved.mesh_seconds,
        solved.system().assemble_seconds,
        solved.system().numbering_seconds,
        solved.start_seconds,
        solved.solve_seconds,
        memory,
    ];
    let most = process.exchange.largest(&own_numbers)?;
    let least = process.exchange.largest(&own_numbers.map(|x| -x))?;
    let range = |k: usize| [-least[k], most[k]];
    let largest = process.exchange.largest(&[own as f64])?;
    let ghosts = process.exchange.sum(&[ghosts])?[0];
    let count = process.count();
    let figures = PartFigures {
        count,
        engine: process.engine.name(),
        ghosts: ghosts / unknowns as f64,
        imbalance: largest[0] * count as f64 / unknowns as f64,
        seconds: PartSeconds {
            mesh: range(0),
            assemble: range(1),
            number: range(2),
            start: range(3),
            solve: range(4),
        },
    };
    Ok((figures, (!most[5].is_nan()).then_some(most[5] as u64)))
}
