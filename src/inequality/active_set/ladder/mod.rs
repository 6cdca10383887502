//! The solve of an inequality: the methods in their order.

mod stages;

use super::linear_solver::End;
use super::settings::ActiveSet;
use crate::algebra::Inequality;
use crate::inequality::Solution;
use crate::inequality::history::Recorder;
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::validation::check;
use crate::linear::{CoarseSpaces, LinearMethod, PreconditionerFamily};
use crate::real::Real;
use stages::{Ladder, suits_monotone_multigrid};

/// Number of unknowns from which a Krylov method solves the linear systems by default if coarse spaces are known: with
/// factors, which are accurate to rounding, radial-2d takes up to 4.4 times as long from here on.
pub(super) const CROSSOVER: usize = 10_000;

/// Number of stored entries of the matrix from which a Krylov method solves the linear systems of a start, whose
/// solution is the initial guess of another solve and need not be accurate: the start of radial-3d, `p1`, 32 takes a
/// third of the time that it takes with factors. Entries are counted because factors have more fill in space.
const CROSSOVER_OF_STARTS: usize = 60_000;

/// Solves an inequality.
///
/// The first active set iteration solves its linear systems by a Krylov method or with factors. After a stagnating
/// Krylov iteration monotone multigrid follows if it suits the inequality. The interior point method runs once if
/// monotone multigrid does not suit or does not converge, or if the iteration with factors stagnates or meets a singular
/// matrix. Its contact states, if it has an iterate, are the start of a last active set iteration with factors, whose
/// outcome is that of the solve.
///
/// What else turns the method, each with a row of `tests/program/hard_rows.rs` that needs it:
///
/// | turn | place | row |
/// |---|---|---|
/// | a Krylov method from [`CROSSOVER`] unknowns on | `uses_krylov` | spiral-2d, `wopsip:facet-means`, 64 |
/// | factors where a Krylov method does not fit the matrix | [`End::Unsuitable`] | contrast-disc-2d, `wopsip`, 64 |
/// | more systems without progress where what follows is dear, any number from a cold start | `krylov_limit` | contrast-disc-2d, `nipg`, 64 |
/// | the inequality near unknowns whose states change in turn, after a Krylov method, if monotone multigrid does not suit | `local_inequality` | lshape-2d, `wopsip`, 128 |
/// | a body that bounds alone hold starts with all its bounds active | `starting_states` | `neu3.toml`, `p1`, 8 |
/// | the best iterate, where the last one is no solution | `outcome_of_best` | lshape-2d, `wopsip-p2`, `eta` 1e10, 4 (a test) |
///
/// One part of a mesh has no factors: the first iteration is all.
pub(super) fn solve<T: Real>(
    settings: &ActiveSet,
    inequality: &Inequality<T>,
    (guess, recorder): (&InitialGuess<T>, &Recorder<'_>),
    family: &dyn PreconditionerFamily<T>,
) -> Solution<T> {
    if let Err(outcome) = check(inequality) {
        return Solution::without_iterate(inequality, outcome);
    }
    let uses_krylov = uses_krylov(settings, inequality, guess);
    let mut ladder = Ladder::new(settings, inequality, (guess, recorder), uses_krylov);
    let mut end = End::Unsuitable;
    if uses_krylov {
        end = ladder.active_set_by_krylov(family);
        if end == End::Stagnation && suits_monotone_multigrid(inequality, guess) {
            end = ladder.monotone_multigrid();
        }
    }
    if !inequality.is_in_parts() {
        if end == End::Unsuitable {
            end = ladder.active_set_by_factors();
        }
        if matches!(end, End::Stagnation | End::Singular) {
            ladder.interior_point();
            end = ladder.active_set_by_factors();
        }
    }
    ladder.into_solution(end)
}

/// Whether the first active set iteration solves its linear systems by a preconditioned Krylov method.
fn uses_krylov<T: Real>(
    settings: &ActiveSet,
    inequality: &Inequality<T>,
    guess: &InitialGuess<T>,
) -> bool {
    match settings.linear {
        _ if inequality.is_in_parts() => true,
        LinearMethod::Direct => false,
        LinearMethod::Iterative => true,
        LinearMethod::BySize => {
            let is_large = match guess.energy_tolerance {
                Some(_) => inequality.matrix.nonzeros() >= CROSSOVER_OF_STARTS,
                None => inequality.size() >= CROSSOVER,
            };
            is_large && !matches!(guess.coarse_spaces, CoarseSpaces::Unknown)
        }
    }
}
