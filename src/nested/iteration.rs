//! Nested iteration: one problem on one or several nested meshes, solved by any scheme.

use std::fmt;
use std::sync::Arc;
use std::time::Instant;

use super::adaptive_meshes::AdaptiveMeshes;
use super::hierarchy::Hierarchy;
use super::meshes::{Meshes, unknowns};
use super::p1::{P1Iteration, P1Solution};
use super::phase::Phase;
use super::solved::Solved;
use super::warnings::{active_sets, short_edges};
use crate::algebra::{Contact, Inequality, Start};
use crate::assemble::{DataQuadrature, Discretisation};
use crate::error::Error;
use crate::inequality::{
    ActiveSet, InequalitySolver, InitialGuess, Outcome, Solution, StepCounter, check_definite,
};
use crate::instances::compiled;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::AnyScheme;

/// One problem on nested meshes: the settings of its solves, and the conforming P1 solutions from which
/// they start.
///
/// Conforming P1 starts from its solution on the next coarser mesh, every other scheme from conforming
/// P1 on the same mesh. On a large mesh without coarser ones conforming P1 starts from a rough solution
/// by monotone multigrid with coarse spaces by aggregation. The P1 solutions are kept, so that several
/// schemes on several meshes share them.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let scene = scenes::radial::<2>(1.0);
/// let meshes = Hierarchy::<f64, 2>::of_domain(&scene.domain, 16)?;
/// let mut nested = NestedIteration::new(&scene.problem, &meshes);
/// let p1 = nested.solve(&ConformingP1)?;
/// let sipg = nested.solve(&Sipg::default())?;
/// assert!(p1.difference(&sipg)?.l2 < Some(0.1));
/// # Ok(())
/// # }
/// ```
pub struct NestedIteration<'a, T: Real, const D: usize> {
    pub(super) p1: P1Iteration<'a, T, D>,
    has_cold_start: bool,
    observer: Box<dyn Fn(Phase) + 'a>,
}

impl<T: Real, const D: usize> fmt::Debug for NestedIteration<'_, T, D> {
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

