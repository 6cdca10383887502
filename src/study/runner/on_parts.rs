//! A study over the parts of a mesh, one in each process.

use std::path::Path;

use super::{Entry, Progress, Study};
use crate::distributed::{
    Differences, DistributedIteration, DistributedSolved, ExchangeError, PartHierarchy, Process,
    agree,
};
use crate::error::{Error, write_error};
use crate::error_bound::BoundFigures;
use crate::inequality::Outcome;
use crate::measure::Errors;
use crate::mesh::{Layers, Part};
use crate::nested::{Hierarchy, descending, no_digits_of_forces};
use crate::problem::Problem;
use crate::scheme::ExpectedOrders;
#[cfg(feature = "report")]
use crate::study::file_name::file_name;
use crate::study::memory::peak_memory_bytes;
use crate::study::part_figures::{PartFigures, PartSeconds};
use crate::study::report::Report;
use crate::study::row::{Iterations, Row, Seconds};

/// Fewest cells of the coarsest mesh for each part.
const CELLS_OF_PART: f64 = 16.0;

/// What a study over the parts of a mesh does besides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PartChecks {
    /// Compares the rows of all parts with those of the whole mesh, which every process then has.
    pub verify: bool,
    /// Solves inequalities by a method of the engine itself.
    pub by_engine: bool,
}

/// The meshes of some levels with their positions in the parts of nested meshes.
struct PartsOfLevels<const D: usize> {
    levels: Vec<usize>,
    hierarchy: PartHierarchy<D>,
}

