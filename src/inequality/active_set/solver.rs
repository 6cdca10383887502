//! The active set method as a solver of inequalities, with the preconditioners of this library or with
//! others.

use super::ladder::{CROSSOVER, solve};
use super::settings::ActiveSet;
use crate::algebra::Inequality;
use crate::inequality::recession::solve_with_kernel;
use crate::inequality::{InequalitySolver, InitialGuess, Solution};
use crate::instances::compiled;
use crate::linear::{BuiltInPreconditioners, LinearMethod, PreconditionerFamily};
use crate::real::Real;

impl ActiveSet {
    /// The method with preconditioners of another family.
    #[must_use]
    pub fn with_preconditioners<P>(self, family: P) -> Preconditioned<P> {
        Preconditioned { settings: self, family }
    }
}

impl<T: Real> InequalitySolver<T> for ActiveSet {
    fn name(&self) -> &'static str {
        "active-set"
    }

    fn solve(&self, inequality: &Inequality<T>) -> Solution<T> {
        self.solve_from(inequality, &InitialGuess::default())
    }

    fn solve_from(&self, inequality: &Inequality<T>, guess: &InitialGuess<T>) -> Solution<T> {
        solve_with(self, inequality, guess, &BuiltInPreconditioners)
    }

    fn uses_coarse_spaces(&self, unknowns: usize) -> bool {
        match self.linear {
            LinearMethod::Direct => false,
            LinearMethod::Iterative => true,
            LinearMethod::BySize => unknowns >= CROSSOVER,
        }
    }
}

/// [`ActiveSet`] with preconditioners of a family `P`: [`ActiveSet::with_preconditioners`].
#[derive(Clone, Debug, PartialEq)]
pub struct Preconditioned<P> {
    settings: ActiveSet,
    family: P,
}

impl<T: Real, P: PreconditionerFamily<T>> InequalitySolver<T> for Preconditioned<P> {
    fn name(&self) -> &'static str {
        self.family.name()
    }

    fn solve(&self, inequality: &Inequality<T>) -> Solution<T> {
        self.solve_from(inequality, &InitialGuess::default())
    }

    fn solve_from(&self, inequality: &Inequality<T>, guess: &InitialGuess<T>) -> Solution<T> {
        solve_with(&self.settings, inequality, guess, &self.family)
    }

    fn uses_coarse_spaces(&self, unknowns: usize) -> bool {
        <ActiveSet as InequalitySolver<T>>::uses_coarse_spaces(&self.settings, unknowns)
    }
}

fn solve_with<T: Real>(
    settings: &ActiveSet,
    inequality: &Inequality<T>,
    guess: &InitialGuess<T>,
    family: &dyn PreconditionerFamily<T>,
) -> Solution<T> {
    compiled!(
        T: fn(
            &ActiveSet,
            &Inequality<T>,
            &InitialGuess<T>,
            &dyn PreconditionerFamily<T>,
        ) -> Solution<T>
            = |settings, inequality, guess, family| solve_with_kernel(inequality, guess, |inequality, recorder| {
                solve(settings, inequality, (guess, recorder), family)
            })
    )(settings, inequality, guess, family)
}
