//! The choice between the direct and the inexact driver of the active set method, and the fallback
//! from the inexact to the direct one.

use super::ActiveSet;
use super::direct_driver::DirectDriver;
use super::direct_iterate::DirectIterate;
use super::inexact_driver::{Failure, InexactDriver};
use crate::algebra::{Contact, Inequality, Start};
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::monotone_multigrid::MonotoneMultigrid;
use crate::inequality::validation::{check_definite, check_input};
use crate::inequality::{InequalitySolver, Outcome, Solution};
use crate::instances::compiled;
use crate::linear::{CoarseSpaces, LinearMethod};
use crate::real::Real;

/// Number of unknowns from which the iterative solver is faster, given nested meshes.
const CROSSOVER: usize = 10_000;

impl<T: Real> InequalitySolver<T> for ActiveSet {
    fn name(&self) -> &'static str {
        "active-set"
    }

    fn solve(&self, inequality: &Inequality<T>) -> Solution<T> {
        self.solve_from(inequality, &InitialGuess::default())
    }

    fn solve_from(&self, inequality: &Inequality<T>, guess: &InitialGuess<T>) -> Solution<T> {
        compiled!(
            T: fn(&ActiveSet, &Inequality<T>, &InitialGuess<T>) -> Solution<T>
                = ActiveSet::choose_and_solve
        )(self, inequality, guess)
    }

    fn uses_coarse_spaces(&self, unknowns: usize) -> bool {
        match self.linear {
            LinearMethod::Direct => false,
            LinearMethod::Iterative => true,
            LinearMethod::BySize => unknowns >= CROSSOVER,
        }
    }
}

impl ActiveSet {
    fn choose_and_solve<T: Real>(
        &self,
        inequality: &Inequality<T>,
        guess: &InitialGuess<T>,
    ) -> Solution<T> {
        let may_iterate =
            <Self as InequalitySolver<T>>::uses_coarse_spaces(self, inequality.size());
        let has_coarse_spaces = !matches!(guess.coarse_spaces, CoarseSpaces::Unknown);
        let is_iterative =
            may_iterate && (has_coarse_spaces || self.linear == LinearMethod::Iterative);
        if is_iterative && check_input(inequality).is_ok() {
            return match self.solve_inexactly(inequality, guess) {
                Ok(solution) => solution,
                Err(failure) => self.fall_back(inequality, guess, failure),
            };
        }
        self.solve_directly(inequality, None)
    }

    /// The active set method with preconditioned Krylov methods, without factors of the matrix.
    ///
    /// # Errors
    /// [`Failure`] if another method must follow.
    fn solve_inexactly<T: Real>(
        &self,
        inequality: &Inequality<T>,
        guess: &InitialGuess<T>,
    ) -> Result<Solution<T>, Failure> {
        if self.check_definite && check_definite(inequality).is_err() {
            return Err(Failure::default());
        }
        InexactDriver::new(self, inequality, guess).run()
    }

    /// The solution after a failure of the inexact method: by monotone multigrid if the active set
    /// stagnated, the matrix is symmetric and the unknowns are conforming P1 on nested meshes; else, or
    /// if monotone multigrid does not converge, with factors. Iterations of all methods are added.
    fn fall_back<T: Real>(
        &self,
        inequality: &Inequality<T>,
        guess: &InitialGuess<T>,
        failure: Failure,
    ) -> Solution<T> {
        let Failure { mut outer, mut linear, last_active_set } = failure;
        let mut found = None;
        if last_active_set.is_some()
            && inequality.symmetric
            && matches!(guess.coarse_spaces, CoarseSpaces::CoarseLevel(_))
        {
            let solution = MonotoneMultigrid::default().solve_from(inequality, guess);
            if solution.outcome == Outcome::Converged {
                found = Some(solution);
            } else {
                (outer, linear) = (outer + solution.outer, linear + solution.linear);
            }
        }
        let mut solution =
            found.unwrap_or_else(|| self.solve_directly(inequality, last_active_set));
        solution.outer += outer;
        solution.linear += linear;
        solution
    }

    /// The active set method with factors of the matrix, from the active set `stagnated` of the inexact
    /// method if it is given, else from the start of the inequality.
    fn solve_directly<T: Real>(
        &self,
        inequality: &Inequality<T>,
        stagnated: Option<Vec<Contact>>,
    ) -> Solution<T> {
        let mut iterate = DirectIterate::new(inequality);
        let outcome = match (self.check(inequality), stagnated) {
            (Ok(()), None) => DirectDriver::new(self, &mut iterate).run(),
            (Ok(()), Some(states)) => {
                iterate.states = states;
                DirectDriver::new(self, &mut iterate).after_stagnation().run()
            }
            (Err(outcome), _) => outcome,
        };
        iterate.into_solution(outcome)
    }

    /// Checks the input, and definiteness where a setting requires it; a cold start with a
    /// symmetric matrix begins with a Cholesky factorisation on all free unknowns, which is such a
    /// check itself.
    ///
    /// # Errors
    /// The outcome that the solver returns.
    fn check<T: Real>(&self, inequality: &Inequality<T>) -> Result<(), Outcome> {
        check_input(inequality)?;
        let is_checked_by_factors = inequality.start == Start::Cold && inequality.symmetric;
        if self.check_definite && !is_checked_by_factors {
            check_definite(inequality)?;
        }
        Ok(())
    }
}
