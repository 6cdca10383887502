//! Truncated nonsmooth Newton multigrid: a descent method that does not depend on strict
//! complementarity.
//!
//! | file | content |
//! |---|---|
//! | `settings` | [`MonotoneMultigrid`], the settings |
//! | `mod` | the method as a solver |
//! | `iteration` | cycles until a tolerance, with the preconditioner and the criteria of convergence and stagnation |
//! | `cycle` | one cycle: sweeps, linear correction, line search |

mod cycle;
mod iteration;
mod settings;

use super::history::Recorder;
use super::initial_guess::InitialGuess;
use super::recession::solve_with_kernel;
use super::validation::check;
use super::{ActiveSet, InequalitySolver, Outcome, Solution};
use crate::algebra::Inequality;
use crate::instances::compiled;
use crate::real::Real;
use cycle::MultigridIterate;
pub use settings::MonotoneMultigrid;

impl<T: Real> InequalitySolver<T> for MonotoneMultigrid {
    fn name(&self) -> &'static str {
        "monotone-multigrid"
    }

    fn solve(&self, inequality: &Inequality<T>) -> Solution<T> {
        self.solve_from(inequality, &InitialGuess::default())
    }

    /// Solves the inequality. [`ActiveSet`] solves that of one part of a mesh, which has no coarse spaces here.
    fn solve_from(&self, inequality: &Inequality<T>, guess: &InitialGuess<T>) -> Solution<T> {
        if inequality.symmetric && inequality.is_in_parts() {
            return ActiveSet::default().solve_from(inequality, guess);
        }
        compiled!(
            T: fn(&MonotoneMultigrid, &Inequality<T>, &InitialGuess<T>) -> Solution<T>
                = |method, inequality, guess| {
                    solve_with_kernel(inequality, guess, |inequality, recorder| {
                        method.run_cycles(inequality, guess, recorder)
                    })
                }
        )(self, inequality, guess)
    }

    fn uses_coarse_spaces(&self, _unknowns: usize) -> bool {
        true
    }
}

impl MonotoneMultigrid {
    /// The solution by cycles. The recorder contains the steps of all stages before this one. A matrix that is not
    /// symmetric has no energy: the outcome is [`Outcome::Unsuitable`].
    pub(super) fn run_cycles<T: Real>(
        &self,
        inequality: &Inequality<T>,
        guess: &InitialGuess<T>,
        recorder: &Recorder<'_>,
    ) -> Solution<T> {
        if !inequality.symmetric {
            return Solution::without_iterate(inequality, Outcome::Unsuitable);
        }
        if let Err(outcome) = check(inequality) {
            return Solution::without_iterate(inequality, outcome);
        }
        let mut iterate = MultigridIterate::new(inequality, guess);
        let outcome = iterate.run(self, guess, recorder).unwrap_or_else(|outcome| outcome);
        iterate.into_solution(outcome)
    }
}
