//! Nested iteration on the parts of a mesh.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use super::hierarchy::PartHierarchy;
use super::own_unknowns::{OnOwnUnknowns, RowsOfPart};
use super::preconditioner::{Auxiliary, EnginePreconditioners};
use super::solved::{DistributedSolved, contact_of_owners};
use super::system::System;
use crate::algebra::{Bound, Contact, Distribution, Start};
use crate::arrays::map_entries;
use crate::assemble::DataQuadrature;
use crate::constraint::Nodes;
use crate::distributed::agree::{agree, agree_on_data};
use crate::distributed::engine::{EngineMethod, OwnData};
use crate::distributed::error::ExchangeError;
use crate::distributed::process::Process;
use crate::element::Layout;
use crate::error::Error;
use crate::inequality::initial_guess::{
    P1_ENERGY_TOLERANCE, contact_of_supports, means_over_supports,
};
use crate::inequality::{ActiveSet, InequalitySolver, InitialGuess, Outcome, Solution, contact_of};
use crate::linear::krylov::symmetric_part;
use crate::linear::{FactorError, Preconditioner};
use crate::mesh::Part;
use crate::problem::Problem;
use crate::scheme::{ConformingP1, NonconformingP1, Scheme};

/// Multigrid that is a part of a preconditioner is set up again once more unknowns have become free or fixed than this
/// number of layers of cells along a free boundary of the size of the domain has. On radial-2d at 1024 SIPG takes 31
/// iterations with this number and 43 with four, and 39 to 46 seconds of a processor; at 256 WOPSIP with bounds at
/// vertices takes 34 and 35, and 48 and more time if every change counts. Multigrid alone is set up for each change.
const FEW_LAYERS: f64 = 1.0;

/// Most unknowns of all parts for which the engine factors the matrix of a scheme.
const MOST_FACTORED: u64 = 400_000;

/// One problem on the parts of nested meshes.
///
/// Conforming P1 starts from its solution on the next coarser mesh, every other scheme from conforming P1 on
/// the same mesh, as in [`NestedIteration`](crate::nested::NestedIteration) of one process. The method is the
/// active set method of one process with its stopping tests, sums and maxima taken over all parts; an
/// [`Engine`](crate::distributed::Engine) provides what multigrid and factors are in one process.
#[derive(Debug)]
pub struct DistributedIteration<'a, const D: usize> {
    problem: &'a Problem<D>,
    hierarchy: &'a PartHierarchy<D>,
    process: Process,
    quadrature: DataQuadrature,
    is_by_engine: bool,
    p1_solutions: Vec<Option<Arc<P1OnPart>>>,
}

/// How many unknowns [`FEW_LAYERS`] have.
fn few_changes<const D: usize>(of: &System<'_, D>) -> f64 {
    FEW_LAYERS * (of.over_parts.n_unknowns() as f64).powf((D as f64 - 1.0) / D as f64)
}

/// Conforming P1 on the part of a mesh, ghosts included.
#[derive(Debug)]
struct P1OnPart {
    /// The value of every vertex; empty if the solve did not converge.
    values: Vec<f64>,
    contact: Vec<Contact>,
    /// Seconds of this level and all coarser ones.
    seconds: f64,
}

