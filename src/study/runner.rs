//! A study: schemes on a scene, level by level.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use super::compatibility::{check_domain, check_fit};
use super::memory::{
    MemoryEstimate, estimate, estimate_without_factors, peak_memory_bytes, unknowns_about,
};
use super::orders::fill_orders;
use super::report::{Program, Report};
use super::row::{Iterations, Row, Seconds};
use crate::assemble::DataQuadrature;
use crate::constraint::ConstraintSet;
use crate::element::Layout;
use crate::error::Error;
#[cfg(feature = "report")]
use crate::error::write_error;
use crate::inequality::{ActiveSet, InequalitySolver};
use crate::instances::compiled;
use crate::mesh::{BoundaryPart, Domain, Mesh};
use crate::nested::{Hierarchy, P1Solution, Solved, Task, solve};
#[cfg(feature = "report")]
use crate::paraview::{CellFields, write_vtu};
use crate::problem::Problem;
use crate::real::Real;
use crate::scenes::Scene;
use crate::scheme::{AnyScheme, ExpectedOrders, Setting};

/// Progress of a study.
#[derive(Debug)]
#[non_exhaustive]
pub enum Progress<'a> {
    /// A run begins: scene, scheme, level.
    Started(&'a str, &'a str, usize),
    /// A run ended.
    Finished(&'a Row),
}

/// Schemes side by side on one scene.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let report = Study::<f64, 2>::new(scenes::radial(1.0))
///     .scheme(ConformingP1)
///     .scheme(Wopsip::default())
///     .levels([4, 8])
///     .run()?;
/// assert_eq!(report.rows.len(), 4);
/// # Ok(())
/// # }
/// ```
pub struct Study<'a, T: Real, const D: usize> {
    scene: Scene<D>,
    entries: Vec<Entry<'a, T, D>>,
    levels: Vec<usize>,
    mesh: Option<Mesh<T, D>>,
    solver: Box<dyn InequalitySolver<T> + 'a>,
    quadrature: DataQuadrature,
    repeat: usize,
    directory: Option<PathBuf>,
    observer: Box<dyn Fn(Progress<'_>) + 'a>,
}

/// A scheme, with its constraint set if that is not the problem's.
struct Entry<'a, T: Real, const D: usize> {
    scheme: Arc<dyn AnyScheme<T, D> + 'a>,
    set: Option<Arc<dyn ConstraintSet>>,
}

impl<T: Real, const D: usize> Entry<'_, T, D> {
    /// The problem with the constraint set of the entry.
    fn problem(&self, problem: &Problem<D>) -> Problem<D> {
        let mut problem = problem.clone();
        problem.constraint_set = self.set.clone().or(problem.constraint_set);
        problem
    }
}

impl<T: Real, const D: usize> fmt::Debug for Study<'_, T, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let schemes: Vec<&str> = self.entries.iter().map(|e| e.scheme.name()).collect();
        f.debug_struct("Study")
            .field("scene", &self.scene.name)
            .field("schemes", &schemes)
            .field("levels", &self.levels)
            .field("solver", &self.solver.name())
            .field("repeat", &self.repeat)
            .finish_non_exhaustive()
    }
}