impl<'a, T: Real, const D: usize> NestedIteration<'a, T, D> {
    /// A problem on a mesh or a hierarchy, with the active set method and the usual quadrature.
    #[must_use]
    pub fn new(problem: &'a Problem<D>, meshes: impl Into<Meshes<'a, T, D>>) -> Self {
        let meshes = meshes.into();
        let p1 = P1Iteration {
            problem,
            solutions: vec![None; meshes.len()],
            meshes,
            solver: Arc::new(ActiveSet::default()),
            quadrature: DataQuadrature::default(),
            repeat: 1,
            steps: StepCounter::default(),
        };
        Self { p1, has_cold_start: false, observer: Box::new(|_| {}) }
    }
    /// Sets the solver of the inequality.
    #[must_use]
    pub fn solver(self, solver: impl InequalitySolver<T> + 'a) -> Self {
        self.shared_solver(Arc::new(solver))
    }
    /// Sets a solver of the inequality that others use too, or that was chosen at run time. P1
    /// solutions by another solver are dropped.
    #[must_use]
    pub fn shared_solver(mut self, solver: Arc<dyn InequalitySolver<T> + 'a>) -> Self {
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
        match self.p1.meshes {
            Meshes::Flat(_) | Meshes::Adaptive(_) => None,
            Meshes::Nested(hierarchy) => hierarchy.position(level),
        }
    }
    /// A mesh, by its position.
    pub(crate) fn mesh(&self, position: usize) -> &'a Mesh<T, D> {
        self.p1.meshes.mesh(position)
    }
    /// The meshes, if they are adaptive.
    pub(super) fn adaptive_meshes(&self) -> Option<&'a AdaptiveMeshes<T, D>> {
        match self.p1.meshes {
            Meshes::Adaptive(meshes) => Some(meshes),
            _ => None,
        }
    }
    /// Checks that solutions of a scheme have an error bound.
    ///
    /// # Errors
    /// [`Error::NotAdaptive`] and those of [`Discretisation::new`].
    pub(crate) fn check_bound(&self, scheme: &dyn AnyScheme<T, D>) -> Result<(), Error> {
        let mesh = self.p1.meshes.mesh(self.p1.meshes.len() - 1);
        let of = scheme.discretise(self.p1.problem, mesh, self.p1.quadrature)?;
        of.check_flux().map_err(|why| Error::NotAdaptive {
            scheme: scheme.name().to_owned(),
            why: why.to_string(),
        })
    }
    /// Tells the observer that a phase begins.
    pub(super) fn enter(&self, phase: Phase) {
        (self.observer)(phase);
    }
    /// The name of the solver.
    pub(crate) fn solver_name(&self) -> &'static str {
        self.p1.solver.name()
    }

    /// The conforming P1 solution on a mesh, by its position: zero for the coarsest.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such mesh, and those of assembly.
    pub fn p1_solution(&mut self, position: usize) -> Result<Arc<P1Solution<T>>, Error> {
        self.check_position(position)?;
        compiled!(
            T, D: fn(&mut NestedIteration<'_, T, D>, usize) -> Result<Arc<P1Solution<T>>, Error>
                = |nested, position| nested.p1.solve(position)
        )(self, position)
    }

    /// The solution of a scheme on the finest mesh.
    ///
    /// # Errors
    /// Those of assembly: bad data. A solve that does not converge is no error: see
    /// [`Solved::outcome`].
    pub fn solve(&mut self, scheme: &dyn AnyScheme<T, D>) -> Result<Solved<'a, T, D>, Error> {
        self.solve_on(self.p1.meshes.len() - 1, scheme)
    }

    /// The solution of a scheme on a mesh, by its position: zero for the coarsest.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such mesh, and those of [`NestedIteration::solve`].
    pub fn solve_on(
        &mut self,
        position: usize,
        scheme: &dyn AnyScheme<T, D>,
    ) -> Result<Solved<'a, T, D>, Error> {
        self.check_position(position)?;
        compiled!(
            T, D: for<'n, 'p, 's> fn(
                &'n mut NestedIteration<'p, T, D>,
                usize,
                &'s dyn AnyScheme<T, D>,
            ) -> Result<Solved<'p, T, D>, Error>
                = |nested, position, scheme| nested.solve_scheme(position, scheme, None)
        )(self, position, scheme)
    }

    /// The hierarchy that has the mesh, and its position there.
    pub(super) fn hierarchy(&self, position: usize) -> Option<(&'a Hierarchy<T, D>, usize)> {
        match self.p1.meshes {
            Meshes::Flat(_) | Meshes::Adaptive(_) => None,
            Meshes::Nested(hierarchy) => Some((hierarchy, position)),
        }
    }

    pub(super) fn check_position(&self, position: usize) -> Result<(), Error> {
        match self.p1.meshes.len() {
            n if position < n => Ok(()),
            n => Err(Error::Parameter {
                parameter: "position",
                value: position.to_string(),
                allowed: format!("there are {n} meshes, of which the coarsest has position 0"),
            }),
        }
    }

    /// A scheme on a mesh, and its inequality: [`NestedIteration::repeat`] times, with the smallest time.
    fn assembled(
        &self,
        scheme: &dyn AnyScheme<T, D>,
        mesh: &'a Mesh<T, D>,
    ) -> Result<(Discretisation<'a, T, D>, Inequality<T>, f64), Error> {
        let discretise = || Discretisation::new(scheme, self.p1.problem, mesh, self.p1.quadrature);
        let clock = Instant::now();
        let discretisation = discretise()?;
        let inequality = discretisation.inequality()?;
        let mut seconds = clock.elapsed().as_secs_f64();
        for _ in 1..self.p1.repeat {
            let clock = Instant::now();
            drop(discretise()?.inequality()?);
            seconds = seconds.min(clock.elapsed().as_secs_f64());
        }
        Ok((discretisation, inequality, seconds))
    }

    /// The initial guess from the start, whose contact the inequality takes.
    fn guess(
        &self,
        start: Option<&P1Solution<T>>,
        energy_tolerance: Option<f64>,
        inequality: &mut Inequality<T>,
    ) -> InitialGuess<T> {
        let mut guess = InitialGuess::default().steps(self.p1.steps.clone());
        guess.energy_tolerance = energy_tolerance;
        if let Some(start) = start {
            // a start without contact stays cold: the solver must detect a body that only contact holds
            if start.contact.iter().any(|&c| c != Contact::Inactive) {
                inequality.start = Start::Contact(start.contact_of(&inequality.supports));
            }
            guess.coarse_spaces = start.coarse_spaces.clone();
            guess.values = start.values_of(&inequality.supports);
        }
        guess
    }

    /// The solution on a mesh, to a tolerance on the relative error in the energy norm if there is one.
    pub(super) fn solve_scheme(
        &mut self,
        position: usize,
        scheme: &dyn AnyScheme<T, D>,
        energy_tolerance: Option<f64>,
    ) -> Result<Solved<'a, T, D>, Error> {
        (self.observer)(Phase::Start);
        let start = self.start(position, scheme)?;
        (self.observer)(Phase::Assembly);
        let mesh = self.p1.meshes.mesh(position);
        let (discretisation, mut inequality, assemble_seconds) = self.assembled(scheme, mesh)?;
        let guess = self.guess(start.as_deref(), energy_tolerance, &mut inequality);
        let mut warnings = Vec::new();
        let penalty_below_bound = discretisation.penalty_below_bound();
        warnings.extend(penalty_below_bound.as_ref().map(ToString::to_string));
        let is_adaptive = matches!(self.p1.meshes, Meshes::Adaptive(_));
        if !is_adaptive {
            let theory = discretisation.form().theory();
            let limit = theory.rounding_limit(T::EPSILON, mesh.domain_diameter());
            warnings.extend(short_edges(mesh, limit));
        }
        inequality.is_definite = penalty_below_bound.is_none() && discretisation.is_coercive();
        (self.observer)(Phase::Solve);
        let (solution, solve_seconds) = self.run(&mut inequality, &guess);
        warnings.extend(active_sets(&solution, self.p1.problem, scheme));
        let hierarchy = self.hierarchy(position);
        let mut solved =
            Solved::new(discretisation, inequality, solution, hierarchy, energy_tolerance);
        solved.adaptive = self.adaptive_meshes().map(|meshes| (meshes, position));
        solved.warnings = warnings;
        solved.mesh_seconds = self.p1.meshes.seconds(position);
        (solved.assemble_seconds, solved.solve_seconds) = (assemble_seconds, solve_seconds);
        let is_p1 = scheme.is_conforming_linear(mesh);
        if is_p1 && is_adaptive {
            // every step of an adaptive sequence is solved: the next one starts from here
            self.p1.keep_solved(position, start.as_deref(), &solved);
        }
        if let Some(start) = start {
            // conforming P1 on the same mesh is no coarser level
            let same_mesh = usize::from(!is_p1);
            solved.coarser_levels = start.levels_solved.saturating_sub(same_mesh);
            solved.start_cycles = start.start_cycles;
            solved.start_seconds = start.seconds;
        }
        Ok(solved)
    }

    /// The solution of a scheme on a mesh continued from a less accurate one, to a smaller tolerance or to
    /// the ordinary limits. Iterations and seconds are those of both.
    pub(super) fn continued(
        &mut self,
        solved: Solved<'a, T, D>,
        position: usize,
        scheme: &dyn AnyScheme<T, D>,
        energy_tolerance: Option<f64>,
    ) -> Result<Solved<'a, T, D>, Error> {
        if !solved.has_iterate() {
            return self.solve_scheme(position, scheme, energy_tolerance);
        }
        let start = self.start(position, scheme)?;
        let mut guess = InitialGuess::default().steps(self.p1.steps.clone());
        guess.energy_tolerance = energy_tolerance;
        guess.values = Some(solved.values().to_vec());
        if let Some(start) = &start {
            guess.coarse_spaces = start.coarse_spaces.clone();
        }
        let solved = solved.continued(energy_tolerance, |inequality| self.run(inequality, &guess));
        if scheme.is_conforming_linear(solved.mesh()) {
            self.p1.keep_solved(position, start.as_deref(), &solved);
        }
        Ok(solved)
    }

    /// The start: that of P1 for schemes with its unknowns, P1 on the same mesh for all other schemes.
    fn start(
        &mut self,
        position: usize,
        scheme: &dyn AnyScheme<T, D>,
    ) -> Result<Option<Arc<P1Solution<T>>>, Error> {
        let mesh = self.p1.meshes.mesh(position);
        let unknowns = unknowns(mesh, scheme.layout());
        let needs_none =
            !self.p1.problem.is_constrained() && !self.p1.solver.uses_coarse_spaces(unknowns);
        if self.has_cold_start || needs_none {
            Ok(None)
        } else if scheme.is_conforming_linear(mesh) {
            self.p1.start(position)
        } else {
            self.p1.solve(position).map(Some)
        }
    }

    /// Solves [`NestedIteration::repeat`] times and returns the last solution with the smallest time. A
    /// matrix that is not known to be definite, for instance with a penalty below its proven bound, is
    /// first tested: a solution does not show whether it is. The time includes this test.
    fn run(&self, inequality: &mut Inequality<T>, guess: &InitialGuess<T>) -> (Solution<T>, f64) {
        let clock = Instant::now();
        if !inequality.is_definite {
            match check_definite(inequality) {
                Ok(()) => inequality.is_definite = true,
                // the solver says so itself, where it gets that far
                Err(Outcome::OutOfMemory) => {}
                Err(outcome) => {
                    let solution = Solution::without_iterate(inequality, outcome);
                    return (solution, clock.elapsed().as_secs_f64());
                }
            }
        }
        let in_test = clock.elapsed().as_secs_f64();
        let mut seconds = f64::INFINITY;
        let mut last = None;
        for _ in 0..self.p1.repeat {
            let clock = Instant::now();
            last = Some(self.p1.solver.solve_from(inequality, guess));
            seconds = seconds.min(clock.elapsed().as_secs_f64());
        }
        match last {
            Some(solution) => (solution, in_test + seconds),
            None => unreachable!("at least one run"),
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
/// let mesh = Mesh::<f64, 2>::kuhn_box(&square, [16, 16])?;
/// let membrane = Problem::new().constant_source(-8.0).obstacle_below(|_| -0.2);
/// let u = solve(&membrane, &mesh, &ConformingP1)?;
/// assert!(u.converged() && u.certificate().largest() < 1e-9);
/// assert_eq!(u.value_at(&Point::repeat(0.5)), Some(-0.2));
/// # Ok(())
/// # }
/// ```
///
/// [`NestedIteration`] has the settings: solver, quadrature, number of runs.
///
/// # Errors
/// Those of [`NestedIteration::solve`].
pub fn solve<'a, T: Real, const D: usize>(
    problem: &'a Problem<D>,
    meshes: impl Into<Meshes<'a, T, D>>,
    scheme: &dyn AnyScheme<T, D>,
) -> Result<Solved<'a, T, D>, Error> {
    NestedIteration::new(problem, meshes).solve(scheme)
}
