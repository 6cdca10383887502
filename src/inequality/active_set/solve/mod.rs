//! The solve of an inequality by the stages of [`strategy`](super::strategy).
//!
//! | file | content |
//! |---|---|
//! | `mod` | the check of the input, the stages in turn, the outcome |
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
use state::{Found, Solve};

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
    let found = solve.run_stages();
    let mut found = found.unwrap_or_else(|| Found::new(solve.outcome_without_solution()));
    if found.outcome != Outcome::Converged
        && inequality.symmetric
        && inequality.distribution.is_none()
        && !inequality.matrix.is_symmetric()
    {
        found.outcome = Outcome::Malformed;
    }
    solve.into_solution(found)
}

impl<T: Real> Solve<'_, '_, T> {
    /// Runs the stages that apply, until one of them ends the solve.
    fn run_stages(&mut self) -> Option<Found> {
        for stage in STRATEGY {
            if self.applies(stage)
                && let Some(found) = self.run(stage)
            {
                return Some(found);
            }
        }
        if self.may_continue_direct() { self.run(Stage::DirectActiveSet) } else { None }
    }
}

/// Checks the input, and definiteness unless it is known: where a setting requires it, and for a symmetric matrix from
/// a start in contact, where indefinite directions of active unknowns would remain unseen. From a cold start the active
/// set iteration with factors factors a symmetric matrix on all free unknowns first, which is such a check itself; a
/// Krylov method and the interior point method, where it comes first, do not.
///
/// # Errors
/// The outcome that the solver returns.
fn check<T: Real>(
    settings: &ActiveSet,
    inequality: &Inequality<T>,
    is_preconditioned: bool,
) -> Result<(), Outcome> {
    agree(inequality, check_input(inequality))?;
    if inequality.distribution.is_some() {
        // there are no factors of a distributed matrix; Krylov methods notice directions that are not positive
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

/// The result of a check in all parts: that of this part, or the outcome of another part if this one has none.
fn agree<T: Real>(inequality: &Inequality<T>, checked: Result<(), Outcome>) -> Result<(), Outcome> {
    const OUTCOMES: [Outcome; 4] =
        [Outcome::OutOfRange, Outcome::Infeasible, Outcome::NotFinite, Outcome::Malformed];
    let Some(distribution) = inequality.distribution() else { return checked };
    let code = |outcome: Outcome| OUTCOMES.iter().position(|&other| other == outcome);
    let mut largest = [checked.err().map_or(0, |outcome| code(outcome).unwrap_or(0) + 1) as f64];
    distribution.largest(&mut largest);
    match largest[0] as usize {
        0 if largest[0] == 0.0 => Ok(()),
        0 => Err(Outcome::NotFinite),
        code => Err(OUTCOMES[code - 1]),
    }
}
