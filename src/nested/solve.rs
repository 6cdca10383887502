//! One solve: a scheme on a mesh, from assembly to certificate and errors.

use std::fmt;
use std::time::Instant;

use super::hierarchy::P1Solution;
use crate::algebra::{Bound, Contact, Inequality, Start, Support};
use crate::assemble::DataQuadrature;
use crate::error::Error;
use crate::facet::PenaltyParameters;
use crate::inequality::{
    Certificate, InequalitySolver, InitialGuess, Outcome, Solution, certify_with_jump_multipliers,
};
use crate::instances::compiled;
use crate::linear::is_positive_definite;
use crate::measure::{ContactErrors, Errors, Fields};
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::AnyScheme;

/// The input of [`solve`]: data, mesh, start and settings.
#[non_exhaustive]
pub struct Task<'a, T: Real, const D: usize> {
    /// The data.
    pub problem: &'a Problem<D>,
    /// The mesh.
    pub mesh: &'a Mesh<T, D>,
    /// Contact and value of every vertex to start from; none for a cold start.
    pub start: Option<&'a P1Solution<T>>,
    /// The solver.
    pub solver: &'a dyn InequalitySolver<T>,
    /// Quadrature of data.
    pub quadrature: DataQuadrature,
    /// Whether the exact solution holds on this mesh, so that errors mean something.
    pub with_errors: bool,
    /// Times are the smallest of this many runs.
    pub repeat: usize,
    /// Whether fields for pictures are wanted.
    pub with_fields: bool,
}

impl<'a, T: Real, const D: usize> Task<'a, T, D> {
    /// One run from a cold start, by the usual quadrature, without errors and fields.
    #[must_use]
    pub fn new(
        problem: &'a Problem<D>,
        mesh: &'a Mesh<T, D>,
        solver: &'a dyn InequalitySolver<T>,
    ) -> Self {
        Self {
            problem,
            mesh,
            start: None,
            solver,
            quadrature: DataQuadrature::default(),
            with_errors: false,
            repeat: 1,
            with_fields: false,
        }
    }
    /// Sets the solution to start from; none for a cold start.
    #[must_use]
    pub fn start(mut self, start: Option<&'a P1Solution<T>>) -> Self {
        self.start = start;
        self
    }
    /// Sets the quadrature of data.
    #[must_use]
    pub fn quadrature(mut self, quadrature: DataQuadrature) -> Self {
        self.quadrature = quadrature;
        self
    }
    /// Sets whether errors are computed: the exact solution must hold on this mesh.
    #[must_use]
    pub fn with_errors(mut self, with_errors: bool) -> Self {
        self.with_errors = with_errors;
        self
    }
    /// Sets the number of runs of which times are the smallest.
    #[must_use]
    pub fn repeat(mut self, repeat: usize) -> Self {
        self.repeat = repeat;
        self
    }
    /// Sets whether fields for pictures are wanted.
    #[must_use]
    pub fn with_fields(mut self, with_fields: bool) -> Self {
        self.with_fields = with_fields;
        self
    }
}

impl<T: Real, const D: usize> fmt::Debug for Task<'_, T, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // destructured, so that a field added later is listed too
        let &Self { problem, mesh, start, solver, quadrature, with_errors, repeat, with_fields } =
            self;
        f.debug_struct("Task")
            .field("problem", problem)
            .field("cells", &mesh.n_cells())
            .field("start", &start.is_some())
            .field("solver", &solver.name())
            .field("quadrature", &quadrature)
            .field("with_errors", &with_errors)
            .field("repeat", &repeat)
            .field("with_fields", &with_fields)
            .finish()
    }
}

