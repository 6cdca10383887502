//! Nested iteration: one problem on one or several nested meshes, solved by any scheme.

use std::cell::OnceCell;
use std::fmt;
use std::rc::Rc;
use std::sync::Arc;

use super::adaptive_meshes::AdaptiveMeshes;
use super::hierarchy::Hierarchy;
use super::meshes::Meshes;
use super::p1::P1Iteration;
use super::phase::Phase;
use super::solved::Solved;
use super::system::{ByInequality, SystemSolver};
use crate::assemble::DataQuadrature;
use crate::error::Error;
use crate::inequality::{ActiveSet, InequalitySolver, Solution, StepCounter};
use crate::instances::compiled;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::scheme::Scheme;

/// One problem on nested meshes: the settings of its solves, and the conforming P1 solutions from which
/// they start.
///
/// Conforming P1 starts from its solution on the next coarser mesh, every other scheme from conforming
/// P1 on the same mesh. On a large mesh without coarser ones conforming P1 starts from a rough solution
/// by monotone multigrid with coarse spaces by aggregation. The P1 solutions are kept, so that several
/// schemes on several meshes share them.
///
/// On the parts of meshes that several processes share ([`Hierarchy::of_parts`]) it is the same iteration, with a
/// [`SystemSolver`] over processes: all parts call its functions and those of its results.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let scene = scenes::radial::<2>(1.0);
/// let meshes = Hierarchy::<2>::of_domain(&scene.domain, 16)?;
/// let mut nested = NestedIteration::new(&scene.problem, &meshes);
/// let p1 = nested.solve(&ConformingP1)?;
/// let sipg = nested.solve(&Sipg::default())?;
/// assert!(p1.difference(&sipg)?.l2 < Some(0.1));
/// # Ok(())
/// # }
/// ```
pub struct NestedIteration<'a, const D: usize> {
    pub(super) p1: P1Iteration<'a, D>,
    pub(super) has_cold_start: bool,
    /// Whether schemes are solved once more for a history.
    pub(super) keeps_history: bool,
    /// The share of the error bound that the algebraic error of schemes may have; none for solves to rounding.
    pub(super) tolerance: Option<f64>,
    /// The solution of another problem from which schemes with as many unknowns start.
    pub(super) previous: Option<Solution<f64>>,
    observer: Box<dyn Fn(Phase) + 'a>,
}

impl<const D: usize> fmt::Debug for NestedIteration<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("NestedIteration")
            .field("problem", self.p1.problem)
            .field("meshes", &self.p1.meshes.len())
            .field("solver", &self.solver_name())
            .field("quadrature", &self.p1.quadrature)
            .field("repeat", &self.p1.repeat)
            .field("has_cold_start", &self.has_cold_start)
            .finish_non_exhaustive()
    }
}

impl<'a, const D: usize> NestedIteration<'a, D> {
    /// A problem on a mesh or a hierarchy, with the active set method and the usual quadrature.
    #[must_use]
    pub fn new(problem: &'a Problem<D>, meshes: impl Into<Meshes<'a, D>>) -> Self {
        let meshes = meshes.into();
        let p1 = P1Iteration {
            problem,
            solutions: vec![None; meshes.len()],
            meshes,
            solver: Rc::new(ByInequality(Arc::new(ActiveSet::default()))),
            quadrature: DataQuadrature::default(),
            repeat: 1,
            steps: StepCounter::default(),
            constants: OnceCell::new(),
        };
        let observer = Box::new(|_| {});
        Self {
            p1,
            has_cold_start: false,
            keeps_history: false,
            tolerance: None,
            previous: None,
            observer,
        }
    }
    /// Sets the solver of the inequality.
    #[must_use]
    pub fn solver(self, solver: impl InequalitySolver<f64> + 'a) -> Self {
        self.shared_solver(Arc::new(solver))
    }
    /// Sets a solver of the inequality that others use too, or that was chosen at run time. P1
    /// solutions by another solver are dropped.
    #[must_use]
    pub fn shared_solver(self, solver: Arc<dyn InequalitySolver<f64> + 'a>) -> Self {
        self.system_solver(Rc::new(ByInequality(solver)))
    }
    /// Sets a solver that asks for more than the inequality, as one over several processes does. P1
    /// solutions by another solver are dropped.
    #[must_use]
    pub fn system_solver(mut self, solver: Rc<dyn SystemSolver<D> + 'a>) -> Self {
        self.p1.solver = solver;
        self.p1.solutions.fill(None);
        self
    }
    /// Sets the quadrature of data.
    #[must_use]
    pub fn quadrature(mut self, quadrature: DataQuadrature) -> Self {
        self.p1.quadrature = quadrature;
        self.p1.solutions.fill(None);
        self
    }
    /// Makes every time the smallest of this many runs.
    #[must_use]
    pub fn repeat(mut self, times: usize) -> Self {
        self.p1.repeat = times.max(1);
        self
    }
    /// Sets whether schemes start without contact and without coarse spaces.
    #[must_use]
    pub fn cold_start(mut self, has_cold_start: bool) -> Self {
        self.has_cold_start = has_cold_start;
        self
    }

    /// Sets whether solutions have a history ([`Solution::history`]): of one more solve of the scheme on its own mesh, from
    /// the same start, which times of solves do not contain.
    #[must_use]
    pub fn history(mut self, keeps_history: bool) -> Self {
        self.keeps_history = keeps_history;
        self
    }

