//! The conforming P1 solutions from which all schemes start.

use std::sync::Arc;
use std::time::Instant;

use super::cascade::solve_cascade;
use super::meshes::Meshes;
use super::solved::Solved;
use crate::algebra::{Bound, Contact, Inequality, SparseMatrix, Start, Support};
use crate::assemble::{DataQuadrature, Discretisation};
use crate::constraint::Nodes;
use crate::error::Error;
use crate::inequality::initial_guess::{
    P1_ENERGY_TOLERANCE, contact_of_supports, means_over_supports,
};
use crate::inequality::{InequalitySolver, InitialGuess, Outcome, StepCounter};
use crate::linear::{CoarseLevel, CoarseSpaces, P1Level};
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::ConformingP1;

/// A conforming P1 function from which a solve starts: the solution on the same mesh, or the
/// prolongation of the solution on the next coarser one.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct P1Solution<T> {
    /// The contact state of every vertex.
    pub contact: Vec<Contact>,
    /// The value at every vertex; empty if the solve did not converge.
    pub values: Vec<T>,
    /// The conforming P1 spaces of this and all coarser levels.
    pub coarse_spaces: CoarseSpaces<T>,
    /// Seconds of assembly, solve and prolongation on this level and all coarser ones.
    pub seconds: f64,
    /// Number of levels on which conforming P1 was solved.
    pub levels_solved: usize,
    /// Cycles of monotone multigrid for the start on the coarsest mesh.
    pub start_cycles: usize,
}

impl<T: Real> P1Solution<T> {
    /// A solution from its start, with the matrix of all vertices and those with Dirichlet data. Its seconds
    /// are those of the start.
    fn new<const D: usize>(
        start: Option<&Self>,
        (matrix, fixed): (SparseMatrix<T>, Vec<bool>),
        (outcome, contact, values): (Outcome, Vec<Contact>, Vec<T>),
    ) -> Self {
        // an initial guess need not be right: after a failure it is inactive everywhere
        let (contact, values) = match outcome {
            Outcome::Converged => (contact, values),
            _ => (vec![Contact::Inactive; fixed.len()], Vec::new()),
        };
        // in one dimension factors are as sparse as the matrix: no multigrid is needed
        let coarse_spaces = if D == 1 {
            CoarseSpaces::Unknown
        } else {
            let coarser = start.and_then(|start| match &start.coarse_spaces {
                CoarseSpaces::CoarseLevel(coarser) => Some(coarser.clone()),
                _ => None,
            });
            let level = P1Level::new(matrix, fixed, coarser);
            level.map_or(CoarseSpaces::Unknown, |level| CoarseSpaces::SameMesh(Arc::new(level)))
        };
        let (seconds, levels_solved, start_cycles) =
            start.map_or((0.0, 0, 0), |s| (s.seconds, s.levels_solved, s.start_cycles));
        let levels_solved = levels_solved + 1;
        Self { contact, values, coarse_spaces, seconds, levels_solved, start_cycles }
    }

    /// The starting contact of unknowns: an unknown starts in contact if more than half of the vertices
    /// of its support are in contact.
    pub(super) fn contact_of(&self, supports: &[Support]) -> Vec<Contact> {
        contact_of_supports(supports, &self.contact)
    }

    /// The starting values of unknowns: the means of values over the vertices of each support; none
    /// without values.
    pub(super) fn values_of(&self, supports: &[Support]) -> Option<Vec<T>> {
        (!self.values.is_empty()).then(|| means_over_supports(supports, &self.values))
    }
}

/// Conforming P1 solved by nested iteration: its settings, and the solutions that are known.
pub(super) struct P1Iteration<'a, T: Real, const D: usize> {
    pub problem: &'a Problem<D>,
    pub meshes: Meshes<'a, T, D>,
    pub solver: Arc<dyn InequalitySolver<T> + 'a>,
    pub quadrature: DataQuadrature,
    /// Times are the smallest of this many runs, at least one.
    pub repeat: usize,
    /// Receives the number of each outer step.
    pub steps: StepCounter,
    /// The solution on each mesh, once computed.
    pub solutions: Vec<Option<Arc<P1Solution<T>>>>,
}

