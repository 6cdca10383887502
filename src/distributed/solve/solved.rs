//! The result of a solve over the parts of a mesh.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Instant;

use super::over_parts::OverParts;
use super::system::System;
use crate::algebra::{Contact, Distribution, Inequality, any_part};
use crate::assemble::Discretisation;
use crate::distributed::agree::{agree, agree_on_data};
use crate::distributed::error::ExchangeError;
use crate::distributed::exchange::Exchange;
use crate::distributed::merge::merge_all;
use crate::error_bound::{BoundFigures, ErrorBound, PrimalDualPair, TrueErrors};
use crate::inequality::{Certificate, Outcome, Solution, certify_solution, energy_norm};
use crate::measure::{Errors, Penetration, Rounding, SquaredErrors};
use crate::mesh::Part;

/// A discrete solution on one part of a mesh. Errors, totals and certificate are those of all parts; the
/// functions that compute them all parts call.
#[non_exhaustive]
pub struct DistributedSolved<'a, const D: usize> {
    system: System<'a, D>,
    part: &'a Part<D>,
    solution: Solution<f64>,
    certificate: Certificate,
    has_iterate: bool,
    /// Seconds of this part for its meshes up to this one.
    pub mesh_seconds: f64,
    /// Seconds of assembly.
    pub assemble_seconds: f64,
    /// Seconds for the numbers of unknowns over all parts.
    pub numbering_seconds: f64,
    /// Seconds of the start: the P1 solutions on this and all coarser meshes.
    pub start_seconds: f64,
    /// Seconds of the solve with its auxiliary matrices.
    pub solve_seconds: f64,
    /// Bytes that this part sent in the solve.
    pub(super) sent_bytes: u64,
}

impl<const D: usize> fmt::Debug for DistributedSolved<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DistributedSolved")
            .field("own_unknowns", &self.own_unknowns())
            .field("outcome", &self.outcome())
            .field("certificate", &self.certificate)
            .finish_non_exhaustive()
    }
}

impl<'a, const D: usize> DistributedSolved<'a, D> {
    /// A solution with its certificate.
    pub(super) fn new(
        system: System<'a, D>,
        part: &'a Part<D>,
        mut solution: Solution<f64>,
    ) -> Self {
        solution.contact = contact_of_owners(&solution.contact, &system.over_parts);
        let Solution { values, outcome, .. } = &solution;
        let over_parts: &dyn Distribution = &*system.over_parts;
        let is_finite = values.iter().all(|v| v.is_finite());
        let has_iterate = outcome.has_iterate() && !any_part(Some(over_parts), !is_finite);
        let certificate = match has_iterate {
            true => certify_solution(&system.inequality, &solution),
            false => Certificate::INVALID,
        };
        if solution.outcome == Outcome::Converged
            && !certificate.is_within_limits(solution.precision)
        {
            // whatever a solver says of itself
            solution.outcome = Outcome::Stalled;
        }
        let [assemble_seconds, numbering_seconds] = system.seconds;
        Self {
            system,
            part,
            solution,
            certificate,
            has_iterate,
            mesh_seconds: 0.0,
            assemble_seconds,
            numbering_seconds,
            start_seconds: 0.0,
            solve_seconds: 0.0,
            sent_bytes: 0,
        }
    }

