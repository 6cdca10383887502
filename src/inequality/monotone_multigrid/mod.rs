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
        if inequality.symmetric && inequality.distribution.is_some() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{Bound, SparseMatrix};
    use crate::inequality::Outcome;
    use crate::linear::CoarseSpaces;
    use crate::linear::precondition::CoarseLevel;

    /// Second differences on `n` points, fixed at both ends, under the load -1/n^2 above -1/30: the contact set is in
    /// the middle.
    fn string(n: usize) -> Inequality<f64> {
        let mut bounds = vec![Bound::Lower(-1.0 / 30.0); n];
        (bounds[0], bounds[n - 1]) = (Bound::Fixed(0.0), Bound::Fixed(0.0));
        let matrix = SparseMatrix::second_differences(n);
        Inequality::new(matrix, true, vec![-1.0 / (n * n) as f64; n], bounds)
    }

    #[test]
    fn a_coarser_level_of_another_size_is_not_used() {
        let string = string(2000);
        let expected = MonotoneMultigrid::default().solve(&string);
        for other in [1500, 2500] {
            let matrix = SparseMatrix::second_differences(other);
            let level = CoarseLevel::aggregated(&matrix, &vec![false; other]).unwrap();
            let coarse_spaces = CoarseSpaces::CoarseLevel(level);
            let guess = InitialGuess { coarse_spaces, ..InitialGuess::default() };
            let found = MonotoneMultigrid::default().solve_from(&string, &guess);
            assert_eq!((found.outcome, found.values), (expected.outcome, expected.values.clone()));
        }
    }

    /// Both unknowns are in contact, so that no correction meets the direction (1, 1), in which the energy has negative
    /// curvature and no lower bound.
    #[test]
    fn contact_does_not_hide_an_indefinite_matrix() {
        let matrix = SparseMatrix {
            row_starts: vec![0, 2, 4],
            columns: vec![0, 1, 0, 1],
            values: vec![1.0, -2.0, -2.0, 1.0],
        };
        let bounds = vec![Bound::Lower(0.0); 2];
        let inequality = Inequality::new(matrix, true, vec![-1.0; 2], bounds);
        let solution = MonotoneMultigrid::default().solve(&inequality);
        assert_eq!(solution.outcome, Outcome::NotCoercive);
    }

    /// Second differences on `n` points without fixed ends, beside the rows `others` of two further unknowns.
    fn beside_free_string(n: usize, others: [[f64; 2]; 2]) -> Inequality<f64> {
        let mut matrix = SparseMatrix::second_differences(n);
        for end in [0, n - 1] {
            let k = (matrix.row_starts[end] as usize..matrix.row_starts[end + 1] as usize)
                .find(|&k| matrix.columns[k] as usize == end);
            matrix.values[k.unwrap()] = 1.0;
        }
        for row in others {
            matrix.columns.extend([n as u32, n as u32 + 1]);
            matrix.values.extend(row);
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        Inequality::new(matrix, true, vec![-1.0; n + 2], vec![Bound::Lower(0.0); n + 2])
    }

    /// The smallest eigenvalue of the string is zero, so that no eigenvalue bounds the error of the iterate, and both
    /// further unknowns are in contact. The matrix must be positive semidefinite on all unknowns, not on admissible
    /// directions alone.
    #[test]
    fn a_string_that_bounds_alone_hold_does_not_hide_an_indefinite_matrix() {
        let solve = |others| MonotoneMultigrid::default().solve(&beside_free_string(1000, others));
        assert_eq!(solve([[1.0, 2.0], [2.0, 1.0]]).outcome, Outcome::NotCoercive);
        assert_eq!(solve([[2.0, 1.0], [1.0, 2.0]]).outcome, Outcome::Converged);
    }

    /// A limit of zero admits cycles until the first one that does not halve the change of the values.
    #[test]
    fn the_limit_of_stagnating_cycles_counts_cycles_that_stagnate() {
        let string = string(2000);
        let of = |limit| MonotoneMultigrid::default().stagnation_cycles(limit).solve(&string);
        let whole = of(200);
        assert_eq!(whole.outcome, Outcome::Converged);
        let short = of(0);
        assert!(short.outer > 1 && short.outer < whole.outer, "{} {}", short.outer, whole.outer);
        assert_eq!(short.outcome, Outcome::Stalled);
    }

    #[test]
    fn the_counter_includes_the_steps_before_the_first_cycle() {
        let guess = InitialGuess::default();
        let recorder = Recorder::new(&guess.steps, false);
        guess.steps.set(7);
        let solution = MonotoneMultigrid::default().run_cycles(&string(200), &guess, &recorder);
        assert!(solution.outer > 0);
        assert_eq!(guess.steps.get(), 7 + solution.outer);
    }
}