    /// Makes solves of schemes end where two numbers are at most this share of the [error bound](Solved::bound) without the
    /// term of the solver: the bound on the algebraic error, and that term. This takes the place of the limit of the
    /// certificate, on whole meshes. A solve without an error bound is one to rounding.
    #[must_use]
    pub fn tolerance(mut self, share: f64) -> Self {
        self.tolerance = Some(share);
        self
    }

    /// Sets the solution of a problem before, from whose contact set and values schemes start that have as many
    /// unknowns, such as the last time step. Then conforming P1 is solved only for solvers that use coarse spaces.
    #[must_use]
    pub fn start_from(mut self, previous: &Solution<f64>) -> Self {
        self.previous = Some(previous.clone());
        self
    }

    /// Sets what receives the number of each outer step of a solve, also on coarser levels.
    #[must_use]
    pub fn steps(mut self, steps: StepCounter) -> Self {
        self.p1.steps = steps;
        self
    }

    /// Sets a function that receives each phase of a solve as it begins.
    #[must_use]
    pub fn observer(mut self, observer: impl Fn(Phase) + 'a) -> Self {
        self.observer = Box::new(observer);
        self
    }

    /// Replaces the problem by one with another constraint set. The P1 solutions have bounds at vertices
    /// and are kept.
    pub(crate) fn replace_constraint_set(&mut self, problem: &'a Problem<D>) {
        self.p1.problem = problem;
    }
    /// The position of the mesh of a level, if the meshes are nested and have it.
    pub(crate) fn position(&self, level: usize) -> Option<usize> {
        self.hierarchy()?.position(level)
    }
    /// A mesh, by its position.
    pub(crate) fn mesh(&self, position: usize) -> &'a Mesh<D> {
        self.p1.meshes.mesh(position)
    }
    /// The meshes, if they are uniform refinements.
    pub(super) fn hierarchy(&self) -> Option<&'a Hierarchy<D>> {
        match self.p1.meshes {
            Meshes::Nested(hierarchy) => Some(hierarchy),
            _ => None,
        }
    }
    /// The meshes, if they are adaptive.
    pub(super) fn adaptive_meshes(&self) -> Option<&'a AdaptiveMeshes<D>> {
        match self.p1.meshes {
            Meshes::Adaptive(meshes) => Some(meshes),
            _ => None,
        }
    }
    /// Checks that solutions of a scheme have an error bound.
    ///
    /// # Errors
    /// [`Error::NotAdaptive`] and those of [`Discretisation::new`](crate::assemble::Discretisation::new).
    pub(crate) fn check_bound(&self, scheme: &dyn Scheme<D>) -> Result<(), Error> {
        let mesh = self.p1.meshes.mesh(self.p1.meshes.len() - 1);
        let of = scheme.discretise(self.p1.problem, mesh, self.p1.quadrature)?;
        of.check_flux().map_err(|why| {
            let scheme = scheme.name();
            Error::NotAdaptive(format!("meshes cannot follow the error bound of {scheme}: {why}"))
        })
    }
    /// Calls the observer at the beginning of a phase.
    pub(super) fn enter(&self, phase: Phase) {
        (self.observer)(phase);
    }
    /// The name of the solver.
    pub(crate) fn solver_name(&self) -> &'static str {
        self.p1.solver.name()
    }

    /// The solution of a scheme on the finest mesh.
    ///
    /// # Errors
    /// Those of assembly: bad data. A solve that does not converge is no error: see
    /// [`Solved::outcome`].
    pub fn solve(&mut self, scheme: &dyn Scheme<D>) -> Result<Solved<'a, D>, Error> {
        self.solve_on(self.p1.meshes.len() - 1, scheme)
    }

    /// The solution of a scheme on a mesh, by its position: zero for the coarsest.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such mesh, and those of [`NestedIteration::solve`].
    pub fn solve_on(
        &mut self,
        position: usize,
        scheme: &dyn Scheme<D>,
    ) -> Result<Solved<'a, D>, Error> {
        self.check_position(position)?;
        compiled!(const D: for<'n, 'p, 's> fn(
                &'n mut NestedIteration<'p, D>,
                usize,
                &'s dyn Scheme<D>,
            ) -> Result<Solved<'p, D>, Error>
                = |nested, position, scheme| nested.solve_scheme(position, scheme)
        )(self, position, scheme)
    }

    pub(super) fn check_position(&self, position: usize) -> Result<(), Error> {
        match self.p1.meshes.len() {
            n if position < n => Ok(()),
            n => {
                let allowed = format!("there are {n} meshes, of which the coarsest has position 0");
                Err(Error::parameter("position", position, allowed))
            }
        }
    }
}

/// Solves a problem with a scheme on a mesh, or on the finest mesh of a hierarchy: nested iteration, the
/// active set method, and the certificate of its result.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
/// let mesh = Mesh::<2>::kuhn_box(&square, [16, 16])?;
/// let membrane = Problem::new().constant_source(-8.0).obstacle_below(|_| -0.2);
/// let u = solve(&membrane, &mesh, &ConformingP1)?;
/// assert!(u.converged() && u.certificate().largest() < 1e-9);
/// assert_eq!(u.value_at(&Point::repeat(0.5)), Some(-0.2));
/// # Ok(())
/// # }
/// ```
///
/// The result borrows the problem and the meshes: give both a variable that lives as long. [`NestedIteration`] has the
/// settings: solver, quadrature, number of runs.
///
/// # Errors
/// Those of [`NestedIteration::solve`].
pub fn solve<'a, const D: usize>(
    problem: &'a Problem<D>,
    meshes: impl Into<Meshes<'a, D>>,
    scheme: &dyn Scheme<D>,
) -> Result<Solved<'a, D>, Error> {
    NestedIteration::new(problem, meshes).solve(scheme)
}
