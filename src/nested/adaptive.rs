//! Adaptive refinement: solve, bound the error, mark, bisect.

use std::fmt;
use std::time::Instant;

use super::adaptive_meshes::AdaptiveMeshes;
use super::adaptivity::{Adaptivity, Stop};
use super::iteration::NestedIteration;
use super::meshes::unknowns;
use super::phase::Phase;
use super::solved::Solved;
use crate::error::Error;
use crate::error_bound::ErrorBound;
use crate::instances::compiled;
use crate::mesh::MeshErrorKind;
use crate::problem::Problem;
use crate::scheme::Scheme;

/// A step of adaptive refinement: the solution on one mesh of the sequence.
#[derive(Debug)]
#[non_exhaustive]
pub struct AdaptiveStep<'a, const D: usize> {
    /// Number of refinements, and position of the mesh.
    pub number: usize,
    /// The solution; [`Solved::bound`] has its bound.
    pub solved: Solved<'a, D>,
    /// Why this step is the last one; none if another follows.
    pub stop: Option<Stop>,
    /// Seconds of assembly, of solves with their starts, and of bounds with marking, of this step and all
    /// before.
    pub(crate) assemble_seconds: f64,
    pub(crate) solve_seconds: f64,
    pub(crate) bound_seconds: f64,
}

impl<const D: usize> AdaptiveStep<'_, D> {
    /// Seconds of this step and all before: meshes, assembly, solves, bounds.
    pub fn seconds(&self) -> f64 {
        let mesh = self.solved.mesh_seconds;
        mesh + self.assemble_seconds + self.solve_seconds + self.bound_seconds
    }
}

/// Adaptive refinement of the mesh of one problem for one scheme, as an iterator over its steps. Each step
/// solves on the finest mesh, bounds the error, marks the cells with the largest shares
/// ([`ErrorBound::marked`](crate::error_bound::ErrorBound::marked)) and bisects them.
///
/// Conforming P1 starts each step from its solution on the mesh before, with values and contact carried to
/// new vertices; every other scheme from conforming P1 on the same mesh.
pub struct AdaptiveIteration<'a, const D: usize> {
    nested: NestedIteration<'a, D>,
    meshes: &'a AdaptiveMeshes<D>,
    scheme: &'a dyn Scheme<D>,
    adaptivity: Adaptivity,
    /// The position of the next step; none after the last one.
    next: Option<usize>,
    assemble_seconds: f64,
    solve_seconds: f64,
    bound_seconds: f64,
}

impl<const D: usize> fmt::Debug for AdaptiveIteration<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AdaptiveIteration")
            .field("scheme", &self.scheme.name())
            .field("adaptivity", &self.adaptivity)
            .field("next", &self.next)
            .finish_non_exhaustive()
    }
}

/// Solves a problem with a scheme on meshes that follow the error bound, from the finest mesh of the sequence
/// on: an iterator over the steps. After an error, one of bad data, there is no further step.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
/// let membrane = Problem::new().constant_source(-8.0).obstacle_below(|_| -0.2);
/// let meshes = AdaptiveMeshes::new(Mesh::<2>::kuhn_box(&square, [4, 4])?);
/// let sipg = Sipg::default();
/// let steps = adapt(&membrane, &meshes, &sipg, Adaptivity::to_bound(0.5))?;
/// let steps = steps.collect::<Result<Vec<_>, _>>()?;
/// let last = steps.last().unwrap();
/// assert_eq!(last.stop, Some(Stop::Goal));
/// assert!(last.solved.bound().unwrap().discrete <= 0.5);
/// # Ok(())
/// # }
/// ```
///
/// [`AdaptiveIteration::new`] takes the settings of [`NestedIteration`] besides.
///
/// # Errors
/// Those of [`AdaptiveIteration::new`].
pub fn adapt<'a, const D: usize>(
    problem: &'a Problem<D>,
    meshes: &'a AdaptiveMeshes<D>,
    scheme: &'a dyn Scheme<D>,
    adaptivity: Adaptivity,
) -> Result<AdaptiveIteration<'a, D>, Error> {
    AdaptiveIteration::new(NestedIteration::new(problem, meshes), scheme, adaptivity)
}

