//! The conforming P1 solutions from which all schemes start.

use std::cell::OnceCell;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

use super::cascade::solve_cascade;
use super::meshes::Meshes;
use super::solved::Solved;
use super::system::{MeshOfSystem, System, SystemSolver};
use crate::algebra::{Bound, Contact, DofLocation, Inequality, SparseMatrix, Start};
use crate::assemble::DataQuadrature;
use crate::constraint::Nodes;
use crate::error::Error;
use crate::inequality::{InitialGuess, Outcome, StepCounter};
use crate::linear::{CoarseLevel, CoarseSpaces, P1Level};
use crate::parallel::vectors::collect;
use crate::problem::{BodyConstants, Problem};
use crate::scheme::ConformingP1;

/// Relative tolerance in the energy norm for iterative solvers if the solution is only the start of another solve: below
/// the discretisation error of all meshes that fit into memory.
const ENERGY_TOLERANCE: f64 = 1e-4;

/// A conforming P1 function from which a solve starts: the solution on the same mesh, or the
/// prolongation of the solution on the next coarser one.
#[derive(Clone, Debug)]
pub(super) struct P1Solution {
    /// The contact state of every vertex.
    pub contact: Vec<Contact>,
    /// The value at every vertex; empty if the solve did not converge.
    pub values: Vec<f64>,
    /// The conforming P1 spaces of this and all coarser levels.
    pub coarse_spaces: CoarseSpaces<f64>,
    /// Seconds of assembly, solve and prolongation on this level and all coarser ones.
    pub seconds: f64,
    /// Number of levels on which conforming P1 was solved.
    pub levels_solved: usize,
    /// Cycles of monotone multigrid for the start on the coarsest mesh.
    pub start_cycles: usize,
}

impl P1Solution {
    /// A solution from its start, with the matrix of all vertices, unless multigrid does not use it, and those with
    /// Dirichlet data. Its seconds are those of the start.
    fn new(
        start: Option<&Self>,
        (matrix, fixed): (Option<SparseMatrix<f64>>, Vec<bool>),
        (outcome, contact, values): (Outcome, Vec<Contact>, Vec<f64>),
    ) -> Self {
        // an initial guess need not be right: after a failure it is inactive everywhere
        let (contact, values) = match outcome {
            Outcome::Converged => (contact, values),
            _ => (vec![Contact::Inactive; fixed.len()], Vec::new()),
        };
        let coarser = start.and_then(|start| match &start.coarse_spaces {
            CoarseSpaces::CoarseLevel(coarser) => Some(coarser.clone()),
            _ => None,
        });
        let level = matrix.and_then(|matrix| P1Level::new(matrix, fixed, coarser));
        let coarse_spaces =
            level.map_or(CoarseSpaces::Unknown, |level| CoarseSpaces::SameMesh(Arc::new(level)));
        let (seconds, levels_solved, start_cycles) =
            start.map_or((0.0, 0, 0), |s| (s.seconds, s.levels_solved, s.start_cycles));
        let levels_solved = levels_solved + 1;
        Self { contact, values, coarse_spaces, seconds, levels_solved, start_cycles }
    }

    /// The starting contact of unknowns: a bound is active at an unknown if it is active at more than half of the
    /// vertices of its location.
    pub(super) fn contact_of(&self, locations: &[DofLocation]) -> Vec<Contact> {
        collect(locations.len(), |i| {
            let vertices = locations[i].vertices();
            let has_most = |side: &Contact| {
                let on = vertices.iter().filter(|&&v| self.contact[v as usize] == *side).count();
                2 * on > vertices.len()
            };
            [Contact::Lower, Contact::Upper].into_iter().find(has_most).unwrap_or_default()
        })
    }

    /// The starting values of unknowns: the means of values over the vertices of each location; none
    /// without values.
    pub(super) fn values_of(&self, locations: &[DofLocation]) -> Option<Vec<f64>> {
        let mean = |i: usize| {
            let vertices = locations[i].vertices();
            let sum = vertices.iter().fold(0.0, |sum, &v| sum + self.values[v as usize]);
            sum / vertices.len().max(1) as f64
        };
        (!self.values.is_empty()).then(|| collect(locations.len(), mean))
    }
}

/// Conforming P1 solved by nested iteration: its settings, and the solutions that are known.
pub(super) struct P1Iteration<'a, const D: usize> {
    pub problem: &'a Problem<D>,
    pub meshes: Meshes<'a, D>,
    pub solver: Rc<dyn SystemSolver<D> + 'a>,
    pub quadrature: DataQuadrature,
    /// Times are the smallest of this many runs, at least one.
    pub repeat: usize,
    /// Receives the number of each outer step.
    pub steps: StepCounter,
    /// The constants of bodies on the coarsest mesh, once computed.
    pub constants: OnceCell<Arc<BodyConstants>>,
    /// The solution on each mesh, once computed.
    pub solutions: Vec<Option<Arc<P1Solution>>>,
}