/// The result of [`solve`]: outcome, errors, counts, times and warnings.
#[derive(Debug)]
#[non_exhaustive]
pub struct Solved {
    /// Penalty factors in force.
    pub parameters: PenaltyParameters,
    /// Number of unknowns, Dirichlet ones included.
    pub unknowns: usize,
    /// Stored entries of the matrix.
    pub nonzeros: usize,
    /// How the solve ended.
    pub outcome: Outcome,
    /// Errors against the exact solution.
    pub error: Errors,
    /// Distances of multiplier and contact set from the exact ones.
    pub contact: ContactErrors,
    /// The objective, for symmetric schemes.
    pub objective: Option<f64>,
    /// Constrained unknowns in contact.
    pub active: Option<usize>,
    /// Outer iterations.
    pub outer: Option<usize>,
    /// Inner iterations.
    pub linear: usize,
    /// The linear solver used.
    pub linear_solver: &'static str,
    /// The certificate.
    pub certificate: Certificate,
    /// Seconds of assembly.
    pub assemble_seconds: f64,
    /// Seconds of the solve on this mesh.
    pub solve_seconds: f64,
    /// Fields for pictures.
    pub fields: Option<Fields>,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Assembles and solves.
///
/// # Errors
/// Those of assembly: bad data. Numerical outcomes are in [`Solved::outcome`].
pub fn solve<T: Real, const D: usize>(
    scheme: &dyn AnyScheme<T, D>,
    task: &Task<'_, T, D>,
) -> Result<Solved, Error> {
    compiled!(
        T, D: fn(&dyn AnyScheme<T, D>, &Task<'_, T, D>) -> Result<Solved, Error>
            = solve_task
    )(scheme, task)
}

fn solve_task<T: Real, const D: usize>(
    scheme: &dyn AnyScheme<T, D>,
    task: &Task<'_, T, D>,
) -> Result<Solved, Error> {
    let discretise = || scheme.discretise(task.problem, task.mesh, task.quadrature);
    let clock = Instant::now();
    let space = discretise()?;
    let mut inequality = space.inequality()?;
    let mut assemble_seconds = clock.elapsed().as_secs_f64();
    for _ in 1..task.repeat {
        let clock = Instant::now();
        drop(discretise()?.inequality()?);
        assemble_seconds = assemble_seconds.min(clock.elapsed().as_secs_f64());
    }
    let mut guess = InitialGuess::default();
    if let Some(start) = task.start {
        // a start without contact stays cold: the solver must detect a body that only contact holds
        if start.contact.iter().any(|&c| c != Contact::Inactive) {
            inequality.start =
                Start::Contact(starting_contact(&start.contact, &inequality.supports));
        }
        guess.coarse_spaces = start.coarse_spaces.clone();
        guess.values =
            (!start.values.is_empty()).then(|| means(&start.values, &inequality.supports));
    }
    let penalty_below_bound = space.penalty_below_bound();
    let mut warnings = Vec::new();
    if let Some(warning) = penalty_below_bound {
        warnings.push(warning.to_string());
    }
    let limit = space.form().theory().rounding_limit(T::EPSILON, task.mesh.domain_diameter());
    let shortest = task.mesh.shortest_edge();
    if shortest < limit {
        warnings.push(format!(
            "edges of length {shortest:.1e} are below {limit:.1e}, where rounding in {} may outweigh the discretisation error",
            T::NAME
        ));
    }
    let (solution, solve_seconds) = run(task, &inequality, &guess, penalty_below_bound.is_some());
    let u = &solution.values;
    // these outcomes have no iterate, hence no errors, counts or certificate
    let has_no_iterate = matches!(
        solution.outcome,
        Outcome::NotCoercive
            | Outcome::Singular
            | Outcome::NotFinite
            | Outcome::OutOfMemory
            | Outcome::Malformed
    );
    let usable = !has_no_iterate && u.iter().all(|v| v.to_f64().is_finite());
    let (error, contact) = if task.with_errors && usable {
        (space.errors(u)?, space.contact_errors(&inequality, &solution)?)
    } else {
        Default::default()
    };
    let fields = (task.with_fields && usable).then(|| space.fields(&inequality, &solution));
    Ok(Solved {
        parameters: space.form().theory().parameters,
        unknowns: inequality.size(),
        nonzeros: inequality.matrix.nonzeros(),
        outcome: solution.outcome,
        error,
        contact,
        objective: (inequality.symmetric && usable).then(|| inequality.objective(u)),
        active: usable.then(|| crate::inequality::count_active(&inequality, &solution.contact)),
        outer: usable.then_some(solution.outer),
        linear: solution.linear,
        linear_solver: solution.linear_solver,
        certificate: match usable {
            true => Certificate {
                algebraic_bound: solution.algebraic_bound,
                ..certify_with_jump_multipliers(&inequality, u, &solution.jump_multipliers)
            },
            false => Certificate::INVALID,
        },
        assemble_seconds,
        solve_seconds,
        fields,
        warnings,
    })
}

/// Solves [`Task::repeat`] times and returns the last solution with the smallest time. A penalty
/// below its proven bound may still give a coercive form, and the size of an error does not show
/// whether it does: with `in_doubt` the matrix is first tested for definiteness. The time includes
/// this test.
fn run<T: Real, const D: usize>(
    task: &Task<'_, T, D>,
    inequality: &Inequality<T>,
    guess: &InitialGuess<T>,
    in_doubt: bool,
) -> (Solution<T>, f64) {
    let clock = Instant::now();
    let definite = || {
        let free: Vec<u32> = (0..inequality.size() as u32)
            .filter(|&i| !matches!(inequality.bounds[i as usize], Bound::Fixed(_)))
            .collect();
        is_positive_definite(&inequality.matrix, inequality.symmetric, &free)
    };
    if in_doubt && definite() == Ok(false) {
        let values = vec![T::lit(0.0); inequality.size()];
        let contact = vec![Contact::Inactive; inequality.size()];
        let solution = Solution::new(values, contact, Outcome::NotCoercive);
        return (solution, clock.elapsed().as_secs_f64());
    }
    let in_test = clock.elapsed().as_secs_f64();
    let mut seconds = f64::INFINITY;
    let mut last = None;
    for _ in 0..task.repeat.max(1) {
        let clock = Instant::now();
        last = Some(task.solver.solve_from(inequality, guess));
        seconds = seconds.min(clock.elapsed().as_secs_f64());
    }
    match last {
        Some(solution) => (solution, in_test + seconds),
        None => unreachable!("at least one run"),
    }
}

/// The starting contact of unknowns: an unknown starts in contact if more than half of the vertices
/// of its support are in contact.
fn starting_contact(contact: &[Contact], supports: &[Support]) -> Vec<Contact> {
    let state = |support: &Support| {
        let vertices = support.vertices();
        [Contact::Lower, Contact::Upper]
            .into_iter()
            .find(|&side| {
                let on = vertices.iter().filter(|&&v| contact[v as usize] == side).count();
                2 * on > vertices.len()
            })
            .unwrap_or(Contact::Inactive)
    };
    supports.iter().map(state).collect()
}

/// The starting values of unknowns: the means of values over the vertices of each support.
fn means<T: Real>(values: &[T], supports: &[Support]) -> Vec<T> {
    let mean = |support: &Support| {
        let vertices = support.vertices();
        let sum = vertices.iter().fold(T::lit(0.0), |s, &v| s + values[v as usize]);
        sum / T::lit(vertices.len().max(1) as f64)
    };
    supports.iter().map(mean).collect()
}