impl<'a, const D: usize> AdaptiveIteration<'a, D> {
    /// The refinement for a scheme, with the settings of a nested iteration on [`AdaptiveMeshes`], from their
    /// finest mesh on.
    ///
    /// # Errors
    /// [`Error::Parameter`] for other meshes and for settings out of range, [`Error::NotAdaptive`] for a scheme
    /// without a bound.
    pub fn new(
        nested: NestedIteration<'a, D>,
        scheme: &'a dyn Scheme<D>,
        adaptivity: Adaptivity,
    ) -> Result<Self, Error> {
        adaptivity.check()?;
        let Some(meshes) = nested.adaptive_meshes() else {
            let allowed = "adaptive refinement takes AdaptiveMeshes";
            return Err(Error::parameter("meshes", "uniform", allowed));
        };
        // other errors are those of the first step
        if let Err(error @ Error::NotAdaptive(_)) = nested.check_bound(scheme) {
            return Err(error);
        }
        Ok(Self {
            nested,
            meshes,
            scheme,
            adaptivity,
            next: Some(meshes.n_meshes() - 1),
            assemble_seconds: 0.0,
            solve_seconds: 0.0,
            bound_seconds: 0.0,
        })
    }

    fn step(&mut self, number: usize) -> Result<AdaptiveStep<'a, D>, Error> {
        let mut solved = self.nested.solve_scheme(number, self.scheme)?;
        self.assemble_seconds += solved.system().assemble_seconds;
        let bound = self.bound(&solved);
        let stop = self.stop(number, &solved, bound.as_ref())?;
        self.solve_seconds += solved.solve_seconds;
        if let (Some(stop), Some(goal), Some(bound)) = (stop, self.adaptivity.goal, &bound)
            && bound.discrete > goal
        {
            let why =
                format!("the bound {:.2e} is above the goal {goal:?}: {stop}", bound.discrete);
            solved.warnings.push(why);
        }
        if stop == Some(Stop::NoBound)
            && let Err(why) = solved.bound()
        {
            solved
                .warnings
                .push(format!("no cells are marked without a bound on the error: {why}"));
        }
        self.next = stop.is_none().then_some(number + 1);
        Ok(AdaptiveStep {
            number,
            stop,
            assemble_seconds: self.assemble_seconds,
            solve_seconds: self.solve_seconds + solved.start_seconds,
            bound_seconds: self.bound_seconds,
            solved,
        })
    }

    /// The bound of a solution.
    fn bound(&mut self, solved: &Solved<'a, D>) -> Option<ErrorBound> {
        self.nested.enter(Phase::Bound);
        let bound = solved.bound().ok();
        self.bound_seconds += solved.bound_seconds().unwrap_or(0.0);
        bound
    }

    /// Adds the next mesh, or says why this one is the last.
    fn stop(
        &mut self,
        number: usize,
        solved: &Solved<'a, D>,
        bound: Option<&ErrorBound>,
    ) -> Result<Option<Stop>, Error> {
        if !solved.converged() {
            return Ok(Some(Stop::NotConverged));
        }
        let Some(bound) = bound else { return Ok(Some(Stop::NoBound)) };
        if self.adaptivity.goal.is_some_and(|goal| bound.discrete <= goal) {
            return Ok(Some(Stop::Goal));
        }
        let clock = Instant::now();
        let marked = bound.marked(self.adaptivity.theta);
        self.bound_seconds += clock.elapsed().as_secs_f64();
        match marked.is_empty() {
            true => Ok(Some(Stop::Exact)),
            false if number >= self.adaptivity.steps => Ok(Some(Stop::Steps)),
            false => self.refine(&marked),
        }
    }

    /// Adds the next mesh, or says why there is none.
    fn refine(&self, marked: &[usize]) -> Result<Option<Stop>, Error> {
        self.nested.enter(Phase::Mesh);
        let next = match self.meshes.bisected(marked) {
            Ok(next) => next,
            Err(Error::Mesh(why))
                if matches!(
                    why.kind,
                    MeshErrorKind::TooSmallToBisect | MeshErrorKind::TooLarge
                ) =>
            {
                return Ok(Some(Stop::Rounding));
            }
            Err(error) => return Err(error),
        };
        if unknowns(&next.mesh, self.scheme.layout()) > self.adaptivity.unknowns {
            return Ok(Some(Stop::Unknowns));
        }
        self.meshes.add(next).map(|()| None)
    }
}

impl<'a, const D: usize> Iterator for AdaptiveIteration<'a, D> {
    type Item = Result<AdaptiveStep<'a, D>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let number = self.next.take()?;
        let step = compiled!(const D: for<'n, 'p> fn(
                &'n mut AdaptiveIteration<'p, D>,
                usize,
            ) -> Result<AdaptiveStep<'p, D>, Error>
                = |iteration, number| iteration.step(number)
        );
        Some(step(self, number))
    }
}
