//! The solve of one scheme on one mesh of a nested iteration: start, assembly, initial guess, solver.

use std::sync::Arc;
use std::time::Instant;

use super::hierarchy::Hierarchy;
use super::iteration::NestedIteration;
use super::meshes::unknowns;
use super::p1::P1Solution;
use super::phase::Phase;
use super::solved::Solved;
use super::system::System;
use super::warnings::{
    UNPROVEN, coefficients_on_jumps, data_beyond_coefficients, dirichlet_jumps,
    no_digits_of_quadratics, no_digits_of_stiffness, rounding_of_data, short_edges,
};
use crate::algebra::{Contact, Start};
use crate::error::Error;
use crate::inequality::{InitialGuess, Outcome, Solution};
use crate::real::Precision;
use crate::scheme::Scheme;

/// The ratio of the diameter of a cell to its least height from which the bound looks at a conforming solution beside the
/// means of a function of another scheme (problem stretched of the tests, `cr`).
const STRETCHED: f64 = 16.0;

/// The tolerance of a solve relative to the energy norm of the solution, for the share of the error bound that it may leave.
/// It does for errors of about a thousandth; a second solve would begin anew with its preconditioner.
const FIRST_TOLERANCE: f64 = 1e-5;

/// If it leaves more, half of the tolerance that would have left the share is next, and at most a tenth of the one before.
/// Below the least one the last solve has none.
const SAFETY: f64 = 0.5;
const LARGEST_STEP: f64 = 0.1;
const LEAST_TOLERANCE: f64 = 1e-8;

