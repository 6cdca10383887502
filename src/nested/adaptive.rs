//! Adaptive refinement: solve, bound the error, mark, bisect.

use std::fmt;
use std::time::Instant;

use super::adaptive_meshes::AdaptiveMeshes;
use super::iteration::{NestedIteration, Phase, unknowns};
use super::solved::Solved;
use crate::error::Error;
use crate::instances::compiled;
use crate::mesh::MeshError;
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::AnyScheme;

/// How far meshes follow an error bound.
///
/// ```
/// use unilateral::prelude::*;
/// let to_one_percent = Adaptivity::to_bound(1e-2).unknowns(100_000);
/// assert_eq!(to_one_percent.theta, 0.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Adaptivity {
    /// The share of the square of the bound that the marked cells have, above zero and at most one.
    pub theta: f64,
    /// The bound, absolute and in the energy norm, that ends the refinement.
    pub goal: Option<f64>,
    /// Most refinements.
    pub steps: usize,
    /// Most unknowns; the first mesh may have more.
    pub unknowns: usize,
}

impl Default for Adaptivity {
    /// A share of a half, no goal, at most 20 refinements and a million unknowns.
    fn default() -> Self {
        Self { theta: 0.5, goal: None, steps: 20, unknowns: 1_000_000 }
    }
}

impl Adaptivity {
    /// Refinement until the bound is at most `goal`.
    #[must_use]
    pub fn to_bound(goal: f64) -> Self {
        Self::default().goal(goal)
    }
    /// Sets the bound that ends the refinement.
    #[must_use]
    pub fn goal(self, goal: f64) -> Self {
        Self { goal: Some(goal), ..self }
    }
    /// Sets the share of the marked cells.
    #[must_use]
    pub fn theta(self, theta: f64) -> Self {
        Self { theta, ..self }
    }
    /// Sets the largest number of refinements.
    #[must_use]
    pub fn steps(self, steps: usize) -> Self {
        Self { steps, ..self }
    }
    /// Sets the largest number of unknowns.
    #[must_use]
    pub fn unknowns(self, unknowns: usize) -> Self {
        Self { unknowns, ..self }
    }
    /// Checks share and goal.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        let refuse = |parameter, value: f64, allowed: &str| {
            let (value, allowed) = (format!("{value:?}"), allowed.to_owned());
            Err(Error::Parameter { parameter, value, allowed })
        };
        if !(self.theta > 0.0 && self.theta <= 1.0) {
            return refuse("theta", self.theta, "the share of marked cells is in (0, 1]");
        }
        match self.goal {
            Some(goal) if !(goal > 0.0 && goal.is_finite()) => {
                refuse("goal", goal, "a bound is positive and finite")
            }
            _ => Ok(()),
        }
    }
}

/// Why no finer mesh follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stop {
    /// The bound is at most the goal.
    Goal,
    /// As many refinements as allowed.
    Steps,
    /// The next mesh would have more unknowns than allowed.
    Unknowns,
    /// No cell has a share of the bound: it is zero, or what the solver left.
    Exact,
    /// The solve did not converge.
    NotConverged,
    /// The solution has no bound.
    NoBound,
    /// Marked cells are at the size of rounding, or more than can be numbered.
    Rounding,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Goal => "the bound is at most the goal",
            Self::Steps => "the number of refinements is the largest allowed",
            Self::Unknowns => "the next mesh has more unknowns than allowed",
            Self::Exact => "no cell has a share of the bound",
            Self::NotConverged => "the solve did not converge",
            Self::NoBound => "there is no bound",
            Self::Rounding => "marked cells are at the size of rounding",
        })
    }
}

/// A step of adaptive refinement: the solution on one mesh of the sequence.
#[derive(Debug)]
#[non_exhaustive]
pub struct AdaptiveStep<'a, T: Real, const D: usize> {
    /// Number of refinements, and position of the mesh.
    pub number: usize,
    /// The solution; [`Solved::bound`] has its bound.
    pub solved: Solved<'a, T, D>,
    /// Why this step is the last one; none if another follows.
    pub stop: Option<Stop>,
    /// Seconds of assembly, of solves with their starts, and of bounds with marking, of this step and all
    /// before.
    pub(crate) assemble_seconds: f64,
    pub(crate) solve_seconds: f64,
    pub(crate) bound_seconds: f64,
}

impl<T: Real, const D: usize> AdaptiveStep<'_, T, D> {
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
pub struct AdaptiveIteration<'a, T: Real, const D: usize> {
    nested: NestedIteration<'a, T, D>,
    meshes: &'a AdaptiveMeshes<T, D>,
    scheme: &'a dyn AnyScheme<T, D>,
    adaptivity: Adaptivity,
    /// The position of the next step; none after the last one.
    next: Option<usize>,
    assemble_seconds: f64,
    solve_seconds: f64,
    bound_seconds: f64,
}

