//! One solve: a scheme on a mesh, from assembly to certificate and errors.

use crate::instances::compiled;
use crate::measure::Fields;
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
use crate::linear::is_positive_definite;
use crate::measure::{ContactErrors, Errors};
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::AnyScheme;

/// What a scheme is asked to solve.
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

/// What a scheme found.
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
    let mut nearby = InitialGuess::default();
    if let Some(start) = task.start {
        // contact nowhere is no knowledge: such a start must be free to find that nothing else
        // holds the body
        if start.contact.iter().any(|&c| c != Contact::Inactive) {
            inequality.start = Start::Contact(transfer(&start.contact, &inequality.supports));
        }
        nearby.coarse_spaces = start.coarse_spaces.clone();
        nearby.values =
            (!start.values.is_empty()).then(|| means(&start.values, &inequality.supports));
    }
    let shortfall = space.coercivity_margin();
    let mut warnings = Vec::new();
    if let Some(s) = shortfall {
        warnings.push(s.to_string());
    }
    let limit = space.form().rounding_limit(T::EPSILON, task.mesh.domain_diameter());
    let shortest = task.mesh.shortest_edge();
    if shortest < limit {
        warnings.push(format!(
            "edges of length {shortest:.1e} are below {limit:.1e}, where rounding in {} may outweigh the discretisation error",
            T::NAME
        ));
    }
    let (solution, solve_seconds) = run(task, &inequality, &nearby, shortfall.is_some());
    let u = &solution.values;
    // without a factorisation there is no iterate, and no number that says anything about one
    let nothing = matches!(
        solution.outcome,
        Outcome::NotCoercive
            | Outcome::Singular
            | Outcome::NotFinite
            | Outcome::OutOfMemory
            | Outcome::Malformed
    );
    let usable = !nothing && u.iter().all(|v| v.to_f64().is_finite());
    let (error, contact) = if task.with_errors && usable {
        (space.errors(u)?, space.contact_errors(&inequality, &solution)?)
    } else {
        Default::default()
    };
    let fields = (task.with_fields && usable).then(|| space.fields(&inequality, &solution));
    Ok(Solved {
        parameters: space.form().parameters(),
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

/// Solves as often as asked and keeps the smallest time. A penalty below its proven bound may still
/// do, but the size of an error does not tell: the matrix is tested for definiteness first, in time
/// that counts.
fn run<T: Real, const D: usize>(
    task: &Task<'_, T, D>,
    inequality: &Inequality<T>,
    nearby: &InitialGuess<T>,
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
        last = Some(task.solver.solve_from(inequality, nearby));
        seconds = seconds.min(clock.elapsed().as_secs_f64());
    }
    match last {
        Some(solution) => (solution, in_test + seconds),
        None => unreachable!("at least one run"),
    }
}

/// Contact of vertices carried to unknowns: an unknown starts in contact if more than half of the
/// vertices around its node are.
fn transfer(vertices: &[Contact], supports: &[Support]) -> Vec<Contact> {
    let state = |place: &Support| {
        let around = place.vertices();
        [Contact::Lower, Contact::Upper]
            .into_iter()
            .find(|&side| {
                let on = around.iter().filter(|&&v| vertices[v as usize] == side).count();
                2 * on > around.len()
            })
            .unwrap_or(Contact::Inactive)
    };
    supports.iter().map(state).collect()
}

/// Values at vertices carried to unknowns: the mean over the vertices around each node.
fn means<T: Real>(vertices: &[T], supports: &[Support]) -> Vec<T> {
    let mean = |place: &Support| {
        let around = place.vertices();
        let sum = around.iter().fold(T::lit(0.0), |s, &v| s + vertices[v as usize]);
        sum / T::lit(around.len().max(1) as f64)
    };
    supports.iter().map(mean).collect()
}