impl<'a, const D: usize> NestedIteration<'a, D> {
    /// A scheme on a mesh: [`NestedIteration::repeat`] times, with the smallest time.
    fn system(&self, position: usize, scheme: &dyn Scheme<D>) -> Result<System<'a, D>, Error> {
        let assemble = || System::new(scheme, self.p1.problem, self.p1.place(position)?);
        let mut system = assemble()?;
        for _ in 1..self.p1.repeat {
            let again = assemble()?;
            system.assemble_seconds = system.assemble_seconds.min(again.assemble_seconds);
        }
        Ok(system)
    }

    /// The initial guess from the start, whose contact the inequality takes.
    fn guess(&self, start: Option<&P1Solution>, system: &mut System<'_, D>) -> InitialGuess<f64> {
        let mut guess = InitialGuess::default().steps(self.p1.steps.clone());
        // a start without contact stays cold: the solver must detect a body that only contact holds
        let has_contact = |contact: &[Contact]| contact.iter().any(|&c| c != Contact::Inactive);
        if let Some(start) = start {
            if has_contact(&start.contact) {
                let contact = start.contact_of(&system.inequality.locations);
                system.inequality.start = Start::Contact(contact);
            }
            guess.coarse_spaces = start.coarse_spaces.clone();
            guess.values = start.values_of(&system.inequality.locations);
        }
        if let Some(previous) = self.previous(system.inequality.size()) {
            if has_contact(&previous.contact) {
                system.inequality.start = Start::Contact(previous.contact.clone());
            }
            let values = system.with_own_constants(&previous.values, &previous.constants);
            guess.values = Some(values);
        }
        guess
    }

    /// The solution of another problem from which a scheme with so many unknowns starts.
    fn previous(&self, unknowns: usize) -> Option<&Solution<f64>> {
        self.previous.as_ref().filter(|previous| previous.values.len() == unknowns)
    }

    /// The solution on a mesh.
    pub(super) fn solve_scheme(
        &mut self,
        position: usize,
        scheme: &dyn Scheme<D>,
    ) -> Result<Solved<'a, D>, Error> {
        self.enter(Phase::Start);
        let start = self.start(position, scheme)?;
        self.enter(Phase::Assembly);
        let mut system = self.system(position, scheme)?;
        let guess = self.guess(start.as_deref(), &mut system);
        let mut warnings = self.warnings(&system);
        // over parts no solver takes them, and what a part finds by itself is not the same in all
        let of_degree = (scheme.degree(), D);
        let precision = self.p1.solver.precision();
        let refusal = match system.part() {
            None => no_digits_of_quadratics(&system.inequality, of_degree, precision)
                .or_else(|| no_digits_of_stiffness(system.discretisation(), precision)),
            Some(_) => None,
        };
        let is_p1 = scheme.is_conforming_linear(system.mesh());
        let has_other_linears = !is_p1 && scheme.degree() == 1 && system.part().is_none();
        let conforming = match has_other_linears && system.mesh().largest_aspect() > STRETCHED {
            true => self.conforming(position, start.as_deref())?,
            false => Vec::new(),
        };
        self.enter(Phase::Solve);
        let hierarchy = self.hierarchy().map(|hierarchy| (hierarchy, position));
        let (mut solved, solve_seconds) = match &refusal {
            Some(_) => {
                let mut none = Solution::without_iterate(&system.inequality, Outcome::Singular);
                none.precision = precision;
                (Solved::new(system, none, hierarchy), 0.0)
            }
            None => match self.tolerance {
                Some(share) => {
                    self.solve_to_share((system, hierarchy), guess, &conforming, share)?
                }
                None => {
                    let (solution, seconds) = self.run(&system, &guess)?;
                    (Solved::new(system, solution, hierarchy), seconds)
                }
            },
        };
        warnings.extend(refusal);
        if solved.part().is_none() {
            warnings.extend(data_beyond_coefficients(solved.discretisation(), solved.solution()));
            warnings.extend(coefficients_on_jumps(solved.discretisation()));
        }
        solved.warnings = warnings;
        // that of linears holds without it
        if precision == Precision::Single && scheme.degree() > 1 {
            solved.add_rounding_to_algebraic_bound();
        }
        solved.mesh_seconds = self.p1.meshes.seconds(position);
        solved.solve_seconds = solve_seconds;
        solved.conforming = conforming;
        if is_p1 && self.adaptive_meshes().is_some() {
            // every step of an adaptive sequence is solved: the next one starts from here
            self.p1.keep_solved(position, start.as_deref(), &solved);
        }
        if let Some(start) = start {
            // conforming P1 on the same mesh is no coarser level
            let same_mesh = usize::from(!is_p1);
            solved.coarser_levels = start.levels_solved.saturating_sub(same_mesh);
            solved.start_cycles = start.start_cycles;
            solved.start_seconds = start.seconds;
        }
        Ok(solved)
    }

    /// The warnings of a system. Those that a part of a mesh finds by itself differ from part to part.
    fn warnings(&self, system: &System<'_, D>) -> Vec<String> {
        let inequality = &system.inequality;
        if system.part().is_some() {
            let is_unproven = !inequality.is_definite;
            return is_unproven.then(|| UNPROVEN.to_owned()).into_iter().collect();
        }
        let (mesh, discretisation) = (system.mesh(), system.discretisation());
        let mut warnings = dirichlet_jumps(self.p1.problem, mesh);
        if !inequality.is_definite {
            warnings.extend(discretisation.penalty_below_bound().map(|below| below.to_string()));
        }
        let precision = self.p1.solver.precision();
        warnings.extend(rounding_of_data(inequality, precision));
        if self.adaptive_meshes().is_none() {
            let theory = discretisation.form().theory();
            let (length, degree) = (mesh.domain_diameter(), discretisation.space.degree);
            let limit = theory.rounding_limit(precision.epsilon(), length, degree);
            warnings.extend(short_edges(mesh, (limit, precision)));
        }
        warnings
    }

    /// The start: that of P1 for schemes with its unknowns, P1 on the same mesh for all other schemes.
    fn start(
        &mut self,
        position: usize,
        scheme: &dyn Scheme<D>,
    ) -> Result<Option<Arc<P1Solution>>, Error> {
        let mesh = self.p1.meshes.mesh(position);
        let unknowns = unknowns(mesh, scheme.layout());
        let is_known = !self.p1.problem.is_constrained() || self.previous(unknowns).is_some();
        let needs_none = is_known && !self.p1.solver.uses_coarse_spaces(unknowns);
        if self.has_cold_start || needs_none {
            Ok(None)
        } else if scheme.is_conforming_linear(mesh) {
            self.p1.start(position)
        } else {
            self.p1.solve(position).map(Some)
        }
    }

    /// The values at vertices of a conforming function on a mesh: that from which a scheme starts, of an equation, which
    /// needs no start, one that is solved for it. None from a cold start.
    fn conforming(
        &mut self,
        position: usize,
        start: Option<&P1Solution>,
    ) -> Result<Vec<f64>, Error> {
        let is_equation = !self.p1.problem.is_constrained() && !self.has_cold_start;
        match start {
            Some(start) => Ok(start.values.clone()),
            None if is_equation => Ok(self.p1.solve(position)?.values.clone()),
            None => Ok(Vec::new()),
        }
    }

    /// Solves [`NestedIteration::repeat`] times and returns the last solution with the smallest time, and with the
    /// history of one more solve if it is asked for.
    fn run(
        &self,
        system: &System<'_, D>,
        guess: &InitialGuess<f64>,
    ) -> Result<(Solution<f64>, f64), Error> {
        let (mut solution, seconds) = self.p1.repeated(|| self.p1.solver.solve(system, guess))?;
        if self.keeps_history {
            let guess = guess.clone().keeps_history(true);
            let again = self.p1.solver.solve(system, &guess)?;
            debug_assert_eq!((again.outer, again.systems), (solution.outer, solution.systems));
            solution.history = again.history;
        }
        Ok((solution, seconds))
    }

    /// Solves a system, each time from the solution before, until the algebraic error is at most a share of the error bound
    /// ([`Solved::algebraic_share`]). Counts are those of all solves, seconds those of all solves and of the bounds between them.
    fn solve_to_share(
        &self,
        (mut system, hierarchy): (System<'a, D>, Option<(&'a Hierarchy<D>, usize)>),
        mut guess: InitialGuess<f64>,
        conforming: &[f64],
        share: f64,
    ) -> Result<(Solved<'a, D>, f64), Error> {
        let (mut outer, mut linear, mut systems, mut stages) = (0, 0, Some(0), Vec::new());
        let mut seconds = 0.0;
        guess.energy_tolerance = Some(FIRST_TOLERANCE * share);
        loop {
            let (mut solution, of_solve) = self.run(&system, &guess)?;
            seconds += of_solve;
            (outer, linear) = (outer + solution.outer, linear + solution.linear);
            systems = systems.zip(solution.systems).map(|(before, own)| before + own);
            stages.append(&mut solution.stages);
            let is_found = solution.outcome == Outcome::Converged;
            let mut solved = Solved::new(system, solution, hierarchy);
            solved.conforming = conforming.to_vec();
            let clock = Instant::now();
            let left = solved.solution.algebraic_bound.filter(|_| is_found);
            let own = left.and_then(|_| solved.algebraic_share());
            let is_small = own.is_some_and(|own| own <= share);
            if is_small || guess.energy_tolerance.is_none() {
                let solution = &mut solved.solution;
                (solution.outer, solution.linear) = (outer, linear);
                (solution.systems, solution.stages) = (systems, stages);
                if is_small {
                    solution.outcome = Outcome::Converged;
                }
                return Ok((solved, seconds));
            }
            seconds += clock.elapsed().as_secs_f64();
            // the share is proportional to what the solver leaves
            let wanted = left.zip(own).map(|(left, own)| left * SAFETY * share / own);
            let next = wanted.zip(guess.energy_tolerance).map(|(x, t)| x.min(LARGEST_STEP * t));
            guess.energy_tolerance = next.filter(|next| *next >= LEAST_TOLERANCE);
            let (before, values, contact) = solved.into_system();
            system = before;
            if is_found {
                guess.values = Some(values);
                system.inequality.start = Start::Contact(contact);
            }
        }
    }
}
