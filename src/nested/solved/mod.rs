//! The result of a solve.

#[cfg(feature = "report")]
mod files;
mod measures;

use std::collections::BTreeMap;
use std::fmt;
use std::sync::OnceLock;

use super::hierarchy::Hierarchy;
use crate::algebra::{Contact, Inequality};
use crate::assemble::Discretisation;
use crate::error::Error;
use crate::error_bound::{ErrorBound, PrimalDualPair};
use crate::inequality::{
    Certificate, Outcome, Solution, certify_solution, count_active, energy_norm,
};
use crate::measure::Fields;
use crate::mesh::Mesh;

/// A discrete solution with the space, the algebraic inequality and the mesh to which it belongs.
///
/// Some outcomes have no iterate ([`Solved::has_iterate`]): then there are no errors, energies and
/// fields, and the certificate is [`Certificate::INVALID`].
pub struct Solved<'a, const D: usize> {
    discretisation: Discretisation<'a, D>,
    inequality: Inequality<f64>,
    solution: Solution<f64>,
    certificate: Certificate,
    has_iterate: bool,
    /// The hierarchy that has the mesh, and its position there.
    hierarchy: Option<(&'a Hierarchy<D>, usize)>,
    /// The bound with the pair that gives it and the seconds of both, once computed.
    bound: OnceLock<(PrimalDualPair<D>, ErrorBound, f64)>,
    /// Seconds for the mesh and all coarser ones, if it is one of several.
    pub(crate) mesh_seconds: f64,
    /// Seconds of assembly.
    pub(crate) assemble_seconds: f64,
    /// Seconds of the solve on this mesh.
    pub(crate) solve_seconds: f64,
    /// Seconds of the start: the P1 solutions on this and all coarser meshes.
    pub(crate) start_seconds: f64,
    pub(crate) coarser_levels: usize,
    pub(crate) start_cycles: usize,
    pub(crate) warnings: Vec<String>,
}

impl<const D: usize> fmt::Debug for Solved<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Solved")
            .field("unknowns", &self.values().len())
            .field("outcome", &self.outcome())
            .field("certificate", &self.certificate)
            .finish_non_exhaustive()
    }
}

