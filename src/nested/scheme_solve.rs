//! The solve of one scheme on one mesh of a nested iteration: start, assembly, initial guess, solver.

use std::sync::Arc;
use std::time::Instant;

use super::iteration::NestedIteration;
use super::meshes::{Meshes, unknowns};
use super::p1::P1Solution;
use super::phase::Phase;
use super::solved::Solved;
use super::warnings::{
    active_sets, dirichlet_jumps, no_digits_of_quadratics, rounding_of_data, short_edges,
};
use crate::algebra::{Contact, Inequality, Start};
use crate::assemble::Discretisation;
use crate::error::Error;
use crate::inequality::{InitialGuess, Outcome, Solution};
use crate::mesh::Mesh;
use crate::scheme::Scheme;

impl<'a, const D: usize> NestedIteration<'a, D> {
    /// A scheme on a mesh, and its inequality: [`NestedIteration::repeat`] times, with the smallest time.
    fn assembled(
        &self,
        scheme: &dyn Scheme<D>,
        mesh: &'a Mesh<D>,
    ) -> Result<(Discretisation<'a, D>, Inequality<f64>, f64), Error> {
        let discretise = || Discretisation::new(scheme, self.p1.problem, mesh, self.p1.quadrature);
        let clock = Instant::now();
        let discretisation = discretise()?;
        let inequality = discretisation.inequality()?;
        let mut seconds = clock.elapsed().as_secs_f64();
        for _ in 1..self.p1.repeat {
            let clock = Instant::now();
            drop(discretise()?.inequality()?);
            seconds = seconds.min(clock.elapsed().as_secs_f64());
        }
        Ok((discretisation, inequality, seconds))
    }

    /// The initial guess from the start, whose contact the inequality takes.
    fn guess(
        &self,
        start: Option<&P1Solution>,
        inequality: &mut Inequality<f64>,
    ) -> InitialGuess<f64> {
        let mut guess = InitialGuess::default().steps(self.p1.steps.clone());
        if let Some(start) = start {
            // a start without contact stays cold: the solver must detect a body that only contact holds
            if start.contact.iter().any(|&c| c != Contact::Inactive) {
                inequality.start = Start::Contact(start.contact_of(&inequality.supports));
            }
            guess.coarse_spaces = start.coarse_spaces.clone();
            guess.values = start.values_of(&inequality.supports);
        }
        guess
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
        let mesh = self.p1.meshes.mesh(position);
        let (mut discretisation, mut inequality, assemble_seconds) =
            self.assembled(scheme, mesh)?;
        discretisation.forget_prepared();
        let guess = self.guess(start.as_deref(), &mut inequality);
        let mut warnings = dirichlet_jumps(self.p1.problem, mesh);
        let penalty_below_bound = discretisation.penalty_below_bound();
        warnings.extend(penalty_below_bound.as_ref().map(ToString::to_string));
        let precision = self.p1.solver.precision();
        warnings.extend(rounding_of_data(&inequality, precision));
        let is_adaptive = matches!(self.p1.meshes, Meshes::Adaptive(_));
        if !is_adaptive {
            let theory = discretisation.form().theory();
            let limit = theory.rounding_limit(precision.epsilon(), mesh.domain_diameter());
            warnings.extend(short_edges(mesh, (limit, precision)));
        }
        inequality.is_definite = penalty_below_bound.is_none() && discretisation.is_coercive();
        let refusal = no_digits_of_quadratics(&inequality, (scheme.degree(), D), precision);
        self.enter(Phase::Solve);
        let (solution, solve_seconds) = match &refusal {
            Some(_) => (Solution::without_iterate(&inequality, Outcome::Singular), 0.0),
            None => self.run(&mut inequality, &guess),
        };
        warnings.extend(refusal);
        warnings.extend(active_sets(&solution, self.p1.problem, scheme));
        let hierarchy = self.hierarchy(position);
        let mut solved = Solved::new(discretisation, inequality, solution, hierarchy);
        solved.warnings = warnings;
        solved.mesh_seconds = self.p1.meshes.seconds(position);
        (solved.assemble_seconds, solved.solve_seconds) = (assemble_seconds, solve_seconds);
        let is_p1 = scheme.is_conforming_linear(mesh);
        if is_p1 && is_adaptive {
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

    /// The start: that of P1 for schemes with its unknowns, P1 on the same mesh for all other schemes.
    fn start(
        &mut self,
        position: usize,
        scheme: &dyn Scheme<D>,
    ) -> Result<Option<Arc<P1Solution>>, Error> {
        let mesh = self.p1.meshes.mesh(position);
        let unknowns = unknowns(mesh, scheme.layout());
        let needs_none =
            !self.p1.problem.is_constrained() && !self.p1.solver.uses_coarse_spaces(unknowns);
        if self.has_cold_start || needs_none {
            Ok(None)
        } else if scheme.is_conforming_linear(mesh) {
            self.p1.start(position)
        } else {
            self.p1.solve(position).map(Some)
        }
    }

    /// Solves [`NestedIteration::repeat`] times and returns the last solution with the smallest time.
    fn run(
        &self,
        inequality: &mut Inequality<f64>,
        guess: &InitialGuess<f64>,
    ) -> (Solution<f64>, f64) {
        let mut seconds = f64::INFINITY;
        let mut last = None;
        for _ in 0..self.p1.repeat {
            let clock = Instant::now();
            last = Some(self.p1.solver.solve_from(inequality, guess));
            seconds = seconds.min(clock.elapsed().as_secs_f64());
        }
        match last {
            Some(solution) => (solution, seconds),
            None => unreachable!("at least one run"),
        }
    }
}