impl<T: Real, const D: usize> fmt::Debug for AdaptiveIteration<'_, T, D> {
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
/// let meshes = AdaptiveMeshes::new(Mesh::<f64, 2>::kuhn_box(&square, [4, 4])?);
/// let steps: Vec<_> = adapt(&membrane, &meshes, &Sipg::default(), Adaptivity::to_bound(0.5))?
///     .collect::<Result<_, _>>()?;
/// let last = steps.last().unwrap();
/// assert_eq!(last.stop, Some(Stop::Goal));
/// assert!(last.solved.bound().unwrap().total <= 0.5);
/// # Ok(())
/// # }
/// ```
///
/// [`AdaptiveIteration::new`] takes the settings of [`NestedIteration`] besides.
///
/// # Errors
/// Those of [`AdaptiveIteration::new`].
pub fn adapt<'a, T: Real, const D: usize>(
    problem: &'a Problem<D>,
    meshes: &'a AdaptiveMeshes<T, D>,
    scheme: &'a dyn AnyScheme<T, D>,
    adaptivity: Adaptivity,
) -> Result<AdaptiveIteration<'a, T, D>, Error> {
    AdaptiveIteration::new(NestedIteration::new(problem, meshes), scheme, adaptivity)
}

impl<'a, T: Real, const D: usize> AdaptiveIteration<'a, T, D> {
    /// The refinement for a scheme, with the settings of a nested iteration on [`AdaptiveMeshes`], from their
    /// finest mesh on.
    ///
    /// # Errors
    /// [`Error::Parameter`] for other meshes and for settings out of range, [`Error::NotAdaptive`] for a scheme
    /// without a bound.
    pub fn new(
        nested: NestedIteration<'a, T, D>,
        scheme: &'a dyn AnyScheme<T, D>,
        adaptivity: Adaptivity,
    ) -> Result<Self, Error> {
        adaptivity.check()?;
        let Some(meshes) = nested.adaptive_meshes() else {
            return Err(Error::Parameter {
                parameter: "meshes",
                value: "uniform".to_owned(),
                allowed: "adaptive refinement takes AdaptiveMeshes".to_owned(),
            });
        };
        // other errors are those of the first step
        if let Err(error @ Error::NotAdaptive { .. }) = nested.check_bound(scheme) {
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

    fn step(&mut self, number: usize) -> Result<AdaptiveStep<'a, T, D>, Error> {
        let mut solved = self.nested.solve_on(number, self.scheme)?;
        self.nested.enter(Phase::Bound);
        self.assemble_seconds += solved.assemble_seconds;
        self.solve_seconds += solved.solve_seconds;
        let clock = Instant::now();
        let bound = solved.bound().ok();
        let marked = bound.as_ref().map(|bound| bound.marked(self.adaptivity.theta));
        self.bound_seconds += clock.elapsed().as_secs_f64();
        let goal = self.adaptivity.goal.unwrap_or(f64::NEG_INFINITY);
        let stop = match (&bound, marked) {
            _ if !solved.converged() => Some(Stop::NotConverged),
            (Some(bound), Some(marked)) => match bound.total {
                total if total <= goal => Some(Stop::Goal),
                _ if marked.is_empty() => Some(Stop::Exact),
                _ if number >= self.adaptivity.steps => Some(Stop::Steps),
                _ => self.refine(&marked)?,
            },
            _ => Some(Stop::NoBound),
        };
        if let (Some(stop), Some(goal), Some(bound)) = (stop, self.adaptivity.goal, &bound)
            && bound.total > goal
        {
            let why = format!("the bound {:.2e} is above the goal {goal:?}: {stop}", bound.total);
            solved.warnings.push(why);
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

    /// Adds the next mesh, or says why there is none.
    fn refine(&self, marked: &[usize]) -> Result<Option<Stop>, Error> {
        self.nested.enter(Phase::Mesh);
        let next = match self.meshes.bisected(marked) {
            Ok(next) => next,
            Err(Error::Mesh(MeshError::TooSmallToBisect { .. } | MeshError::TooLarge { .. })) => {
                return Ok(Some(Stop::Rounding));
            }
            Err(error) => return Err(error),
        };
        if unknowns(next.mesh(), self.scheme.layout()) > self.adaptivity.unknowns {
            return Ok(Some(Stop::Unknowns));
        }
        self.meshes.add(next).map(|()| None)
    }
}

impl<'a, T: Real, const D: usize> Iterator for AdaptiveIteration<'a, T, D> {
    type Item = Result<AdaptiveStep<'a, T, D>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let number = self.next.take()?;
        let step = compiled!(
            T, D: for<'n, 'p> fn(
                &'n mut AdaptiveIteration<'p, T, D>,
                usize,
            ) -> Result<AdaptiveStep<'p, T, D>, Error>
                = |iteration, number| iteration.step(number)
        );
        Some(step(self, number))
    }
}
