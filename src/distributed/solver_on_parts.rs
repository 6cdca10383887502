//! The solver of inequalities over the parts of a mesh.

use std::sync::{Arc, Mutex};

use super::engine::EngineMethod;
use super::own_unknowns::OnOwnUnknowns;
use super::preconditioner::{Auxiliary, EnginePreconditioners};
use super::process::Process;
use crate::algebra::{Bound, Contact, Inequality};
use crate::constraint::Nodes;
use crate::error::Error;
use crate::inequality::{ActiveSet, InequalitySolver, InitialGuess, Outcome, Solution};
use crate::linear::krylov::symmetric_part;
use crate::linear::{FactorError, Preconditioner};
use crate::nested::{System, SystemSolver};
use crate::processes::{OverParts, agree};
use crate::scheme::{ConformingP1, NonconformingP1, Scheme};

/// Multigrid that is a part of a preconditioner is set up again once more unknowns have become free or fixed than this
/// number of layers of cells along a free boundary of the size of the domain has. On radial-2d at 1024 SIPG takes 31
/// iterations with this number and 43 with four, and 39 to 46 seconds of a processor; at 256 WOPSIP with bounds at
/// vertices takes 34 and 35, and 48 and more time if every change counts. Multigrid alone is set up for each change.
const FEW_LAYERS: f64 = 1.0;

/// Most unknowns of all parts for which the engine factors the matrix of a scheme.
const MOST_FACTORED: u64 = 400_000;

/// How many unknowns [`FEW_LAYERS`] have.
fn few_changes<const D: usize>(over_parts: &OverParts) -> f64 {
    FEW_LAYERS * (over_parts.n_unknowns() as f64).powf((D as f64 - 1.0) / D as f64)
}

/// The solver of inequalities over the parts of a mesh: the active set method of one process with its stopping tests,
/// sums and maxima taken over all parts; an [`Engine`](crate::distributed::Engine) provides what multigrid and factors
/// are in one process.
#[derive(Clone, Debug)]
pub struct SolverOnParts {
    process: Process,
}

impl SolverOnParts {
    /// The solver of one of the processes; all have one.
    #[must_use]
    pub fn new(process: Process) -> Self {
        Self { process }
    }
}

impl<const D: usize> SystemSolver<D> for SolverOnParts {
    fn name(&self) -> &'static str {
        "active-set"
    }
    /// Solves over the parts of a mesh.
    ///
    /// # Errors
    /// [`Error::Parameter`] on a whole mesh; [`Error::Processes`] in all parts for a mesh with a component without
    /// Dirichlet data, a scheme without a preconditioner on parts, a failure of the engine.
    fn solve(
        &self,
        system: &System<'_, D>,
        guess: &InitialGuess<f64>,
    ) -> Result<Solution<f64>, Error> {
        let Some(over_parts) = system.over_parts() else {
            let allowed = "this solver is one over the parts of a mesh";
            return Err(Error::parameter("mesh", "a whole one", allowed));
        };
        system.agreed(check(system))?;
        // a start need not be accurate
        let is_start = guess.energy_tolerance.is_some();
        let solve = Solve { process: &self.process, system, over_parts, guess, is_start };
        let mut solution = solve.by_active_sets()?;
        over_parts.update_contact(&mut solution.contact);
        Ok(solution)
    }
}

/// Checks that a system has what a solve over parts needs.
fn check<const D: usize>(system: &System<'_, D>) -> Result<(), Error> {
    if !system.mesh().is_supported() {
        let allowed = "on several parts every component of the domain needs Dirichlet data";
        return Err(Error::parameter("boundary", "without Dirichlet data", allowed));
    }
    let form = system.discretisation().form();
    let is_over_penalised = form.couples() && !form.uses_flux() && !form.is_lifted();
    if is_over_penalised && D > 1 && system.discretisation().degree() > 1 {
        let allowed = "they have no preconditioner on several parts";
        return Err(Error::parameter("scheme", "over-penalised quadratics", allowed));
    }
    Ok(())
}

/// One solve.
struct Solve<'s, 'a, const D: usize> {
    process: &'s Process,
    system: &'s System<'a, D>,
    over_parts: &'s Arc<OverParts>,
    guess: &'s InitialGuess<f64>,
    /// Whether it is that of a conforming P1 solution from which others start.
    is_start: bool,
}

