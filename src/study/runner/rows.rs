//! The rows of a study: one scheme on one level each.

use super::{Entry, Progress, Study};
use crate::error::Error;
#[cfg(feature = "report")]
use crate::exchange::{write_constants, write_inequality};
use crate::inequality::Outcome;
use crate::mesh::Mesh;
use crate::nested::{NestedIteration, Phase, Solved};
use crate::scenes::check::Violation;
use crate::scenes::check_exact_on;
use crate::scheme::ExpectedOrders;
#[cfg(feature = "report")]
use crate::study::file_name::file_name;
use crate::study::memory::peak_memory_bytes;
use crate::study::reference::Measured;
use crate::study::row::Row;
use crate::study::setting::setting;

/// The hierarchy that has a level, with the place of its mesh.
pub(super) fn with_level<'n, 'p, const D: usize>(
    nested: &'n mut [NestedIteration<'p, D>],
    level: usize,
) -> (usize, &'n mut NestedIteration<'p, D>) {
    let mut on_level = nested.iter_mut().filter_map(|n| Some((n.position(level)?, n)));
    on_level.next().expect("the meshes of all levels are there")
}

impl<const D: usize> Study<'_, D> {
    /// Adds a row that is finished.
    pub(super) fn finish<'r>(&self, row: Row, rows: &'r mut Vec<Row>) -> Result<&'r Row, Error> {
        #[cfg(feature = "report")]
        if let Some(journal) = self.journal {
            journal.add(&row)?;
        }
        (self.observer)(Progress::Finished(&row));
        rows.push(row);
        Ok(&rows[rows.len() - 1])
    }

    /// The row of one scheme on one level of these hierarchies, with its solution; there is none where the data
    /// left none, or where the solve needs more than the bytes that were available before the first row.
    pub(super) fn row<'p>(
        &self,
        nested: &mut [NestedIteration<'p, D>],
        entry: &'p Entry<'_, D>,
        (level, solver): (usize, &str),
        measured: Measured<'_, 'p, D>,
        available: Option<u64>,
    ) -> Result<(Row, Option<Solved<'p, D>>), Error> {
        if let Err(error) = self.check_level(&*entry.scheme, level, available) {
            let cells = self.scene.domain.cells(level);
            return Ok((self.row_without_memory(entry, (level, cells), solver, error)?, None));
        }
        let (position, nested) = with_level(nested, level);
        nested.replace_constraint_set(&entry.problem);
        match nested.solve_on(position, &*entry.scheme) {
            Ok(solved) => Ok((self.row_of(entry, level, &solved, solver, measured)?, Some(solved))),
            Err(error) => {
                let place = (level, nested.mesh(position));
                Ok((self.row_without(entry, place, solver, measured.failure, error)?, None))
            }
        }
    }

    /// The row that the data of a problem leave on a mesh.
    ///
    /// # Errors
    /// The error itself if another mesh would have it too.
    pub(super) fn row_without(
        &self,
        entry: &Entry<'_, D>,
        (level, mesh): (usize, &Mesh<D>),
        solver: &str,
        failure: Option<&str>,
        error: Error,
    ) -> Result<Row, Error> {
        let scheme = &*entry.scheme;
        let space = scheme.discretise(&entry.problem, mesh, self.quadrature);
        let without_solution = Row {
            parameters: scheme.parameters(mesh),
            unknowns: space.ok().map(|space| space.unknowns()),
            cells: mesh.n_cells(),
            mesh_size: mesh.mesh_size(),
            solver: solver.to_owned(),
            peak_memory_bytes: peak_memory_bytes(),
            ..Row::new(&self.scene.name, D, scheme.name(), level, Outcome::Malformed)
        };
        self.named(entry, without_solution, failure).with_error(error)
    }

    /// The row of a solution.
    pub(super) fn row_of<'p>(
        &self,
        entry: &Entry<'_, D>,
        level: usize,
        solved: &Solved<'p, D>,
        solver: &str,
        measured: Measured<'_, 'p, D>,
    ) -> Result<Row, Error> {
        (self.observer)(Progress::Entered(Phase::Measures));
        let row = self.measured_row(entry, level, solved, measured)?;
        let (solver, peak_memory_bytes) = (solver.to_owned(), peak_memory_bytes());
        Ok(Row { solver, peak_memory_bytes, ..row })
    }

    /// The name of a row in its files, after the scene: the label, with the solver where there are several.
    fn name_of_files(&self, row: &Row) -> String {
        match self.solvers.len() {
            0 | 1 => row.label.clone(),
            _ => format!("{}-{}", row.label, row.solver),
        }
    }

    /// Whether the fields of a row of an earlier run are wanted and not there: the run ended before they were written.
    #[cfg(feature = "report")]
    pub(super) fn lacks_files(&self, row: &Row) -> bool {
        let name = self.name_of_files(row);
        let lacks = self.fields.lack((&row.scene, &name), row.level, &self.levels);
        lacks && row.status.has_iterate()
    }

    /// Writes the files of a solution whose row is finished; `levels` are those that have files. The first file that
    /// cannot be written goes to `unwritten`: it is no reason for the other rows not to run.
    ///
    /// # Errors
    /// Those of the function for each solution.
    #[cfg_attr(not(feature = "report"), expect(unused_variables))]
    pub(super) fn write_files<'p>(
        &self,
        row: &Row,
        levels: &[usize],
        solved: &Solved<'p, D>,
        measured: Measured<'_, 'p, D>,
        unwritten: &mut Option<Error>,
    ) -> Result<(), Error> {
        let Row { scene, label, level, .. } = row;
        let name = self.name_of_files(row);
        #[cfg(feature = "report")]
        {
            let reference = measured.reference.and_then(|found| found.as_ref().ok());
            let reference = reference.map(|found| &found.solved);
            let fields = self.fields.write((scene, &name), *level, levels, solved, reference);
            let dumped = self.inequalities.as_ref().map_or(Ok(()), |directory| {
                let folder = directory.join(file_name(&format!("{scene}-{label}-{level}")));
                write_inequality(&folder, solved.inequality(), solved.mesh())?;
                write_constants(folder, &solved.solution().constants)
            });
            *unwritten = unwritten.take().or(fields.err()).or(dumped.err());
        }
        match self.each_solution.as_ref().filter(|_| solved.has_iterate()) {
            Some(f) => f(&name, *level, solved),
            None => Ok(()),
        }
    }

    /// The row of a solution with its errors and totals, without solver and memory.
    pub(super) fn measured_row<'p>(
        &self,
        entry: &Entry<'_, D>,
        level: usize,
        solved: &Solved<'p, D>,
        measured: Measured<'_, 'p, D>,
    ) -> Result<Row, Error> {
        let row = Row::of(&self.scene.name, entry.scheme.name(), level, solved);
        let mut row = self.named(entry, row, measured.failure);
        match measured.measure(&mut row, solved) {
            Ok(()) => {
                let is_measured = row.against.as_deref() == Some("exact");
                row.warnings.extend(self.why_not_exact(solved).filter(|_| is_measured));
                Ok(row)
            }
            Err(error) => row.with_error(error),
        }
    }

    /// Why the solution that is stated for a problem with data by name does not solve it, if that is found on the mesh
    /// of the first row. Scenes are tested by [`check_scene`](crate::scenes::check_scene).
    fn why_not_exact(&self, solved: &Solved<'_, D>) -> Option<String> {
        let problem = solved.discretisation().problem();
        let found = || {
            let name = &self.scene.name;
            let violation = match problem.has_named_data() {
                true => check_exact_on(name, problem, solved.mesh()).err()?,
                false => return None,
            };
            let Violation { condition, at, by, .. } = violation;
            Some(format!(
                "the stated solution does not solve this problem: not fulfilled: {condition}; at {at:.4?} off by {by:.2e}"
            ))
        };
        self.not_exact.get_or_init(found).clone()
    }

    /// The row with the names of constraint set and label, the kind of meshes, and the promised orders.
    pub(super) fn named(&self, entry: &Entry<'_, D>, row: Row, failure: Option<&str>) -> Row {
        let (scheme, set) = (&*entry.scheme, entry.problem.constraint_set());
        let kind = match self.scene.domain.is_mesh() {
            _ if self.adaptive.is_some() => "steps",
            true => "refinements",
            false => "subdivisions",
        };
        let expected_order = match (failure, &self.scene.problem.exact) {
            (None, Some(_)) => scheme.expected_orders_on(set, &setting(&self.scene)),
            // theory promises nothing without an exact solution that holds on the mesh
            _ => ExpectedOrders::default(),
        };
        Row {
            constants: self.scene.problem.constants.clone(),
            level_kind: Some(kind.to_owned()),
            theta: self.adaptive.map(|of| of.theta),
            linear_asked: self.linear_asked.clone(),
            // all rows of a request have the same keys
            history: row.history.or_else(|| self.keeps_history.then(Vec::new)),
            constraint: scheme.constraint_on(set).unwrap_or_else(|| set.name().to_owned()),
            label: entry.label.clone(),
            expected_order,
            ..row
        }
    }
}
