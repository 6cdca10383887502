//! The result of a solve.

#[cfg(feature = "report")]
mod files;
#[cfg(feature = "report")]
mod gradient_fields;
mod kept;
mod measures;
mod totals;

pub use kept::KeptSolution;

use std::fmt;
use std::sync::OnceLock;

use super::hierarchy::Hierarchy;
use super::system::System;
use crate::algebra::{Contact, Inequality, any_part};
use crate::assemble::Discretisation;
use crate::error_bound::{ErrorBound, PrimalDualPair};
use crate::inequality::{Certificate, Outcome, Solution, certify_solution, count_active};
use crate::measure::{Fields, Rounding};
use crate::mesh::{Mesh, Part};

/// A discrete solution with the space, the algebraic inequality and the mesh to which it belongs.
///
/// Some outcomes have no iterate ([`Solved::has_iterate`]): then there are no errors, energies and
/// fields, and the certificate is [`Certificate::INVALID`].
///
/// On a part of a mesh values, multipliers and fields are those of the part, at own unknowns and ghosts. Certificate,
/// numbers, totals, errors and bound are those of all parts; all of them call these functions, and an error of one is
/// [`Error::Processes`](crate::error::Error::Processes) in all. Distances between two solutions are none there.
pub struct Solved<'a, const D: usize> {
    system: System<'a, D>,
    pub(super) solution: Solution<f64>,
    /// The values with the constants of bodies; none if these are zero.
    values: Option<Vec<f64>>,
    certificate: Certificate,
    has_iterate: bool,
    /// The energy norm to which certificates are relative; zero without an iterate.
    energy_norm: f64,
    /// The hierarchy that has the mesh, and its position there.
    hierarchy: Option<(&'a Hierarchy<D>, usize)>,
    /// The bound with the pair that gives it and the seconds of both, once computed.
    bound: OnceLock<(PrimalDualPair<D>, ErrorBound, f64)>,
    /// The values at vertices of the conforming solution from which a scheme on linears started, on stretched cells.
    pub(super) conforming: Vec<f64>,
    /// The rounding errors in the figures, once computed.
    rounding: OnceLock<Option<Rounding>>,
    /// Seconds for the mesh and all coarser ones, if it is one of several.
    pub(crate) mesh_seconds: f64,
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
        mut system: System<'a, D>,
        mut solution: Solution<f64>,
        hierarchy: Option<(&'a Hierarchy<D>, usize)>,
    ) -> Self {
        // the inequality on the sides of kinks on which the solution lies
        for k in std::mem::take(&mut solution.turned) {
            system.inequality.turn(k as usize);
        }
        let inequality = &system.inequality;
        // a solver of one's own may return anything
        let is_whole = [solution.values.len(), solution.contact.len()] == [inequality.size(); 2]
            && solution.values.iter().all(|v| v.is_finite());
        let has_iterate =
            solution.outcome.has_iterate() && !any_part(inequality.distribution(), !is_whole);
        let (certificate, energy_norm) = match has_iterate {
            true => certify_solution(inequality, &solution),
            false => (Certificate::INVALID, 0.0),
        };
        if solution.outcome == Outcome::Converged
            && !certificate.is_within_limits(solution.precision)
        {
            // whatever a solver says of itself
            solution.outcome = Outcome::Stalled;
        }
        if has_iterate {
            solution.dual_residual = certificate.largest() * energy_norm;
        }
        solution.constants = system.discretisation.constants();
        let sum = |(value, constant): (&f64, &f64)| value + constant;
        let with_constants = || solution.values.iter().zip(&solution.constants).map(sum).collect();
        let values = (!solution.constants.is_empty()).then(with_constants);
        Self {
            values,
            mesh_seconds: hierarchy.map_or(0.0, |(h, position)| h.seconds(position)),
            system,
            solution,
            certificate,
            has_iterate,
            energy_norm,
            hierarchy,
            bound: OnceLock::new(),
            conforming: Vec::new(),
            rounding: OnceLock::new(),
            solve_seconds: 0.0,
            start_seconds: 0.0,
            coarser_levels: 0,
            start_cycles: 0,
            warnings: Vec::new(),
        }
    }

    /// The system on the sides of kinks on which the solution lies, with values and contact states of the solution.
    pub(super) fn into_system(self) -> (System<'a, D>, Vec<f64>, Vec<Contact>) {
        (self.system, self.solution.values, self.solution.contact)
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
    /// The unknowns of the solution. Functions of the [discretisation](Self::discretisation) and the
    /// [inequality](Self::inequality) take those of [`Self::solution`], which lack the
    /// [constants](Discretisation::constants) of bodies.
    pub fn values(&self) -> &[f64] {
        self.values.as_deref().unwrap_or(&self.solution.values)
    }
    /// Which bound, if any, is active at each unknown.
    pub fn contact(&self) -> &[Contact] {
        &self.solution.contact
    }
    /// The multiplier of each unknown, positive at lower and negative at upper bounds, zero elsewhere: see
    /// [`Discretisation::multipliers`]. None without an inequality or an iterate, and where rounding leaves no digit.
    /// Its density is in [`Solved::fields`].
    pub fn multiplier(&self) -> Option<Vec<f64>> {
        let multipliers = || self.discretisation().multipliers(self.inequality(), &self.solution);
        self.has_iterate.then(multipliers).flatten()
    }
    /// Number of outer iterations on this mesh, by [`Solution::outer`]; none without an iterate.
    pub fn outer(&self) -> Option<usize> {
        self.has_iterate.then_some(self.solution.outer)
    }
    /// The numbers of cells, unknowns and stored entries of the matrix.
    pub fn sizes(&self) -> [u64; 3] {
        self.system.sizes()
    }
    /// Number of constrained unknowns in contact; none without an iterate.
    pub fn active(&self) -> Option<usize> {
        let own = self.has_iterate.then(|| count_active(self.inequality(), self.contact()))?;
        Some(self.system.sums([own as f64])[0] as usize)
    }
    /// The objective `a(u,u)/2 - l(u)` with all terms of the scheme; none for schemes that are not
    /// symmetric and without an iterate.
    pub fn objective(&self) -> Option<f64> {
        let is_minimum = self.inequality().symmetric && self.has_iterate;
        let objective = |values: &[f64]| self.inequality().objective(values);
        is_minimum.then(|| {
            let of_values = objective(&self.solution.values);
            match self.solution.constants.is_empty() {
                true => of_values,
                // the terms of the constants alone: with pinned data no gradient is in them
                false => of_values + self.objective_of_constants(),
            }
        })
    }
    /// What the constants of bodies add to the objective. With pinned data no gradient is in it, with weak data the form
    /// of constants and data is.
    fn objective_of_constants(&self) -> f64 {
        let (of, constants) = (self.discretisation(), &self.solution.constants);
        match of.space.pins {
            true => {
                let zero = vec![0.0; constants.len()];
                let energy = of.energy(&zero).and_then(|energy| {
                    // kinks have friction with the constants
                    Ok(energy - of.space.friction_energy(&zero, &|_| true)?)
                });
                energy.expect("the load was assembled before")
            }
            false => {
                let negative: Vec<f64> = constants.iter().map(|constant| -constant).collect();
                -self.inequality().objective(&negative)
            }
        }
    }
    /// The certificate: violations of the complementarity conditions.
    pub fn certificate(&self) -> Certificate {
        self.certificate
    }
    /// The result of the solver: values, contact states, numbers of iterations.
    pub fn solution(&self) -> &Solution<f64> {
        &self.solution
    }
    /// The algebraic inequality.
    pub fn inequality(&self) -> &Inequality<f64> {
        &self.system.inequality
    }
    /// The discretisation: scheme, problem and mesh joined.
    pub fn discretisation(&self) -> &Discretisation<'a, D> {
        &self.system.discretisation
    }
    /// The system: discretisation and inequality.
    pub fn system(&self) -> &System<'a, D> {
        &self.system
    }
    /// The mesh; on a part of a mesh that of the part.
    pub fn mesh(&self) -> &'a Mesh<D> {
        self.system.mesh()
    }
    /// The part of a mesh that this process has; none if it has the whole.
    pub fn part(&self) -> Option<&'a Part<D>> {
        self.system.part()
    }
    /// Warnings by type, as text: a penalty below its proven bound, say.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
    /// Solution, obstacle, multiplier and contact set on cells; none without an iterate.
    pub fn fields(&self) -> Option<Fields> {
        self.has_iterate.then(|| self.discretisation().fields(self.inequality(), &self.solution))
    }
}