impl<T: Real, const D: usize> P1Iteration<'_, T, D> {
    /// The start of conforming P1 on a mesh: the solution on the mesh before, where a new vertex has the
    /// mean of the values at the ends of its edge and is active if both are. On the coarsest mesh, if the
    /// solver uses coarse spaces for so many unknowns: spaces by aggregation, and a solution on them from the
    /// coarsest one up, see [`solve_cascade`]; else `None`.
    pub fn start(&mut self, position: usize) -> Result<Option<Arc<P1Solution<T>>>, Error> {
        if position == 0 {
            let size = self.meshes.mesh(position).vertices().len();
            // in one dimension factors are as sparse as the matrix
            return match D > 1 && self.solver.uses_coarse_spaces(size) {
                true => self.flat_start(position),
                false => Ok(None),
            };
        }
        let coarse = self.solve(position - 1)?;
        let clock = Instant::now();
        let level = match self.meshes.coarser_level(position) {
            Some((coarser, prolongation)) => Some((self.solve(coarser)?, prolongation)),
            None => None,
        };
        let contact = self.meshes.continued(position, &coarse.contact, |one, other| {
            if one == other { one } else { Contact::Inactive }
        });
        let values = match coarse.values.len() == coarse.contact.len() {
            true => {
                let mean = |one, other| T::lit(0.5) * (one + other);
                self.meshes.continued(position, &coarse.values, mean)
            }
            false => Vec::new(),
        };
        let coarse_level = level.and_then(|(level, prolongation)| match &level.coarse_spaces {
            CoarseSpaces::SameMesh(same) => CoarseLevel::new(same.clone(), prolongation.clone()),
            _ => None,
        });
        let coarse_spaces = coarse_level.map_or(CoarseSpaces::Unknown, CoarseSpaces::CoarseLevel);
        let seconds = coarse.seconds + clock.elapsed().as_secs_f64();
        Ok(Some(Arc::new(P1Solution { contact, values, coarse_spaces, seconds, ..*coarse })))
    }

    /// The start on a mesh without coarser ones.
    fn flat_start(&self, position: usize) -> Result<Option<Arc<P1Solution<T>>>, Error> {
        let clock = Instant::now();
        let inequality = self.inequality(position)?;
        let Some(coarser) = CoarseLevel::aggregated(&inequality.matrix, &fixed(&inequality)) else {
            return Ok(None);
        };
        let mut start = P1Solution {
            contact: vec![Contact::Inactive; inequality.size()],
            values: Vec::new(),
            coarse_spaces: CoarseSpaces::CoarseLevel(coarser.clone()),
            seconds: 0.0,
            levels_solved: 0,
            start_cycles: 0,
        };
        if inequality.bounds.iter().any(Bound::is_inequality) {
            let solution = solve_cascade(&inequality, Some(&coarser));
            start.start_cycles = solution.outer;
            // an initial guess need not be right
            if solution.outcome == Outcome::Converged {
                (start.contact, start.values) = (solution.contact, solution.values);
            }
        }
        start.seconds = clock.elapsed().as_secs_f64();
        Ok(Some(Arc::new(start)))
    }

    /// The conforming P1 solution on a mesh, from its start; computed once. The seconds are the smallest
    /// of all runs.
    pub fn solve(&mut self, position: usize) -> Result<Arc<P1Solution<T>>, Error> {
        if let Some(Some(known)) = self.solutions.get(position) {
            return Ok(known.clone());
        }
        let start = self.start(position)?;
        let mut seconds = f64::INFINITY;
        let mut last = None;
        for _ in 0..self.repeat {
            let clock = Instant::now();
            let mut inequality = self.inequality(position)?;
            let guess = InitialGuess::default().steps(self.steps.clone());
            let mut guess = guess.energy_tolerance(P1_ENERGY_TOLERANCE);
            if let Some(start) = &start {
                inequality.start = Start::Contact(start.contact.clone());
                guess =
                    guess.values(start.values.clone()).coarse_spaces(start.coarse_spaces.clone());
            }
            let solution = self.solver.solve_from(&inequality, &guess);
            seconds = seconds.min(clock.elapsed().as_secs_f64());
            last = Some((inequality, solution));
        }
        let Some((inequality, solution)) = last else { unreachable!("at least one run") };
        let clock = Instant::now();
        let fixed = fixed(&inequality);
        let result = (solution.outcome, solution.contact, solution.values);
        let mut solution =
            P1Solution::new::<D>(start.as_deref(), (inequality.matrix, fixed), result);
        solution.seconds += seconds + clock.elapsed().as_secs_f64();
        let solution = Arc::new(solution);
        self.keep(position, solution.clone());
        Ok(solution)
    }

    /// Keeps the solution of a scheme that is conforming P1. Its seconds are those of its start.
    pub fn keep_solved(
        &mut self,
        position: usize,
        start: Option<&P1Solution<T>>,
        solved: &Solved<'_, T, D>,
    ) {
        let (inequality, solution) = (solved.inequality(), solved.solution());
        let level = (inequality.matrix.clone(), fixed(inequality));
        let result = (solution.outcome, solution.contact.clone(), solution.values.clone());
        self.keep(position, Arc::new(P1Solution::new::<D>(start, level, result)));
    }

    /// Keeps a solution; adaptive meshes may have grown since the last one.
    fn keep(&mut self, position: usize, solution: Arc<P1Solution<T>>) {
        if self.solutions.len() <= position {
            self.solutions.resize(position + 1, None);
        }
        self.solutions[position] = Some(solution);
    }

    /// The inequality of conforming P1 on a mesh.
    fn inequality(&self, position: usize) -> Result<Inequality<T>, Error> {
        let mesh = self.meshes.mesh(position);
        // the constraint set of the problem is for the scheme that starts from here
        let problem = self.problem.clone().on(Nodes);
        let discretisation = Discretisation::new(&ConformingP1, &problem, mesh, self.quadrature)?;
        discretisation.inequality()
    }
}

/// The unknowns with Dirichlet data.
fn fixed<T>(inequality: &Inequality<T>) -> Vec<bool> {
    inequality.bounds.iter().map(|b| matches!(b, Bound::Fixed(_))).collect()
}
