//! The rows of a study, one scheme on one level each: all fields are filled in here.

use super::{Entry, Progress, Study};
use crate::error::Error;
use crate::inequality::{HistoryPoint, Outcome, explanation};
use crate::measure::FoundValue;
use crate::mesh::Mesh;
use crate::nested::{NestedIteration, Phase, Solved, warnings_of_forces};
use crate::scenes::check::Violation;
use crate::scenes::check_exact_on;
use crate::scheme::ExpectedOrders;
use crate::study::memory::peak_memory_bytes;
use crate::study::reference::FoundReference;
use crate::study::row::{Iterations, Row, Seconds};
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
        reference: Option<&FoundReference<'p, D>>,
        available: Option<u64>,
    ) -> Result<(Row, Option<Solved<'p, D>>), Error> {
        if let Err(error) = self.check_level(&*entry.scheme, level, available) {
            let place = (level, solver, self.scene.domain.cells(level));
            return Ok((self.row_without_memory(entry, place, error)?, None));
        }
        let (position, nested) = with_level(nested, level);
        nested.replace_constraint_set(&entry.problem);
        match nested.solve_on(position, &*entry.scheme) {
            Ok(solved) => {
                let row = self.row_of(entry, (level, solver), &solved, reference)?;
                Ok((row, Some(solved)))
            }
            Err(error) => {
                let place = (level, solver, nested.mesh(position));
                Ok((self.row_without(entry, place, error)?, None))
            }
        }
    }

    /// A row with its names, the kind of meshes and the promised orders, and nothing found.
    pub(super) fn empty_row(
        &self,
        entry: &Entry<'_, D>,
        (level, solver): (usize, &str),
        outcome: Outcome,
    ) -> Row {
        let (scheme, set) = (&*entry.scheme, entry.problem.constraint_set());
        let kind = match self.scene.domain.is_mesh() {
            _ if self.adaptive.is_some() => "steps",
            true => "refinements",
            false => "subdivisions",
        };
        let expected_order = match (self.where_exact_fails(), &self.scene.problem.exact) {
            (None, Some(_)) => scheme.expected_orders_on(set, &setting(&self.scene)),
            // theory promises nothing without an exact solution that holds on the mesh
            _ => ExpectedOrders::default(),
        };
        Row {
            constants: self.scene.problem.constants.clone(),
            constraint: scheme.constraint_on(set).unwrap_or_else(|| set.name().to_owned()),
            label: entry.label.clone(),
            level_kind: Some(kind.to_owned()),
            theta: self.adaptive.map(|of| of.theta),
            solver: solver.to_owned(),
            expected_order,
            tolerance: self.tolerance,
            // all rows of a request have the same keys
            history: self.keeps_history.then(Vec::new),
            peak_memory_bytes: peak_memory_bytes(),
            ..Row::new(&self.scene.name, D, scheme.name(), level, outcome)
        }
    }

    /// The row that the data of a problem leave on a mesh.
    ///
    /// # Errors
    /// The error itself if another mesh would have it too.
    pub(super) fn row_without(
        &self,
        entry: &Entry<'_, D>,
        (level, solver, mesh): (usize, &str, &Mesh<D>),
        error: Error,
    ) -> Result<Row, Error> {
        let space = entry.scheme.discretise(&entry.problem, mesh, self.quadrature);
        let without_solution = Row {
            parameters: entry.scheme.parameters(mesh),
            unknowns: space.ok().map(|space| space.unknowns()),
            cells: mesh.n_cells(),
            mesh_size: mesh.mesh_size(),
            ..self.empty_row(entry, (level, solver), Outcome::Malformed)
        };
        without_solution.with_error(error)
    }

    /// The row of a solution.
    pub(super) fn row_of<'p>(
        &self,
        entry: &Entry<'_, D>,
        place: (usize, &str),
        solved: &Solved<'p, D>,
        reference: Option<&FoundReference<'p, D>>,
    ) -> Result<Row, Error> {
        (self.observer)(Progress::Entered(Phase::Measures));
        let (solution, forces) = (solved.solution(), solved.multiplier());
        let [cells, unknowns, nonzeros] = solved.sizes().map(|n| n as usize);
        let mut warnings = solved.warnings().to_vec();
        warnings.extend(warnings_of_forces(solved, forces.as_deref()));
        let point = |at: &HistoryPoint| {
            (at.systems, at.seconds, Some(at.certificate).filter(|largest| largest.is_finite()))
        };
        let history = Some(&solution.history).filter(|history| !history.is_empty());
        let solve_seconds = solved.solve_seconds + solved.start_seconds;
        let row = self.empty_row(entry, place, solved.outcome());
        let mut row = Row {
            message: explanation(solved.inequality(), solved.outcome()).or(row.message),
            parameters: solved.discretisation().form().theory().parameters,
            linear: solution.linear_solver.to_owned(),
            cells,
            unknowns: Some(unknowns),
            nonzeros: Some(nonzeros),
            mesh_size: solved.mesh().mesh_size(),
            objective: solved.objective(),
            active: solved.active(),
            contact_measure: solved.contact_measure(),
            resultant: forces.map(|forces| solved.resultant_of(&forces)),
            resultants: solved.resultants(),
            iterations: Iterations {
                outer: solved.outer(),
                linear: solution.linear,
                levels: solved.coarser_levels,
                systems: solved.outer().and(solution.systems),
                start_cycles: solved.start_cycles,
                stages: solution.stages.clone(),
            },
            certificate: solved.certificate(),
            rounding: solved.rounding(),
            seconds: Seconds {
                start: Some(solved.start_seconds),
                ..Seconds::new(solved.mesh_seconds, solved.system().assemble_seconds, solve_seconds)
            },
            history: history.map(|of| of.iter().map(point).collect()).or(row.history),
            warnings,
            ..row
        };
        if let Err(error) = self.measure(&mut row, solved, reference) {
            row = row.with_error(error)?;
        }
        row.peak_memory_bytes = peak_memory_bytes();
        Ok(row)
    }

    /// Fills in energy, penetration, errors, bound and values, and why there are none.
    fn measure<'p>(
        &self,
        row: &mut Row,
        solved: &Solved<'p, D>,
        reference: Option<&FoundReference<'p, D>>,
    ) -> Result<(), Error> {
        row.energy = solved.energy()?;
        let penetration = solved.penetration()?;
        row.penetration = penetration.map(|found| found.largest()).filter(|most| most.is_finite());
        row.warnings.extend(penetration.and_then(|found| found.remark()));
        let problem = solved.discretisation().problem();
        let kinds: Vec<_> = problem.values.iter().map(|(_, of)| of.clone()).collect();
        let mut known = Vec::new();
        match (reference, self.where_exact_fails()) {
            (Some(Ok(reference)), _) => {
                row.error = solved.difference(&reference.solved)?;
                row.contact = solved.contact_difference(&reference.solved)?;
                row.against = Some(reference.name.clone());
                known.clone_from(&reference.values);
            }
            (Some(Err(why)), _) => row.warnings.push(format!("{why}: no errors")),
            (None, Some(at)) => row.warnings.push(format!(
                "the exact solution breaks the contact condition of this mesh at {at}: no errors"
            )),
            (None, None) if problem.exact.is_some() => {
                (row.error, row.bound) = solved.errors_and_bound_figures()?;
                row.contact = solved.contact_errors()?;
                row.against = Some("exact".to_owned());
                known = solved.discretisation().exact_values_of(&kinds)?;
            }
            (None, None) => {}
        }
        let is_exact = row.against.as_deref() == Some("exact");
        if !is_exact {
            let with_v = self.where_exact_fails().is_none() && reference.is_some();
            row.bound = solved.bound_figures(row.error.broken_energy, with_v);
        }
        if !kinds.is_empty() {
            set_values(row, &problem.values, &solved.values_of(&kinds)?, &known);
        }
        row.seconds.bound = solved.bound_seconds();
        let remark = row.bound.remark(row.against.as_deref());
        row.warnings.extend(remark.filter(|_| row.converged()));
        row.warnings.extend(self.why_not_exact(solved).filter(|_| is_exact));
        Ok(())
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
}

/// Fills in the values by name, with their errors where those of the solution are known.
fn set_values<const D: usize, W>(
    row: &mut Row,
    wanted: &[(String, W)],
    found: &[FoundValue<D>],
    known: &[Option<f64>],
) {
    for (k, ((name, _), found)) in wanted.iter().zip(found).enumerate() {
        row.values.insert(name.clone(), found.value);
        if let Some(place) = found.place {
            row.values_at.insert(name.clone(), place.as_slice().to_vec());
        }
        if let Some(known) = known.get(k) {
            let error = found.value.zip(*known).map(|(a, b)| (a - b).abs());
            row.error.values.insert(name.clone(), error);
        }
    }
}