impl<'a, const D: usize> DistributedIteration<'a, D> {
    /// A problem on the parts of nested meshes.
    #[must_use]
    pub fn new(problem: &'a Problem<D>, hierarchy: &'a PartHierarchy<D>, process: Process) -> Self {
        let p1_solutions = vec![None; hierarchy.n_meshes()];
        let quadrature = DataQuadrature::default();
        Self { problem, hierarchy, process, quadrature, is_by_engine: false, p1_solutions }
    }
    /// Sets the quadrature of data.
    #[must_use]
    pub fn quadrature(mut self, quadrature: DataQuadrature) -> Self {
        self.quadrature = quadrature;
        self.p1_solutions.fill(None);
        self
    }
    /// Makes the engine solve the inequalities of schemes by a method of its own, for cross-checks.
    #[must_use]
    pub fn by_engine(mut self, is_by_engine: bool) -> Self {
        self.is_by_engine = is_by_engine;
        self
    }
    /// The part of a mesh by its position.
    ///
    /// # Panics
    /// If there is no such mesh.
    pub fn part(&self, position: usize) -> &'a Part<D> {
        self.hierarchy.part(position)
    }
    /// Replaces the problem by one with another constraint set. The P1 solutions are kept.
    pub fn replace_constraint_set(&mut self, problem: &'a Problem<D>) {
        self.problem = problem;
    }

    /// The solution of a scheme on a mesh, by its position: zero for the coarsest. All parts call it.
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] in all parts: bad data, a mesh with a component without Dirichlet data, a scheme
    /// without a preconditioner on parts, a failure of the engine.
    pub fn solve_on(
        &mut self,
        position: usize,
        scheme: &dyn Scheme<D>,
    ) -> Result<DistributedSolved<'a, D>, ExchangeError> {
        let part = self.hierarchy.part(position);
        agree_on_data(self.check(scheme, part), &part.cells, &*self.process.exchange)?;
        let is_p1 = scheme.is_conforming_linear(&part.mesh);
        let start = match self.problem.is_constrained() {
            true if is_p1 => self.p1_start(position)?,
            true => Some(self.p1_solution(position)?),
            false => None,
        };
        let mut system =
            System::new(scheme, self.problem, part, self.quadrature, &self.process.exchange)?;
        let mut guess = InitialGuess::default();
        if let Some(start) = &start {
            let supports = &system.inequality.supports;
            if !start.values.is_empty() {
                guess = guess.values(means_over_supports(supports, &start.values));
            }
            let contact = contact_of_supports(supports, &start.contact);
            system.inequality.start = Start::Contact(contact);
        }
        let sent = self.process.exchange.sent_bytes();
        let (solution, in_solve) = match self.is_by_engine {
            true => self.run_engine(&system, &guess)?,
            false => self.run(&system, scheme.layout(), part, &guess)?,
        };
        let sent = self.process.exchange.sent_bytes() - sent;
        let mut solved = DistributedSolved::new(system, part, solution);
        solved.mesh_seconds = self.hierarchy.seconds(position);
        solved.start_seconds = start.map_or(0.0, |start| start.seconds);
        solved.solve_seconds = in_solve;
        solved.sent_bytes = sent;
        Ok(solved)
    }

    /// Checks that a scheme and a part have what a solve over parts needs.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self, scheme: &dyn Scheme<D>, part: &Part<D>) -> Result<(), Error> {
        let refuse = |parameter, value: &str, allowed: &str| {
            let (value, allowed) = (value.to_owned(), allowed.to_owned());
            Err(Error::Parameter { parameter, value, allowed })
        };
        if !part.mesh.is_supported() {
            let allowed = "on several parts every component of the domain needs Dirichlet data";
            return refuse("boundary", "without Dirichlet data", allowed);
        }
        let form = scheme.form(&part.mesh);
        let is_over_penalised = form.couples() && !form.uses_flux() && !form.is_lifted();
        if is_over_penalised && D > 1 && scheme.degree() > 1 {
            let allowed = "over-penalised quadratics have no preconditioner on several parts";
            return refuse("scheme", scheme.name(), allowed);
        }
        Ok(())
    }

    /// Solves a system; returns the seconds of the solve with its auxiliary matrices, too.
    ///
    /// Where nothing proves that the matrix is positive definite, its factors tell. Where the Krylov method finds no
    /// solution of a symmetric inequality, the active set method runs again with factors as the preconditioner. Both
    /// up to [`MOST_FACTORED`] unknowns.
    fn run(
        &self,
        system: &System<'_, D>,
        layout: Layout,
        part: &'a Part<D>,
        guess: &InitialGuess<f64>,
    ) -> Result<(Solution<f64>, f64), ExchangeError> {
        let clock = Instant::now();
        let inequality = &system.inequality;
        let may_factor = system.over_parts.n_unknowns() <= MOST_FACTORED;
        let is_start = guess.energy_tolerance.is_some();
        if may_factor && !is_start && !inequality.is_definite && !self.has_factors(system)? {
            let n = inequality.size();
            let (values, contact) = (vec![0.0; n], vec![Contact::Inactive; n]);
            let solution = Solution::new(values, contact, Outcome::NotCoercive);
            return Ok((solution, clock.elapsed().as_secs_f64()));
        }
        let solve = |auxiliary| {
            let family = EnginePreconditioners {
                engine: self.process.engine.clone(),
                over_parts: system.over_parts.clone(),
                auxiliary,
                n_vertices: part.mesh.vertices().len(),
            };
            ActiveSet::default().with_preconditioners(family).solve_from(inequality, guess)
        };
        let mut solution = solve(self.auxiliary(system, layout, part, guess)?);
        self.check_engine()?;
        let found_none =
            matches!(solution.outcome, Outcome::Stalled | Outcome::Cycling | Outcome::NotCoercive);
        if found_none && may_factor && !is_start && inequality.symmetric && D > 1 {
            let mut by_factors = solve(Auxiliary::None(EngineMethod::Factors, 0.0));
            self.check_engine()?;
            if by_factors.outcome == Outcome::Converged {
                by_factors.outer += solution.outer;
                by_factors.linear += solution.linear;
                by_factors.stages.splice(0..0, solution.stages);
                solution = by_factors;
            }
        }
        Ok((solution, clock.elapsed().as_secs_f64()))
    }

    /// An error of all parts if the engine of one has failed.
    fn check_engine(&self) -> Result<(), ExchangeError> {
        agree(self.process.engine.take_failure().map_or(Ok(()), Err), &*self.process.exchange)
    }

    /// Whether the matrix, or its symmetric part, has factors with positive pivots on all unknowns that are not fixed,
    /// as far as memory suffices to tell.
    fn has_factors(&self, system: &System<'_, D>) -> Result<bool, ExchangeError> {
        let matrix = symmetric_part(&system.inequality);
        let by = (EngineMethod::Factors, 0.0);
        let over_parts = system.over_parts.clone();
        let mut solver = OnOwnUnknowns::new(&*self.process.engine, &matrix, over_parts, by);
        let bounds = system.inequality.bounds.iter();
        let fixed: Vec<bool> = bounds.map(|bound| bound.fixed_value().is_some()).collect();
        let factored = solver.set_fixed(&fixed);
        self.check_engine()?;
        // without memory for factors nothing is known
        Ok(!matches!(factored, Err(FactorError::NotPositive | FactorError::Singular)))
    }

    /// What corrects besides the blocks of cells, with the auxiliary matrix.
    fn auxiliary(
        &self,
        system: &System<'_, D>,
        layout: Layout,
        part: &'a Part<D>,
        guess: &InitialGuess<f64>,
    ) -> Result<Auxiliary, ExchangeError> {
        // the constraint set of the problem is for the scheme
        let problem = self.problem.clone().on(Nodes);
        let new = |scheme: &dyn Scheme<D>| {
            System::new(scheme, &problem, part, self.quadrature, &self.process.exchange)
        };
        let is_of_facets = layout.vertex + layout.edge + layout.cell == 0;
        let supports = &system.inequality.supports;
        let multigrid = |of: &System<'_, D>| {
            let (matrix, over_parts) = (&of.inequality.matrix, of.over_parts.clone());
            // facet means carry the whole energy of unknowns that are means
            let are_means = system.inequality.penalised.is_some()
                && supports.first().is_some_and(|support| support.vertices().len() > 1);
            let by = (EngineMethod::Multigrid, if are_means { 0.0 } else { few_changes(of) });
            let solver = OnOwnUnknowns::new(&*self.process.engine, matrix, over_parts, by);
            Mutex::new(Some(solver))
        };
        Ok(if D == 1 {
            Auxiliary::None(EngineMethod::Factors, 0.0)
        } else if system.inequality.conforming_linear || is_of_facets {
            // a start need not be accurate
            let is_start = guess.energy_tolerance.is_some();
            Auxiliary::None(
                EngineMethod::Multigrid,
                if is_start { few_changes(system) } else { 0.0 },
            )
        } else if system.inequality.penalised.is_some() {
            let facet_means = new(&NonconformingP1)?;
            let of = &facet_means.discretisation;
            let mut unknowns = Vec::with_capacity(part.mesh.n_cells() * (D + 1));
            for cell in 0..part.mesh.n_cells() {
                unknowns.extend(of.unknowns_of(cell).map(|i| i as u32));
            }
            Auxiliary::FacetMeans(multigrid(&facet_means), unknowns)
        } else {
            let conforming = new(&ConformingP1)?;
            let is_fixed = |bound: &Bound<f64>| matches!(bound, Bound::Fixed(_));
            let dirichlet = conforming.inequality.bounds.iter().map(is_fixed).collect();
            Auxiliary::Conforming(multigrid(&conforming), dirichlet)
        })
    }

    /// Solves a system by the engine's own method.
    fn run_engine(
        &self,
        system: &System<'_, D>,
        guess: &InitialGuess<f64>,
    ) -> Result<(Solution<f64>, f64), ExchangeError> {
        let clock = Instant::now();
        let (over_parts, inequality) = (&*system.over_parts, &system.inequality);
        let own = over_parts.numbering.own();
        let bound = |&i: &u32| &inequality.bounds[i as usize];
        let lower = |bound: &Bound<f64>| bound.fixed_value().or(bound.lower());
        let upper = |bound: &Bound<f64>| bound.fixed_value().or(bound.upper());
        let load = inequality.assembled_load();
        let load: Vec<f64> = own.iter().map(|&i| load[i as usize]).collect();
        let lower: Vec<f64> =
            own.iter().map(|i| lower(bound(i)).unwrap_or(f64::NEG_INFINITY)).collect();
        let upper: Vec<f64> =
            own.iter().map(|i| upper(bound(i)).unwrap_or(f64::INFINITY)).collect();
        let start = |&i: &u32| {
            let value = guess.values.as_ref().map_or(0.0, |values| values[i as usize]);
            inequality.bounds[i as usize].nearest(value)
        };
        let mut own_values: Vec<f64> = own.iter().map(start).collect();
        let rows = RowsOfPart { matrix: &inequality.matrix, over_parts };
        let data = OwnData { load: &load, lower: &lower, upper: &upper };
        let steps = self.process.engine.solve_inequality(&rows, &data, &mut own_values);
        let has_method = steps.ok_or("the engine has no solver of inequalities");
        agree(has_method, &*self.process.exchange)?;
        self.check_engine()?;
        let mut values = vec![0.0; inequality.size()];
        own.iter().zip(&own_values).for_each(|(&i, &value)| values[i as usize] = value);
        (over_parts as &dyn Distribution).update(&mut values);
        let contact = contact_of(inequality, &values);
        let solution = Solution::new(values, contact, Outcome::Converged)
            .iterations(steps.unwrap_or(0), 0)
            .linear_solver("engine");
        Ok((solution, clock.elapsed().as_secs_f64()))
    }

    /// The start of conforming P1: its solution on the next coarser mesh; `None` on the coarsest mesh.
    fn p1_start(&mut self, position: usize) -> Result<Option<Arc<P1OnPart>>, ExchangeError> {
        let Some(refinement) = self.hierarchy.refinement(position) else { return Ok(None) };
        let coarse = self.p1_solution(position - 1)?;
        let mean = |&[one, other]: &[u32; 2]| {
            0.5 * (coarse.values[one as usize] + coarse.values[other as usize])
        };
        let values = match coarse.values.is_empty() {
            true => Vec::new(),
            false => refinement.parents.iter().map(mean).collect(),
        };
        let contact = |&[one, other]: &[u32; 2]| {
            let states = map_entries([one, other], |v| coarse.contact[v as usize]);
            if states[0] == states[1] { states[0] } else { Contact::Inactive }
        };
        let contact = refinement.parents.iter().map(contact).collect();
        Ok(Some(Arc::new(P1OnPart { values, contact, seconds: coarse.seconds })))
    }

    /// The solution of conforming P1 on a mesh, from its start; computed once.
    fn p1_solution(&mut self, position: usize) -> Result<Arc<P1OnPart>, ExchangeError> {
        if let Some(known) = &self.p1_solutions[position] {
            return Ok(known.clone());
        }
        let start = self.p1_start(position)?;
        let clock = Instant::now();
        let part = self.hierarchy.part(position);
        let problem = self.problem.clone().on(Nodes);
        let mut system =
            System::new(&ConformingP1, &problem, part, self.quadrature, &self.process.exchange)?;
        let mut guess = InitialGuess::default().energy_tolerance(P1_ENERGY_TOLERANCE);
        if let Some(start) = &start {
            system.inequality.start = Start::Contact(start.contact.clone());
            guess = guess.values(start.values.clone());
        }
        let layout = <dyn Scheme<D>>::layout(&ConformingP1);
        let (solution, _) = self.run(&system, layout, part, &guess)?;
        let mut p1 = P1OnPart::new(&system, &solution);
        p1.seconds = clock.elapsed().as_secs_f64() + start.map_or(0.0, |start| start.seconds);
        let p1 = Arc::new(p1);
        self.p1_solutions[position] = Some(p1.clone());
        Ok(p1)
    }
}

impl P1OnPart {
    /// Values and contact states of a solution, those of ghosts by their owners.
    fn new<const D: usize>(system: &System<'_, D>, solution: &Solution<f64>) -> Self {
        // an initial guess need not be right: after a failure it is inactive everywhere
        if solution.outcome != Outcome::Converged {
            let contact = vec![Contact::Inactive; system.inequality.size()];
            return Self { values: Vec::new(), contact, seconds: 0.0 };
        }
        let contact = contact_of_owners(&solution.contact, &system.over_parts);
        Self { values: solution.values.clone(), contact, seconds: 0.0 }
    }
}