impl<const D: usize> Study<'_, D> {
    /// Runs every scheme on every level over the parts of a mesh, of which this process has one. All processes
    /// run the same study, the first with journal and observer; all get the report.
    ///
    /// # Errors
    /// Errors of [`Self::check`]; [`Error::Parameter`] for what parts of a mesh do not have: other solvers,
    /// references, adaptive meshes, files of fields and inequalities, a journal of an earlier run. A run that
    /// fails is no error: its row has the outcome and the message.
    pub fn run_on_parts(&self, process: &Process, checks: PartChecks) -> Result<Report, Error> {
        let failure = self.where_exact_fails()?;
        self.check_parts()?;
        let problems = self.problems();
        let hierarchies = self.hierarchies_on_parts(process)?;
        let problem = &self.scene.problem;
        let mut nested: Vec<DistributedIteration<'_, D>> = Vec::new();
        for of in &hierarchies {
            let of_levels = DistributedIteration::new(problem, &of.hierarchy, process.clone());
            nested.push(of_levels.quadrature(self.quadrature).by_engine(checks.by_engine));
        }
        let admissible = self.check_crossing_on_parts(&hierarchies, process)?;
        let mut rows = Vec::new();
        for (entry, problem) in self.entries.iter().zip(&problems) {
            let label = entry.label(problem);
            for &level in &self.levels {
                (self.observer)(Progress::Started(&self.scene.name, &label, level));
                let found = hierarchies.iter().zip(&mut nested).find_map(|(of, nested)| {
                    Some((of.levels.iter().position(|&l| l == level)?, nested))
                });
                let Some((position, nested)) = found else {
                    unreachable!("a hierarchy has the level")
                };
                nested.replace_constraint_set(problem);
                if let Err(error) = &admissible {
                    let (of, place) = ((entry, problem), (level, nested.part(position)));
                    let row = self.row_of_failure(of, place, error, (process, checks));
                    self.finish_on_parts(row, &mut rows, process)?;
                    continue;
                }
                let solved = nested.solve_on(position, &*entry.scheme);
                let measured = solved.as_ref().map_err(Clone::clone).and_then(|solved| {
                    let verify = checks.verify;
                    self.row_on_parts((entry, problem), level, solved, (process, verify))
                });
                let part = nested.part(position);
                let mut row = measured.unwrap_or_else(|error| {
                    self.row_of_failure((entry, problem), (level, part), &error, (process, checks))
                });
                row.solver = if checks.by_engine { "engine" } else { "active-set" }.to_owned();
                if let Some(at) = &failure {
                    (row.error, row.against) = (Errors::default(), None);
                    (row.bound.effectivity, row.bound.effectivity_of_v) = (None, None);
                    row.expected_order = ExpectedOrders::default();
                    row.warnings.push(format!(
                        "the exact solution breaks the contact condition of this mesh at {at}: no errors"
                    ));
                }
                self.finish_on_parts(row, &mut rows, process)?;
                #[cfg(feature = "report")]
                if let Ok(solved) = &solved {
                    self.write_on_parts(entry, problem, level, solved)?;
                }
            }
        }
        Ok(self.report(rows))
    }

    /// The error of all parts if lower bounds exceed upper ones on a part of the finest meshes.
    fn check_crossing_on_parts(
        &self,
        hierarchies: &[PartsOfLevels<D>],
        process: &Process,
    ) -> Result<Result<(), ExchangeError>, Error> {
        let Some(points) = self.points_of_bounds()? else { return Ok(Ok(())) };
        let look_at = |of: &PartsOfLevels<D>| {
            let part = of.hierarchy.part(of.levels.len() - 1);
            let own = points.look(&self.scene.problem, &part.mesh);
            let seen = agree(own, &*process.exchange)?;
            let size = process.exchange.largest(&[seen.size()])?[0];
            let own = seen.crossing(size);
            let own = own.map_or(Ok(()), |found| Err(found.error().in_whole_mesh(&part.cells)));
            agree(own, &*process.exchange).map_err(|error| match error {
                ExchangeError::Failed { part, message, .. } => {
                    ExchangeError::Failed { part, message, outcome: Some(Outcome::Infeasible) }
                }
                other => other,
            })
        };
        Ok(hierarchies.iter().try_for_each(look_at))
    }

    /// The parts of the fewest hierarchies that have all levels.
    fn hierarchies_on_parts(&self, process: &Process) -> Result<Vec<PartsOfLevels<D>>, Error> {
        let mut hierarchies: Vec<PartsOfLevels<D>> = Vec::new();
        for level in descending(&self.levels) {
            if !hierarchies.iter().any(|of| of.levels.contains(&level)) {
                hierarchies.push(self.parts_of(level, process)?);
            }
        }
        Ok(hierarchies)
    }

    /// The row of a run that failed, in all parts.
    fn row_of_failure(
        &self,
        (entry, problem): (&Entry<'_, D>, &Problem<D>),
        (level, part): (usize, &Part<D>),
        error: &ExchangeError,
        (process, checks): (&Process, PartChecks),
    ) -> Row {
        // without a fault of the data the engine has failed
        let outcome = match error {
            ExchangeError::Failed { outcome: Some(outcome), .. } => *outcome,
            _ => Outcome::Singular,
        };
        let ranks = PartFigures {
            count: process.count(),
            engine: process.engine.name(),
            // all rows of a report have the same keys
            differences: checks.verify.then(Differences::default),
            ..PartFigures::default()
        };
        let row = Row {
            ranks: Some(ranks),
            message: Some(error.to_string()),
            mesh_size: part.mesh.mesh_size(),
            ..Row::new(&self.scene.name, D, entry.scheme.name(), level, outcome)
        };
        self.named(entry, problem, row, None)
    }

    /// Adds a row that is finished, if no process failed to write it.
    fn finish_on_parts(
        &self,
        row: Row,
        rows: &mut Vec<Row>,
        process: &Process,
    ) -> Result<(), Error> {
        let own = self.finish(row, rows);
        let failed = [f64::from(u8::from(own.is_err()))];
        let failed = process.exchange.largest(&failed).map_err(|error| error.to_string());
        own?;
        match failed {
            Ok(failed) if failed[0] == 0.0 => Ok(()),
            Ok(_) => {
                Err(write_error(Path::new("the journal"), "another process failed".to_owned()))
            }
            Err(why) => Err(write_error(Path::new("the journal"), why)),
        }
    }

    /// Refuses what parts of a mesh do not have.
    fn check_parts(&self) -> Result<(), Error> {
        let others = self.solvers.iter().any(|solver| solver.name() != "active-set");
        let asked = [
            ("solver", others),
            ("adaptive meshes", self.adaptive.is_some()),
            ("reference", self.reference.is_some()),
        ];
        match asked.iter().find(|(_, is_asked)| *is_asked) {
            None => Ok(()),
            Some((parameter, _)) => Err(Error::Parameter {
                parameter,
                value: "over several processes".to_owned(),
                allowed: "the active set method on uniform meshes, with errors against the exact solution"
                    .to_owned(),
            }),
        }
    }

    /// The parts of the nested meshes that end with a level.
    fn parts_of(&self, level: usize, process: &Process) -> Result<PartsOfLevels<D>, Error> {
        let coarsest = self.coarsest();
        coarsest.check(level)?;
        let mut levels = coarsest.levels_to(level);
        let least = CELLS_OF_PART * process.count() as f64;
        while levels.len() > 1 && coarsest.cells(levels[0]) < least {
            levels.remove(0);
        }
        let first = coarsest.build(levels[0])?;
        let mesh = Hierarchy::finest(&first);
        let layers = self.entries.iter().map(|entry| entry.scheme.layers(mesh).count).max();
        let layers = Layers::across_vertices(layers.unwrap_or(1).max(1));
        let domain = self.mesh.is_none().then_some(&self.scene.domain);
        let refinements = levels.len() - 1;
        PartHierarchy::new(mesh, domain, (refinements, layers), process)
            .map(|hierarchy| PartsOfLevels { levels, hierarchy })
            .map_err(|error| Error::Parameter {
                parameter: "level",
                value: level.to_string(),
                allowed: error.to_string(),
            })
    }

    /// The row of a solution.
    fn row_on_parts(
        &self,
        (entry, problem): (&Entry<'_, D>, &Problem<D>),
        level: usize,
        solved: &DistributedSolved<'_, D>,
        (process, verify): (&Process, bool),
    ) -> Result<Row, ExchangeError> {
        let solution = solved.solution();
        let [cells, unknowns, nonzeros] = solved.sizes();
        let has_iterate = solved.has_iterate();
        let (error, bound, in_bound) = match has_iterate {
            true => solved.errors_and_bound()?,
            false => (Errors::default(), BoundFigures::default(), 0.0),
        };
        let energy = if has_iterate { Some(solved.energy()?) } else { None };
        let resultant = if has_iterate { solved.resultant() } else { None };
        let penetration = if has_iterate { solved.penetration()? } else { None };
        let mut parts = self.part_figures(solved, unknowns, process)?;
        if verify {
            let whole = self.coarsest().build(level).map_err(|error| ExchangeError::Failed {
                part: process.number,
                message: error.to_string(),
                outcome: None,
            })?;
            let scheme = &*entry.scheme;
            parts.differences = Some(solved.verify(scheme, whole.finest(), self.quadrature)?);
        }
        let in_bound = process.exchange.largest(&[in_bound])?[0];
        let mut warnings = warnings(solved);
        if has_iterate && problem.is_constrained() && resultant.is_none() {
            warnings.push(no_digits_of_forces("f64"));
        }
        let against = (has_iterate && problem.exact.is_some()).then_some("exact");
        warnings.extend(bound.remark(against).filter(|_| solved.converged()));
        let PartSeconds { mesh, assemble, number, start, solve } = parts.seconds;
        let mut row = Row {
            parameters: solved.discretisation().form().theory().parameters,
            linear: solution.linear_solver.to_owned(),
            cells: cells as usize,
            unknowns: Some(unknowns as usize),
            nonzeros: Some(nonzeros as usize),
            mesh_size: solved.part().mesh.mesh_size(),
            against: against.map(str::to_owned),
            error,
            rounding: if has_iterate { solved.rounding() } else { None },
            objective: if has_iterate { solved.objective() } else { None },
            energy,
            active: if has_iterate { Some(solved.active() as usize) } else { None },
            contact_measure: if has_iterate { solved.contact_measure() } else { None },
            resultant,
            resultants: if has_iterate { solved.resultants() } else { None },
            iterations: Iterations {
                outer: has_iterate.then_some(solution.outer),
                linear: solution.linear,
                levels: 0,
                start_cycles: 0,
                stages: solution.stages.clone(),
            },
            certificate: solved.certificate(),
            seconds: Seconds {
                bound: has_iterate.then_some(in_bound),
                ..Seconds::new(mesh[1], assemble[1] + number[1], start[1] + solve[1])
            },
            bound,
            peak_memory_bytes: parts.peak_memory_bytes.map(|[_, most]| most),
            warnings,
            ranks: Some(parts),
            ..Row::new(&self.scene.name, D, entry.scheme.name(), level, solved.outcome())
        };
        row.set_penetration(penetration);
        Ok(self.named(entry, problem, row, None))
    }

    /// Writes the fields of the finest level, if fields are wanted and there is an iterate.
    #[cfg(feature = "report")]
    fn write_on_parts(
        &self,
        entry: &Entry<'_, D>,
        problem: &Problem<D>,
        level: usize,
        solved: &DistributedSolved<'_, D>,
    ) -> Result<(), Error> {
        match &self.fields.directory {
            Some(directory) if self.levels.iter().max() == Some(&level) && solved.has_iterate() => {
                let label = entry.label(problem);
                let stem = file_name(&format!("{}-{label}", self.scene.name));
                let list = directory.join(format!("{stem}.pvtu"));
                solved
                    .write_vtu(directory, &stem, self.fields.scalar)
                    .map_err(|why| write_error(&list, why.to_string()))
            }
            _ => Ok(()),
        }
    }

    /// The figures of all parts.
    fn part_figures(
        &self,
        solved: &DistributedSolved<'_, D>,
        unknowns: u64,
        process: &Process,
    ) -> Result<PartFigures, ExchangeError> {
        let [own, ghosts] = solved.own_unknowns().map(|n| n as f64);
        let memory = peak_memory_bytes().map_or(f64::NAN, |bytes| bytes as f64);
        let iterations = solved.solution().linear as f64;
        let own_numbers = [
            solved.mesh_seconds,
            solved.assemble_seconds,
            solved.numbering_seconds,
            solved.start_seconds,
            solved.solve_seconds,
            memory,
        ];
        let most = process.exchange.largest(&own_numbers)?;
        let least = process.exchange.largest(&own_numbers.map(|x| -x))?;
        let range = |k: usize| [-least[k], most[k]];
        let of_solve = [own, solved.sent_bytes() as f64];
        let largest = process.exchange.largest(&of_solve)?;
        let ghosts = process.exchange.sum(&[ghosts])?[0];
        let count = process.count();
        Ok(PartFigures {
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
            bytes_per_iteration: (iterations > 0.0).then(|| largest[1] / iterations),
            peak_memory_bytes: (!most[5].is_nan()).then(|| range(5).map(|x| x as u64)),
            differences: None,
        })
    }
}

/// What a user should know of a solution.
fn warnings<const D: usize>(solved: &DistributedSolved<'_, D>) -> Vec<String> {
    let is_unproven = !solved.inequality().is_definite;
    let text = "no theory says that the matrix is positive definite: a penalty is below its proven bound, or a reaction is negative";
    is_unproven.then(|| text.to_owned()).into_iter().collect()
}