impl<'a, const D: usize> Solved<'a, D> {
    /// A solution with its certificate.
    pub(super) fn new(
        discretisation: Discretisation<'a, D>,
        inequality: Inequality<f64>,
        mut solution: Solution<f64>,
        hierarchy: Option<(&'a Hierarchy<D>, usize)>,
    ) -> Self {
        let has_iterate =
            solution.outcome.has_iterate() && solution.values.iter().all(|v| v.is_finite());
        let certificate = match has_iterate {
            true => certify_solution(&inequality, &solution),
            false => Certificate::INVALID,
        };
        if solution.outcome == Outcome::Converged
            && !certificate.is_within_limits(solution.precision)
        {
            // whatever a solver says of itself
            solution.outcome = Outcome::Stalled;
        }
        if has_iterate {
            let norm = energy_norm(&inequality, &solution);
            solution.dual_residual = certificate.largest() * norm;
        }
        Self {
            mesh_seconds: hierarchy.map_or(0.0, |(h, position)| h.seconds(position)),
            discretisation,
            inequality,
            solution,
            certificate,
            has_iterate,
            hierarchy,
            bound: OnceLock::new(),
            assemble_seconds: 0.0,
            solve_seconds: 0.0,
            start_seconds: 0.0,
            coarser_levels: 0,
            start_cycles: 0,
            warnings: Vec::new(),
        }
    }

    /// The energy norm to which certificates are relative.
    pub(super) fn energy_norm(&self) -> f64 {
        energy_norm(&self.inequality, &self.solution)
    }
    /// How the solve ended.
    pub fn outcome(&self) -> Outcome {
        self.solution.outcome
    }
    /// Whether the solve converged.
    pub fn converged(&self) -> bool {
        self.outcome() == Outcome::Converged
    }
    /// Whether there are values to evaluate; a solve without factors, for instance, has none.
    pub fn has_iterate(&self) -> bool {
        self.has_iterate
    }
    /// The unknowns.
    pub fn values(&self) -> &[f64] {
        &self.solution.values
    }
    /// Which bound, if any, is active at each unknown.
    pub fn contact(&self) -> &[Contact] {
        &self.solution.contact
    }
    /// The multiplier of each unknown, positive at lower and negative at upper bounds, zero elsewhere: see
    /// [`Discretisation::multipliers`]. None without an inequality or an iterate, and where rounding leaves no digit.
    /// Its density is in [`Solved::fields`].
    pub fn multiplier(&self) -> Option<Vec<f64>> {
        let multipliers = || self.discretisation.multipliers(&self.inequality, &self.solution);
        self.has_iterate.then(multipliers).flatten()
    }
    /// Number of outer iterations on this mesh, by [`Solution::outer`]; none without an iterate.
    pub fn outer(&self) -> Option<usize> {
        self.has_iterate.then_some(self.solution.outer)
    }
    /// Number of constrained unknowns in contact; none without an iterate.
    pub fn active(&self) -> Option<usize> {
        self.has_iterate.then(|| count_active(&self.inequality, self.contact()))
    }
    /// The objective `a(u,u)/2 - l(u)` with all terms of the scheme; none for schemes that are not
    /// symmetric and without an iterate.
    pub fn objective(&self) -> Option<f64> {
        let is_minimum = self.inequality.symmetric && self.has_iterate;
        is_minimum.then(|| self.inequality.objective(self.values()))
    }
    /// The energy of the solution, by one formula for every scheme: see [`Discretisation::energy`]. None
    /// without an iterate.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn energy(&self) -> Result<Option<f64>, Error> {
        let energy = || self.discretisation.energy(self.values());
        self.has_iterate.then(energy).transpose()
    }
    /// The measure of the discrete contact set, see [`Discretisation::contact_measure`]; none for a problem
    /// without inequality and for an outcome without iterate.
    pub fn contact_measure(&self) -> Option<f64> {
        let measure = || self.discretisation.contact_measure(&self.inequality, &self.solution);
        self.has_iterate.then(measure).flatten()
    }
    /// The total contact force, positive where a lower bound pushes upward: see
    /// [`Discretisation::resultant`]; none for a problem without inequality and for an outcome without iterate.
    pub fn resultant(&self) -> Option<f64> {
        let resultant = || self.discretisation.resultant(&self.inequality, &self.solution);
        self.has_iterate.then(resultant).flatten()
    }
    /// The resultant of each obstacle and each contact group, see [`Discretisation::resultants`]; none where there is
    /// no resultant.
    pub fn resultants(&self) -> Option<BTreeMap<String, f64>> {
        let resultants = || self.discretisation.resultants(&self.inequality, &self.solution);
        self.has_iterate.then(resultants).flatten()
    }
    /// The certificate: violations of the complementarity conditions.
    pub fn certificate(&self) -> Certificate {
        self.certificate
    }
    /// What the solver returned: values, contact states, numbers of iterations.
    pub fn solution(&self) -> &Solution<f64> {
        &self.solution
    }
    /// The algebraic inequality.
    pub fn inequality(&self) -> &Inequality<f64> {
        &self.inequality
    }
    /// The discretisation: scheme, problem and mesh joined.
    pub fn discretisation(&self) -> &Discretisation<'a, D> {
        &self.discretisation
    }
    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<D> {
        self.discretisation.mesh()
    }
    /// Warnings by type, as text: a penalty below its proven bound, say.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
    /// The solution with the outcome of values that no solver of the library found.
    pub(super) fn found_elsewhere(mut self) -> Self {
        if self.solution.outcome == Outcome::Stalled {
            self.solution.outcome = Outcome::NotASolution;
        }
        self
    }
    /// Solution, obstacle, multiplier and contact set on cells; none without an iterate.
    pub fn fields(&self) -> Option<Fields> {
        self.has_iterate.then(|| self.discretisation.fields(&self.inequality, &self.solution))
    }
}
