//! The solve of an inequality by the stages of [`strategy`](super::strategy).
//!
//! | file | content |
//! |---|---|
//! | `mod` | the check of the input, the stages in their order, the outcome |
//! | `state` | the state of a solve between two stages |
//! | `stage_runs` | the run of each stage |

mod stage_runs;
pub(super) mod state;

use super::settings::{ActiveSet, Globalisation};
use super::strategy::{STRATEGY, is_preconditioned};
use crate::algebra::{Inequality, Start};
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::validation::{check_definite, check_input};
use crate::inequality::{Outcome, Solution, Stage};
use crate::linear::PreconditionerFamily;
use crate::real::Real;
use state::{Solve, StageResult};

/// Solves an inequality by the stages of [`STRATEGY`].
pub(super) fn solve<T: Real>(
    settings: &ActiveSet,
    inequality: &Inequality<T>,
    guess: &InitialGuess<T>,
    family: &dyn PreconditionerFamily<T>,
) -> Solution<T> {
    guess.steps.set(0);
    let is_preconditioned = is_preconditioned(settings, inequality, guess);
    let values = match &guess.values {
        Some(values) if is_preconditioned => values.as_slice(),
        _ => &[],
    };
    if let Err(outcome) = check(settings, inequality, is_preconditioned) {
        return Solution::without_iterate(inequality, outcome);
    }
    let mut solve = Solve::new(settings, inequality, guess, family, values);
    let result = solve.run_stages();
    let mut result = result.unwrap_or_else(|| StageResult::new(solve.outcome_without_solution()));
    // a matrix that is not symmetric, although it is declared so, explains a failure
    if result.outcome != Outcome::Converged
        && inequality.symmetric
        && inequality.distribution.is_none()
        && !inequality.matrix.is_symmetric()
    {
        result.outcome = Outcome::Malformed;
    }
    solve.into_solution(result)
}

impl<T: Real> Solve<'_, '_, T> {
    /// Runs the stages that apply, until one of them ends the solve; `None` if none does.
    fn run_stages(&mut self) -> Option<StageResult> {
        for stage in STRATEGY {
            if self.applies(stage)
                && let Some(result) = self.run(stage)
            {
                return Some(result);
            }
        }
        if self.may_continue_direct() { self.run(Stage::DirectActiveSet) } else { None }
    }
}

/// Checks the input, and whether the matrix is positive definite, unless this is known or the matrix is distributed: if
/// `check_definite` is set, and for a symmetric matrix with a start in contact, whose linear systems do not contain the
/// directions of active unknowns. With a cold start the active set iteration with factors begins with the Cholesky
/// factors on all free unknowns, which are such a check; a Krylov method or a first interior point method does not.
///
/// # Errors
/// The outcome that the solver returns.
fn check<T: Real>(
    settings: &ActiveSet,
    inequality: &Inequality<T>,
    is_preconditioned: bool,
) -> Result<(), Outcome> {
    over_all_parts(inequality, check_input(inequality))?;
    if inequality.distribution.is_some() {
        // there are no factors of a distributed matrix; Krylov methods detect directions that are not positive
        return Ok(());
    }
    let is_cold = inequality.start == Start::Cold;
    let is_required = match inequality.symmetric {
        true => {
            let is_factored =
                !is_preconditioned && settings.globalisation != Globalisation::InteriorPointFirst;
            !is_cold || (settings.check_definite && !is_factored)
        }
        false => settings.check_definite,
    };
    if is_required && !inequality.is_definite { check_definite(inequality) } else { Ok(()) }
}

/// The result of a check in all parts: of the outcomes of the parts the one that comes last in `OUTCOMES`, or
/// [`Outcome::NotFinite`] if messages between the parts fail.
fn over_all_parts<T: Real>(
    inequality: &Inequality<T>,
    checked: Result<(), Outcome>,
) -> Result<(), Outcome> {
    const OUTCOMES: [Outcome; 4] =
        [Outcome::OutOfRange, Outcome::Infeasible, Outcome::NotFinite, Outcome::Malformed];
    let Some(distribution) = inequality.distribution() else { return checked };
    let code = |outcome: Outcome| OUTCOMES.iter().position(|&other| other == outcome);
    let mut largest = [checked.err().map_or(0, |outcome| code(outcome).unwrap_or(0) + 1) as f64];
    distribution.largest(&mut largest);
    match largest[0] as usize {
        0 if largest[0] == 0.0 => Ok(()),
        // not a number
        0 => Err(Outcome::NotFinite),
        code => Err(OUTCOMES[code - 1]),
    }
}