impl<'a, const D: usize> P1Iteration<'a, D> {
    /// The start of conforming P1 on a mesh: the solution on the mesh before, where a new vertex has the
    /// mean of the values at the ends of its edge and is active if both are. On the coarsest mesh, if the
    /// solver uses coarse spaces for so many unknowns: spaces by aggregation, and a solution on them from the
    /// coarsest one up, see [`solve_cascade`]; else `None`.
    pub fn start(&mut self, position: usize) -> Result<Option<Arc<P1Solution>>, Error> {
        if position == 0 {
            let size = self.meshes.mesh(position).vertices().len();
            // in one dimension factors are as sparse as the matrix
            return match D > 1 && self.solver.uses_coarse_spaces(size) {
                true => self.flat_start(),
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
                let mean = |one, other| 0.5 * (one + other);
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

    /// The start on the coarsest mesh.
    fn flat_start(&self) -> Result<Option<Arc<P1Solution>>, Error> {
        let clock = Instant::now();
        let problem = self.problem_at_vertices();
        let System { inequality, .. } = System::new(&ConformingP1, &problem, self.place(0)?)?;
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

    /// The last of [`repeat`](Self::repeat) results, and the seconds of the fastest.
    pub fn repeated<V>(&self, run: impl Fn() -> Result<V, Error>) -> Result<(V, f64), Error> {
        let timed = || {
            let clock = Instant::now();
            let found = run()?;
            Ok::<_, Error>((found, clock.elapsed().as_secs_f64()))
        };
        let (mut found, mut seconds) = timed()?;
        for _ in 1..self.repeat {
            let (again, time) = timed()?;
            (found, seconds) = (again, seconds.min(time));
        }
        Ok((found, seconds))
    }

    /// The conforming P1 solution on a mesh, from its start; computed once.
    pub fn solve(&mut self, position: usize) -> Result<Arc<P1Solution>, Error> {
        if let Some(Some(known)) = self.solutions.get(position) {
            return Ok(known.clone());
        }
        let start = self.start(position)?;
        let problem = self.problem_at_vertices();
        let ((inequality, solution), seconds) = self.repeated(|| {
            let mut system = System::new(&ConformingP1, &problem, self.place(position)?)?;
            let guess = InitialGuess::default().steps(self.steps.clone());
            let mut guess = guess.energy_tolerance(ENERGY_TOLERANCE);
            if let Some(start) = &start {
                system.inequality.start = Start::Contact(start.contact.clone());
                guess =
                    guess.values(start.values.clone()).coarse_spaces(start.coarse_spaces.clone());
            }
            let solution = self.solver.solve(&system, &guess)?;
            Ok((system.inequality, solution))
        })?;
        let clock = Instant::now();
        let fixed = fixed(&inequality);
        let alone = inequality.kinks.iter().filter(|kink| kink.own == Bound::Free);
        let at_kinks: Vec<usize> = alone.map(|kink| kink.unknown as usize).collect();
        let matrix = has_levels::<D>(&inequality).then_some(inequality.matrix);
        let mut result = (solution.outcome, solution.contact, solution.values);
        // a start has the same state on both sides of a kink
        for i in at_kinks {
            if result.1[i] == Contact::Upper {
                result.1[i] = Contact::Lower;
            }
        }
        let mut solution = P1Solution::new(start.as_deref(), (matrix, fixed), result);
        solution.seconds += seconds + clock.elapsed().as_secs_f64();
        let solution = Arc::new(solution);
        self.keep(position, solution.clone());
        Ok(solution)
    }

    /// Keeps the solution of a scheme that is conforming P1. Its seconds are those of its start.
    pub fn keep_solved(
        &mut self,
        position: usize,
        start: Option<&P1Solution>,
        solved: &Solved<'_, D>,
    ) {
        let (inequality, solution) = (solved.inequality(), solved.solution());
        let matrix = has_levels::<D>(inequality).then(|| inequality.matrix.clone());
        let result = (solution.outcome, solution.contact.clone(), solution.values.clone());
        let level = (matrix, fixed(inequality));
        self.keep(position, Arc::new(P1Solution::new(start, level, result)));
    }

    /// Keeps a solution; adaptive meshes may have grown since the last one.
    fn keep(&mut self, position: usize, solution: Arc<P1Solution>) {
        if self.solutions.len() <= position {
            self.solutions.resize(position + 1, None);
        }
        self.solutions[position] = Some(solution);
    }

    /// The problem with bounds at vertices: its own constraint set is for the scheme that starts from here.
    fn problem_at_vertices(&self) -> Problem<D> {
        self.problem.clone().on(Nodes)
    }

    /// A mesh, by its position, with the quadrature of data.
    ///
    /// # Errors
    /// Those of data on the coarsest mesh.
    pub fn place(&self, position: usize) -> Result<MeshOfSystem<'a, D>, Error> {
        let mesh = self.meshes.mesh(position);
        let of_coarsest = match self.constants.get() {
            Some(known) => known,
            None => {
                let found = BodyConstants::of(self.problem, self.meshes.mesh(0))?;
                self.constants.get_or_init(|| Arc::new(found))
            }
        };
        Ok(MeshOfSystem {
            mesh,
            shared: self.meshes.shared_part(position),
            quadrature: self.quadrature,
            constants: match position {
                0 => of_coarsest.clone(),
                _ => Arc::new(of_coarsest.on(mesh)),
            },
        })
    }
}

/// Whether multigrid uses the levels of conforming P1: in one dimension factors are as sparse as the matrix, and over
/// parts of a mesh the multigrid is that of an engine.
fn has_levels<const D: usize>(inequality: &Inequality<f64>) -> bool {
    D > 1 && !inequality.is_in_parts()
}

/// The unknowns with Dirichlet data.
fn fixed(inequality: &Inequality<f64>) -> Vec<bool> {
    inequality.bounds.iter().map(|b| matches!(b, Bound::Fixed(_))).collect()
}