impl<'a, T: Real, const D: usize> Study<'a, T, D> {
    /// A study of a scene, without schemes or levels yet.
    #[must_use]
    pub fn new(scene: Scene<D>) -> Self {
        Self {
            scene,
            entries: Vec::new(),
            levels: Vec::new(),
            mesh: None,
            solver: Box::new(ActiveSet::default()),
            quadrature: DataQuadrature::default(),
            repeat: 1,
            directory: None,
            observer: Box::new(|_| {}),
        }
    }
    /// Adds a scheme, with the constraint set of the problem.
    #[must_use]
    pub fn scheme(self, scheme: impl AnyScheme<T, D> + 'a) -> Self {
        self.shared_scheme(Arc::new(scheme), None)
    }
    /// Adds a scheme with a constraint set of its own, so that one scheme may stand beside itself with
    /// other bounds.
    #[must_use]
    pub fn scheme_on(
        self,
        scheme: impl AnyScheme<T, D> + 'a,
        set: impl ConstraintSet + 'static,
    ) -> Self {
        self.shared_scheme(Arc::new(scheme), Some(Arc::new(set)))
    }
    /// Adds a scheme chosen at run time, with the constraint set of the problem.
    #[must_use]
    pub fn boxed_scheme(self, scheme: Box<dyn AnyScheme<T, D> + 'a>) -> Self {
        self.shared_scheme(scheme.into(), None)
    }
    /// Adds a scheme chosen at run time, with a constraint set of its own.
    #[must_use]
    pub fn boxed_scheme_on(
        self,
        scheme: Box<dyn AnyScheme<T, D> + 'a>,
        set: impl ConstraintSet + 'static,
    ) -> Self {
        self.shared_scheme(scheme.into(), Some(Arc::new(set)))
    }
    /// Adds a scheme that other studies have too.
    pub(crate) fn shared_scheme(
        mut self,
        scheme: Arc<dyn AnyScheme<T, D> + 'a>,
        set: Option<Arc<dyn ConstraintSet>>,
    ) -> Self {
        self.entries.push(Entry { scheme, set });
        self
    }
    /// Sets the levels: subdivisions of the shortest side, or refinements of a given mesh.
    #[must_use]
    pub fn levels(mut self, levels: impl IntoIterator<Item = usize>) -> Self {
        self.levels = levels.into_iter().collect();
        self
    }
    /// Runs on this mesh and refinements of it instead of the scene's own domain.
    #[must_use]
    pub fn on_mesh(mut self, mesh: Mesh<T, D>) -> Self {
        self.mesh = Some(mesh);
        self
    }
    /// Sets the solver of the inequality.
    #[must_use]
    pub fn solver(mut self, solver: impl InequalitySolver<T> + 'a) -> Self {
        self.solver = Box::new(solver);
        self
    }
    /// Sets the quadrature of data.
    #[must_use]
    pub fn quadrature(mut self, quadrature: DataQuadrature) -> Self {
        self.quadrature = quadrature;
        self
    }
    /// Makes every time the smallest of this many runs.
    #[must_use]
    pub fn repeat(mut self, times: usize) -> Self {
        self.repeat = times.max(1);
        self
    }
    /// Writes the fields of every scheme on the finest level to this directory, as
    /// `SCENE-SCHEME.vtu`; where a scheme stands twice, its constraint set follows its name.
    #[cfg(feature = "report")]
    #[must_use]
    pub fn fields_to(mut self, directory: impl Into<PathBuf>) -> Self {
        self.directory = Some(directory.into());
        self
    }
    /// Sets a function that receives the progress of the study.
    #[must_use]
    pub fn observer(mut self, observer: impl Fn(Progress<'_>) + 'a) -> Self {
        self.observer = Box::new(observer);
        self
    }

    /// Checks schemes, levels and mesh without assembly.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an empty list of levels or schemes or a level of zero,
    /// [`Error::UnfitMesh`], [`Error::Mesh`].
    pub fn check(&self) -> Result<(), Error> {
        compiled!(
            T, D: fn(&Study<'_, T, D>) -> Result<(), Error>
                = |study| study.where_exact_fails().map(|_| ())
        )(self)
    }

    /// Checks schemes, levels and mesh. Returns the point at which the exact solution of the scene
    /// breaks the contact condition of a given mesh.
    fn where_exact_fails(&self) -> Result<Option<String>, Error> {
        let wrong = |parameter, value: &str, allowed: &str| {
            Err(Error::Parameter {
                parameter,
                value: value.to_owned(),
                allowed: allowed.to_owned(),
            })
        };
        if self.entries.is_empty() {
            return wrong("schemes", "none", "a study needs at least one scheme");
        }
        if self.levels.is_empty() {
            return wrong("levels", "none", "a study needs at least one level");
        }
        if self.mesh.is_none() && self.levels.contains(&0) {
            return wrong("level", "0", "a built-in mesh has at least one subdivision");
        }
        let levels = Hierarchy::new(&self.scene.problem, &self.scene.domain, self.mesh.as_ref());
        self.levels.iter().try_for_each(|&level| levels.check_size(level))?;
        match &self.mesh {
            Some(mesh) => check_fit(&self.scene, mesh),
            None => check_domain(&self.scene).map(|()| None),
        }
    }

    /// An estimate of the memory of the largest run, with factors if the solver computes them from
    /// the start; none for a study without schemes or levels.
    pub fn memory_estimate(&self) -> Option<MemoryEstimate> {
        compiled!(
            T, D: fn(&Study<'_, T, D>) -> Option<MemoryEstimate>
                = |study| study.estimate_memory()
        )(self)
    }
    fn estimate_memory(&self) -> Option<MemoryEstimate> {
        let levels = Hierarchy::new(&self.scene.problem, &self.scene.domain, self.mesh.as_ref());
        let level = self.levels.iter().copied().max()?;
        let cells = levels.cells(level);
        let obstacle = self.scene.problem.has_obstacle();
        let bytes = |layout: Layout| {
            let is_iterative =
                self.solver.uses_coarse_spaces(unknowns_about(D, layout, cells) as usize);
            match is_iterative && D > 1 {
                true => estimate_without_factors(D, layout, cells, size_of::<T>()),
                false => estimate(D, layout, cells, obstacle, size_of::<T>()),
            }
        };
        let of = |scheme: &dyn AnyScheme<T, D>| MemoryEstimate {
            bytes: bytes(scheme.layout()),
            scheme: scheme.name().to_owned(),
            level,
        };
        self.entries.iter().map(|e| of(&*e.scheme)).max_by(|a, b| a.bytes.total_cmp(&b.bytes))
    }

    /// Runs every scheme on every level.
    ///
    /// # Errors
    /// Errors of [`Self::check`] and of assembly. A solve that does not converge is no error: its
    /// row has the outcome.
    pub fn run(&self) -> Result<Report, Error> {
        compiled!(
            T, D: fn(&Study<'_, T, D>) -> Result<Report, Error>
                = |study| study.run_all()
        )(self)
    }
    fn run_all(&self) -> Result<Report, Error> {
        let failure = self.where_exact_fails()?;
        let failure = failure.as_deref();
        let mut levels =
            Hierarchy::new(&self.scene.problem, &self.scene.domain, self.mesh.as_ref());
        let finest = self.levels.iter().copied().max();
        let mut rows = Vec::new();
        for entry in &self.entries {
            for &level in &self.levels {
                let name = entry.scheme.name();
                (self.observer)(Progress::Started(&self.scene.name, name, level));
                let with_fields = self.directory.is_some() && Some(level) == finest;
                let (row, _) = self.row(&mut levels, entry, level, failure, with_fields)?;
                (self.observer)(Progress::Finished(&row));
                rows.push(row);
            }
        }
        fill_orders(&mut rows);
        let program = Program::new("study", T::NAME, rayon::current_num_threads(), self.repeat);
        Ok(Report { program, rows })
    }

    /// Runs the first scheme on the first level with a new hierarchy, so that no earlier run
    /// shortens it. Returns the row and the seconds of the start from coarser levels.
    #[cfg(feature = "report")]
    pub(crate) fn run_alone(&self) -> Result<(Row, f64), Error> {
        let failure = self.where_exact_fails()?;
        let (Some(entry), Some(&level)) = (self.entries.first(), self.levels.first()) else {
            unreachable!("checked above")
        };
        let mut levels =
            Hierarchy::new(&self.scene.problem, &self.scene.domain, self.mesh.as_ref());
        self.row(&mut levels, entry, level, failure.as_deref(), false)
    }

    /// Solves one scheme on one level. Returns the row, and the seconds of its start from coarser
    /// levels.
    fn row(
        &self,
        levels: &mut Hierarchy<'_, T, D>,
        entry: &Entry<'_, T, D>,
        level: usize,
        failure: Option<&str>,
        with_fields: bool,
    ) -> Result<(Row, f64), Error> {
        let scheme = &*entry.scheme;
        let problem = entry.problem(&self.scene.problem);
        levels.build(level)?;
        let start = self.start(levels, scheme, level)?;
        let Some((mesh, mesh_seconds)) = levels.mesh(level) else { unreachable!("made above") };
        let task = Task::new(&problem, mesh, &*self.solver)
            .start(start.as_deref())
            .quadrature(self.quadrature)
            .with_errors(failure.is_none())
            .repeat(self.repeat)
            .with_fields(with_fields);
        let solved = solve(scheme, &task)?;
        #[cfg(feature = "report")]
        if let (Some(directory), Some(_)) = (&self.directory, &solved.fields) {
            self.write_fields(directory, entry, mesh, &solved)?;
        }
        let coarser = start.as_ref().map_or(0, |s| s.levels_solved);
        let start_seconds = start.as_ref().map_or(0.0, |s| s.seconds);
        let solve_seconds = solved.solve_seconds + start_seconds;
        let mut row = self.row_of(scheme, level, mesh, solved);
        let set = problem.constraint_set();
        row.constraint = scheme.constraint_on(set).unwrap_or_else(|| set.name().to_owned());
        row.iterations.levels =
            coarser.saturating_sub(usize::from(!scheme.is_conforming_linear(mesh)));
        row.expected_order = self.expected_orders(scheme, set, failure);
        row.warnings.extend(failure.map(|at| {
            format!(
                "the scene's solution breaks the contact condition of this mesh at {at}: no errors"
            )
        }));
        row.seconds = Seconds::new(mesh_seconds, row.seconds.assemble, solve_seconds);
        Ok((row, start_seconds))
    }

    /// The row of a solve by itself, without its start, its mesh's time and expected orders.
    fn row_of(
        &self,
        scheme: &dyn AnyScheme<T, D>,
        level: usize,
        mesh: &Mesh<T, D>,
        solved: Solved,
    ) -> Row {
        Row {
            parameters: solved.parameters,
            solver: self.solver.name().to_owned(),
            linear: solved.linear_solver.to_owned(),
            cells: mesh.n_cells(),
            unknowns: solved.unknowns,
            nonzeros: solved.nonzeros,
            mesh_size: mesh.mesh_size(),
            error: solved.error,
            contact: solved.contact,
            objective: solved.objective,
            active: solved.active,
            iterations: Iterations { outer: solved.outer, linear: solved.linear, levels: 0 },
            certificate: solved.certificate,
            seconds: Seconds::new(0.0, solved.assemble_seconds, solved.solve_seconds),
            peak_memory_bytes: peak_memory_bytes(),
            warnings: solved.warnings,
            ..Row::new(&self.scene.name, D, scheme.name(), level, solved.outcome)
        }
    }

    /// The orders that theory proves; none without an exact solution that holds on the mesh.
    fn expected_orders(
        &self,
        scheme: &dyn AnyScheme<T, D>,
        set: &dyn ConstraintSet,
        failure: Option<&str>,
    ) -> ExpectedOrders {
        match (failure, &self.scene.problem.exact) {
            (None, Some(_)) => scheme.expected_orders_on(set, &self.setting()),
            _ => ExpectedOrders::default(),
        }
    }

    /// The initial guess: P1 on the coarser level for P1, P1 on the same level for all other
    /// schemes.
    fn start(
        &self,
        levels: &mut Hierarchy<'_, T, D>,
        scheme: &dyn AnyScheme<T, D>,
        level: usize,
    ) -> Result<Option<Arc<P1Solution<T>>>, Error> {
        let (solver, quadrature) = (&*self.solver, self.quadrature);
        let Some((mesh, _)) = levels.mesh(level) else { unreachable!("made before") };
        let unknowns = unknowns(mesh, scheme.layout());
        let is_conforming_linear = scheme.is_conforming_linear(mesh);
        if !self.scene.problem.is_constrained() && !solver.uses_coarse_spaces(unknowns) {
            Ok(None)
        } else if is_conforming_linear {
            levels.prolonged_p1_solution(level, solver, quadrature, self.repeat)
        } else {
            levels.p1_solution(level, solver, quadrature, self.repeat).map(Some)
        }
    }

    /// The assumptions of the proofs of orders.
    fn setting(&self) -> Setting {
        let problem = &self.scene.problem;
        let domain = &self.scene.domain;
        let is_convex = !matches!(domain, Domain::LShape { .. });
        let all_dirichlet =
            ![BoundaryPart::Neumann, BoundaryPart::Contact].iter().any(|&p| domain.has_part(p));
        Setting {
            dimension: D,
            obstacle: problem.has_obstacle(),
            contact: problem.gap.is_some(),
            regularity: self.scene.regularity,
            regular_dual: problem.coefficient.is_none()
                && (D == 1 || self.mesh.is_none() && is_convex && all_dirichlet),
        }
    }

    #[cfg(feature = "report")]
    fn write_fields(
        &self,
        directory: &std::path::Path,
        entry: &Entry<'_, T, D>,
        mesh: &Mesh<T, D>,
        solved: &Solved,
    ) -> Result<(), Error> {
        let Some(fields) = &solved.fields else { return Ok(()) };
        std::fs::create_dir_all(directory).map_err(|e| write_error(directory, e))?;
        let name = entry.scheme.name();
        let same_name = self.entries.iter().filter(|e| e.scheme.name() == name).count();
        let set = match &entry.set {
            Some(set) if same_name > 1 => format!("-{}", set.name()),
            _ => String::new(),
        };
        let path = directory.join(format!("{}-{name}{set}.vtu", self.scene.name));
        let constrained = self.scene.problem.is_constrained();
        write_vtu(
            &path,
            mesh,
            &CellFields {
                u: &fields.u,
                obstacle: fields.obstacle.as_deref(),
                multiplier: constrained.then_some(&fields.multiplier[..]),
                contact: &fields.contact,
            },
        )
    }
}

/// Number of unknowns of a layout on a mesh.
fn unknowns<T: Real, const D: usize>(mesh: &Mesh<T, D>, layout: Layout) -> usize {
    let facets = ((D + 1) * mesh.n_cells() + mesh.boundary().len()) / 2;
    let (vertices, cells) = (mesh.vertices().len(), mesh.n_cells());
    // in space by Euler's formula for a ball: near enough elsewhere
    let edges = match D {
        1 => cells,
        2 => facets,
        _ => (vertices + facets).saturating_sub(cells + 1),
    };
    layout.vertex * vertices + layout.edge * edges + layout.facet * facets + layout.cell * cells
}