    /// How the solve ended.
    pub fn outcome(&self) -> Outcome {
        self.solution.outcome
    }
    /// Whether the solve converged.
    pub fn converged(&self) -> bool {
        self.outcome() == Outcome::Converged
    }
    /// Whether there are values to evaluate: as [`Solved::has_iterate`](crate::nested::Solved::has_iterate).
    pub fn has_iterate(&self) -> bool {
        self.has_iterate
    }
    /// The certificate, over all parts.
    pub fn certificate(&self) -> Certificate {
        self.certificate
    }
    /// The solution on this part: values and contact states of own unknowns and of ghosts.
    pub fn solution(&self) -> &Solution<f64> {
        &self.solution
    }
    /// The inequality of this part.
    pub fn inequality(&self) -> &Inequality<f64> {
        &self.system.inequality
    }
    /// The scheme on this part.
    pub fn discretisation(&self) -> &Discretisation<'a, D> {
        &self.system.discretisation
    }
    /// The part.
    pub fn part(&self) -> &'a Part<D> {
        self.part
    }
    /// The numbers of the unknowns of this part among those of all parts.
    pub fn numbers(&self) -> &[u64] {
        self.system.over_parts.numbering.numbers()
    }
    /// The own unknowns, in the order of their numbers.
    pub(super) fn own(&self) -> &[u32] {
        self.system.over_parts.numbering.own()
    }
    pub(super) fn exchange(&self) -> &dyn Exchange {
        &*self.system.over_parts.exchange
    }
    /// The bytes that this part sent to others in the solve; messages inside the engine do not count.
    pub fn sent_bytes(&self) -> u64 {
        self.sent_bytes
    }
    /// The number of unknowns of this part, and that of its ghosts.
    pub fn own_unknowns(&self) -> [usize; 2] {
        let own = self.system.over_parts.numbering.own().len();
        [own, self.system.inequality.size() - own]
    }

    /// Numbers of this part summed over all parts.
    fn sums<const N: usize>(&self, mut own: [f64; N]) -> [f64; N] {
        self.system.over_parts.sum(&mut own);
        own
    }
    /// The numbers of cells, unknowns and stored entries of the matrix of all parts.
    pub fn sizes(&self) -> [u64; 3] {
        let numbering = &self.system.over_parts.numbering;
        let cells = self.part.owners.iter().filter(|&&owner| owner == self.part.number).count();
        let in_row = |&i: &u32| self.system.inequality.matrix.row(i as usize).0.len();
        let entries: usize = numbering.own().iter().map(in_row).sum();
        self.sums([cells as f64, numbering.own().len() as f64, entries as f64]).map(|x| x as u64)
    }
    /// The number of constrained unknowns in contact in all parts.
    pub fn active(&self) -> u64 {
        let bounds = &self.system.inequality.bounds;
        let is_active = |&&i: &&u32| {
            let i = i as usize;
            bounds[i].is_inequality() && self.solution.contact[i] != Contact::Inactive
        };
        let own = self.own().iter().filter(is_active).count();
        self.sums([own as f64])[0] as u64
    }
    /// The objective of all parts; none for schemes that are not symmetric.
    pub fn objective(&self) -> Option<f64> {
        let Inequality { symmetric, .. } = self.system.inequality;
        symmetric.then(|| self.system.inequality.objective(&self.solution.values))
    }
    /// The total contact force on all parts: see [`Discretisation::resultant`].
    pub fn resultant(&self) -> Option<f64> {
        let System { discretisation, inequality, .. } = &self.system;
        let multipliers = discretisation.multipliers(inequality, &self.solution)?;
        let own = self.own().iter().map(|&i| multipliers[i as usize]);
        Some(self.sums([own.sum::<f64>()])[0])
    }
    /// The resultant of each obstacle and each contact group on all parts, see [`Discretisation::resultants`]; none
    /// without an inequality.
    pub fn resultants(&self) -> Option<BTreeMap<String, f64>> {
        let System { discretisation, inequality, .. } = &self.system;
        let mut is_own = vec![false; inequality.size()];
        self.own().iter().for_each(|&i| is_own[i as usize] = true);
        let own: [&dyn Fn(usize) -> bool; 2] = [&|i| is_own[i], &|cell| self.part.owns(cell)];
        let mut resultants = discretisation.resultants_of(inequality, &self.solution, own)?;
        // all parts have the groups of the whole mesh, but not all have facets of each
        for name in discretisation.names_of_resultants() {
            let of_all = resultants.entry(name).or_default();
            *of_all = self.sums([*of_all])[0];
        }
        Some(resultants)
    }
    /// The measure of the discrete contact set of all parts; none without an inequality.
    pub fn contact_measure(&self) -> Option<f64> {
        let System { discretisation, inequality, .. } = &self.system;
        let counts = |cell: usize| self.part.owns(cell);
        let own = discretisation.contact_measure_of(inequality, &self.solution, &counts)?;
        Some(self.sums([own])[0])
    }
    /// How far the solution lies beyond obstacles and gaps on all parts, see [`Discretisation::penetration`]; none
    /// without an inequality.
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] in all parts for data that are not finite.
    pub fn penetration(&self) -> Result<Option<Penetration>, ExchangeError> {
        let part = self.part;
        let u = &self.solution.values;
        let own = self
            .system
            .discretisation
            .penetration_of((u, self.solution.precision), &|cell| part.owns(cell));
        let Some(own) = agree_on_data(own, &part.cells, self.exchange())? else { return Ok(None) };
        let most = self.exchange().largest(&own.numbers())?;
        let mut numbers = own.numbers();
        numbers.iter_mut().zip(most).for_each(|(number, most)| *number = most);
        Ok(Some(own.with_numbers(numbers)))
    }
    /// The energy of the solution on all parts, by one formula for every scheme: see
    /// [`Discretisation::energy`].
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] in all parts for data that are not finite.
    pub fn energy(&self) -> Result<f64, ExchangeError> {
        let part = self.part;
        let own =
            self.system.discretisation.energy_of(&self.solution.values, &|cell| part.owns(cell));
        let own = agree_on_data(own, &part.cells, self.exchange())?;
        Ok(self.exchange().sum(&[own])?[0])
    }
    /// A guaranteed bound on the error of linear functions, over all parts, with the shares of own cells in it: see
    /// [`error_bound`](crate::error_bound). Multipliers are exchanged for flux inside parts alone, so that the bound
    /// depends on these a little.
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] in all parts where there is no bound.
    pub fn bound(&self) -> Result<ErrorBound, ExchangeError> {
        self.pair_and_bound().map(|(_, bound)| bound)
    }
    /// The pair of linear functions of which the bound is made, right on own cells alone: see
    /// [`primal_dual_pair`](Discretisation::primal_dual_pair).
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] in all parts where there is no pair.
    pub fn primal_dual_pair(&self) -> Result<PrimalDualPair<D>, ExchangeError> {
        let System { discretisation, inequality, .. } = &self.system;
        let counts = |cell| self.part.owns(cell);
        let pair = discretisation.pair_on_part(inequality, &self.solution, &counts);
        agree(pair, self.exchange())
    }
    fn pair_and_bound(&self) -> Result<(PrimalDualPair<D>, ErrorBound), ExchangeError> {
        let System { discretisation, over_parts, .. } = &self.system;
        let (part, exchange) = (self.part, self.exchange());
        let counts = |cell| part.owns(cell);
        let pair = self.primal_dual_pair()?;
        let own = discretisation.part_of_bound(&pair, &self.solution.values, &counts);
        let bound = agree(own, exchange)?.over_parts(&**over_parts);
        Ok((pair, agree(bound, exchange)?))
    }
    /// The errors against the exact solution, none without one, and the figures of the bound with the seconds that it
    /// takes this part.
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] in all parts for data that are not finite.
    pub(crate) fn errors_and_bound(&self) -> Result<(Errors, BoundFigures, f64), ExchangeError> {
        let discretisation = &self.system.discretisation;
        let clock = Instant::now();
        let bound = self.pair_and_bound();
        let seconds = clock.elapsed().as_secs_f64();
        let pair = bound.as_ref().ok().map(|(pair, _)| pair);
        let squares = self.squared_errors(pair)?;
        let bound = bound.as_ref().map(|(_, bound)| bound).map_err(|error| match error {
            ExchangeError::Failed { message, .. } => message.clone(),
            other => other.to_string(),
        });
        let has_exact = discretisation.problem().exact.is_some();
        let errors = if has_exact { squares.norms() } else { Errors::default() };
        let of_v = (has_exact && bound.is_ok()).then(|| squares.of_function());
        let true_errors = TrueErrors { of_solution: errors.broken_energy, of_v };
        let sizes = (self.energy_norm(), self.rounding());
        Ok((errors, BoundFigures::of_solution(bound, true_errors, sizes), seconds))
    }
    fn energy_norm(&self) -> f64 {
        let System { inequality, .. } = &self.system;
        energy_norm(inequality, &self.solution)
    }
    /// Rounding errors in the figures of the solution over all parts.
    pub fn rounding(&self) -> Option<Rounding> {
        let System { discretisation, inequality, .. } = &self.system;
        let of = (self.sizes()[0] as usize, self.energy_norm());
        discretisation.rounding(inequality, &self.solution, of)
    }
    /// The errors against the exact solution; none without one.
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] in all parts for data that are not finite.
    pub fn errors(&self) -> Result<Errors, ExchangeError> {
        match self.system.discretisation.problem().exact {
            Some(_) => Ok(self.squared_errors(None)?.norms()),
            None => Ok(Errors::default()),
        }
    }
    /// The squared errors of the solution and of the function of a pair over all parts; zero without an exact solution.
    fn squared_errors(
        &self,
        pair: Option<&PrimalDualPair<D>>,
    ) -> Result<SquaredErrors, ExchangeError> {
        let (part, u) = (self.part, &self.solution.values);
        let discretisation = &self.system.discretisation;
        let own = discretisation.squared_errors_beside(Some(u), pair, &|cell| part.owns(cell));
        merge_all(&agree_on_data(own, &part.cells, self.exchange())?, self.exchange())
    }
}

/// Contact states, those of ghosts by their owners.
pub(super) fn contact_of_owners(contact: &[Contact], over_parts: &OverParts) -> Vec<Contact> {
    let number = |&state: &Contact| match state {
        Contact::Inactive => 0.0,
        Contact::Lower => 1.0,
        Contact::Upper => 2.0,
    };
    let mut states: Vec<f64> = contact.iter().map(number).collect();
    (over_parts as &dyn Distribution).update(&mut states);
    let state = |&number: &f64| match number {
        1.0 => Contact::Lower,
        2.0 => Contact::Upper,
        _ => Contact::Inactive,
    };
    states.iter().map(state).collect()
}