impl<const D: usize> Solve<'_, '_, D> {
    /// The active set method with preconditioners of the engine.
    ///
    /// Where nothing proves that the matrix is positive definite, its factors tell. Where the Krylov method finds no
    /// solution of a symmetric inequality, the active set method runs again with factors as the preconditioner. Both
    /// up to [`MOST_FACTORED`] unknowns.
    fn by_active_sets(&self) -> Result<Solution<f64>, Error> {
        let inequality = self.system.inequality();
        let may_factor = !self.is_start && self.over_parts.n_unknowns() <= MOST_FACTORED;
        if may_factor && !inequality.is_definite && !self.has_factors()? {
            let n = inequality.size();
            let (values, contact) = (vec![0.0; n], vec![Contact::Inactive; n]);
            return Ok(Solution::new(values, contact, Outcome::NotCoercive));
        }
        let solution = self.with_auxiliary(self.auxiliary()?)?;
        let found_none =
            matches!(solution.outcome, Outcome::Stalled | Outcome::Cycling | Outcome::NotCoercive);
        if !(found_none && may_factor && inequality.symmetric && D > 1) {
            return Ok(solution);
        }
        let mut by_factors = self.with_auxiliary(Auxiliary::None(EngineMethod::Factors, 0.0))?;
        if by_factors.outcome != Outcome::Converged {
            return Ok(solution);
        }
        by_factors.outer += solution.outer;
        by_factors.linear += solution.linear;
        by_factors.systems = by_factors.systems.zip(solution.systems).map(|(a, b)| a + b);
        by_factors.stages.splice(0..0, solution.stages);
        Ok(by_factors)
    }

    fn with_auxiliary(&self, auxiliary: Auxiliary) -> Result<Solution<f64>, Error> {
        let family = EnginePreconditioners {
            engine: self.process.engine.clone(),
            over_parts: self.over_parts.clone(),
            auxiliary,
            n_vertices: self.system.mesh().vertices().len(),
        };
        let solver = ActiveSet::default().with_preconditioners(family);
        let solution = solver.solve_from(self.system.inequality(), self.guess);
        self.check_engine()?;
        Ok(solution)
    }

    /// An error of all parts if the engine of one has failed.
    fn check_engine(&self) -> Result<(), Error> {
        let failed = self.process.engine.take_failure().map_or(Ok(()), Err);
        Ok(agree(failed, &*self.process.exchange)?)
    }

    /// Whether the matrix, or its symmetric part, has factors with positive pivots on all unknowns that are not fixed,
    /// as far as memory suffices to tell.
    fn has_factors(&self) -> Result<bool, Error> {
        let inequality = self.system.inequality();
        let matrix = symmetric_part(inequality);
        let by = (EngineMethod::Factors, 0.0);
        let over_parts = self.over_parts.clone();
        let mut solver = OnOwnUnknowns::new(&*self.process.engine, &matrix, over_parts, by);
        let bounds = inequality.bounds.iter();
        let fixed: Vec<bool> = bounds.map(|bound| bound.fixed_value().is_some()).collect();
        let factored = solver.set_fixed(&fixed);
        self.check_engine()?;
        // without memory for factors nothing is known
        Ok(!matches!(factored, Err(FactorError::NotPositive | FactorError::Singular)))
    }

    /// The correction besides the blocks of cells, with the auxiliary matrix.
    fn auxiliary(&self) -> Result<Auxiliary, Error> {
        let inequality = self.system.inequality();
        let locations = &inequality.locations;
        // unknowns that cells share and whose locations are facets are those of Crouzeix-Raviart functions
        let is_of_facets = !self.system.discretisation().space.broken
            && locations.iter().all(|location| location.vertices().len() == D);
        if D == 1 {
            return Ok(Auxiliary::None(EngineMethod::Factors, 0.0));
        }
        if inequality.conforming_linear || is_of_facets {
            let few = if self.is_start { few_changes::<D>(self.over_parts) } else { 0.0 };
            return Ok(Auxiliary::None(EngineMethod::Multigrid, few));
        }
        // facet means carry the whole energy of unknowns that are means
        let are_means = inequality.penalised.is_some()
            && locations.first().is_some_and(|location| location.vertices().len() > 1);
        let multigrid = |of: &Inequality<f64>, over_parts: &Arc<OverParts>| {
            let few = if are_means { 0.0 } else { few_changes::<D>(over_parts) };
            let by = (EngineMethod::Multigrid, few);
            let solver =
                OnOwnUnknowns::new(&*self.process.engine, &of.matrix, over_parts.clone(), by);
            Mutex::new(Some(solver))
        };
        // the constraint set of the problem is for the scheme
        let problem = self.system.discretisation().problem().clone().on(Nodes);
        let is_penalised = inequality.penalised.is_some();
        let scheme: &dyn Scheme<D> = if is_penalised { &NonconformingP1 } else { &ConformingP1 };
        let beside = self.system.beside(scheme, &problem)?;
        let Some(over_parts) = beside.over_parts() else {
            unreachable!("it is in the same place as the system")
        };
        let multigrid = multigrid(beside.inequality(), over_parts);
        if is_penalised {
            let of = beside.discretisation();
            let n_cells = self.system.mesh().n_cells();
            let unknowns = (0..n_cells).flat_map(|cell| of.unknowns_of(cell).map(|i| i as u32));
            return Ok(Auxiliary::FacetMeans(multigrid, unknowns.collect()));
        }
        let is_fixed = |bound: &Bound<f64>| matches!(bound, Bound::Fixed(_));
        let dirichlet = beside.inequality().bounds.iter().map(is_fixed).collect();
        Ok(Auxiliary::Conforming(multigrid, dirichlet))
    }
}
