//! Steps of the active set method: where they start, and when they end.

use super::{cold, solve_from};
use crate::problems::*;
use unilateral::algebra::{Bound, Contact, DofLocation, Inequality, SparseMatrix, Start};
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome, Solution, Stage};
use unilateral::linear::LinearMethod;

/// A solve that ends before its first step returns values that fit its contact states.
#[test]
fn a_solve_without_a_step_has_the_values_of_its_states() {
    let bounds = vec![Bound::Fixed(7.0), Bound::Both(-1.0, 1.0), Bound::Both(-1.0, 1.0)];
    let mut string = inequality(laplacian(3, 1, 2.0), &[0.0; 3], bounds);
    string.start = Start::Contact(vec![Contact::Inactive, Contact::Lower]);
    let solution = ActiveSet::default().max_outer(0).solve(&string);
    assert_eq!((solution.outcome, solution.outer), (Outcome::IterationLimit, 0));
    assert_eq!(solution.values, [7.0, -1.0, 0.0]);
    assert_eq!(solution.contact, [Contact::Inactive, Contact::Lower, Contact::Inactive]);
}

/// Uncoupled unknowns whose forces decide at once: the numbers of the unknowns in contact have the same sum before and
/// after the step, which is no cycle.
#[test]
fn different_active_sets_with_equal_sums_of_numbers_are_no_cycle() {
    let identity = |n: usize| -> Vec<Vec<f64>> {
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect()
    };
    for (before, after) in [([0, 3], [1, 2]), ([1, 6], [3, 4]), ([2, 5], [0, 7])] {
        let load: Vec<f64> = (0..8).map(|i| if after.contains(&i) { -1.0 } else { 1.0 }).collect();
        let problem = inequality(sparse(&identity(8)), &load, vec![Bound::Lower(0.0); 8]);
        let states = |of: [usize; 2]| -> Vec<Contact> {
            let state = |i| if of.contains(&i) { Contact::Lower } else { Contact::Inactive };
            (0..8).map(state).collect()
        };
        let solution = solve_from(&problem, Start::Contact(states(before)));
        assert_eq!(solution.contact, states(after));
        assert_eq!((solution.outcome, solution.outer), (Outcome::Converged, 2));
        assert_eq!(solution.stages.len(), 1, "{before:?}");
    }
}

/// A string in contact everywhere leaves the obstacle node by node, from both ends: the number of changes does not halve
/// within four systems after the first one, and another method follows.
#[test]
fn changes_that_do_not_halve_lead_to_another_method() {
    let n = 60;
    let load = vec![-8.0 / (n * n) as f64; n];
    let string = inequality(laplacian(n, 1, 2.0), &load, vec![Bound::Lower(-0.5); n]);
    let solution = solve_from(&string, Start::Contact(vec![Contact::Lower; n]));
    assert_eq!(solution.outcome, Outcome::Converged);
    let stages: Vec<_> = solution.stages.iter().map(|run| run.stage).collect();
    assert_eq!(
        stages,
        [Stage::DirectActiveSet, Stage::InteriorPoint, Stage::DirectActiveSet],
        "{:?}",
        solution.stages
    );
    assert_eq!(solution.stages[0].outer, 5);
    assert!(distance(&solution.values, &cold(&string).values) < 1e-12);
}

/// The state of an unknown at its bound between two others, whose force in single precision is `1e-3` in the wrong direction.
fn between(others: [Bound<f32>; 2], load: [f32; 3], bound: f32) -> Contact {
    let matrix = SparseMatrix {
        row_starts: vec![0, 2, 5, 7],
        columns: vec![0, 1, 0, 1, 2, 1, 2],
        values: vec![2.0, -1.0, -1.0, 2.0, -1.0, -1.0, 2.0],
    };
    let [one, other] = others;
    let bounds = vec![one, Bound::Lower(bound), other];
    let mut string = Inequality::<f32>::new(matrix, true, load.to_vec(), bounds);
    string.start = Start::Contact(vec![Contact::Inactive, Contact::Lower]);
    ActiveSet::default().solve(&string).contact[1]
}

/// Terms of a residual count by their sizes, however much they cancel: those of values that are solved for are rounded in
/// the precision of the solve, those of given values are not.
#[test]
fn wrong_forces_within_rounding_change_no_state() {
    let given = [Bound::Fixed(1000.0), Bound::Fixed(0.0)];
    assert_eq!(between(given, [0.0, 1e-3, 0.0], 500.0), Contact::Inactive);
    let solved_for = [Bound::Free, Bound::Fixed(0.0)];
    assert_eq!(between(solved_for, [1500.0, 1e-3, 0.0], 500.0), Contact::Lower);
    assert_eq!(between(solved_for, [1500.0, 1e-2, 0.0], 500.0), Contact::Inactive);
    // of opposite signs
    assert_eq!(between([Bound::Free; 2], [2000.0, 1e-3, -2000.0], 0.0), Contact::Lower);
    assert_eq!(between([Bound::Free; 2], [2000.0, 1e-2, -2000.0], 0.0), Contact::Inactive);
}

/// A string in contact everywhere, solved by a Krylov method.
fn by_krylov(n: usize, load: f64) -> Solution<f64> {
    let bounds = vec![Bound::Lower(-0.5); n];
    let mut string = inequality(laplacian(n, 1, 2.0), &vec![load; n], bounds);
    string.locations = (0..n as u32).map(|v| DofLocation::new(None, &[v])).collect();
    string.conforming_linear = true;
    string.start = Start::Contact(vec![Contact::Lower; n]);
    let solution = ActiveSet::default().linear(LinearMethod::Iterative).solve(&string);
    assert_eq!(solution.outcome, Outcome::Converged);
    assert!(distance(&solution.values, &cold(&string).values) < 1e-8);
    solution
}

/// The string leaves the obstacle node by node. Whenever the number of changes has not halved within four systems, the
/// inequality near the nodes that changed is solved, and with it for the three next nodes, which saves three systems; the
/// values that it gives save iterations.
#[test]
fn unknowns_near_those_that_change_in_turn_are_solved_together() {
    let solutions = [-8e-4, -2e-3, -5e-3].map(|load| by_krylov(200, load));
    assert!(solutions.iter().all(|of| of.stages.len() == 1));
    assert_eq!(solutions.each_ref().map(|of| of.outer), [23, 16, 11]);
    let linear: usize = solutions.iter().map(|of| of.linear).sum();
    assert!(linear <= 74, "{linear} iterations");
    // not if they are more than half of all unknowns: of 30 unknowns ten change
    let stages = |n: usize| by_krylov(n, -0.01).stages.iter().map(|run| run.stage).collect();
    let few: Vec<Stage> = stages(40);
    assert_eq!(few, [Stage::PreconditionedActiveSet]);
    let many: Vec<Stage> = stages(30);
    assert_eq!(
        many,
        [Stage::PreconditionedActiveSet, Stage::InteriorPoint, Stage::DirectActiveSet]
    );
}

/// A matrix on which the method runs in circles, whose rows have different scales: of two iterates with the same steps the
/// one is returned whose step is smaller in the norm of the diagonal, which is that with the smaller energy here.
#[test]
fn the_best_iterate_has_the_smallest_step_in_the_norm_of_the_diagonal() {
    let scales = [1.1, 1.0, 0.5];
    let rows = [[1.0, 0.0, 2.0], [2.0, 1.0, 0.0], [0.0, 2.0, 1.0]];
    let scaled = |k: usize| rows[k].map(|a| scales[k] * a).to_vec();
    let matrix = sparse(&[scaled(0), scaled(1), scaled(2)]);
    let mut problem = inequality(matrix, &scales, vec![Bound::Lower(0.0); 3]);
    (problem.symmetric, problem.is_definite) = (false, true);
    problem.start = Start::Contact(vec![Contact::Lower]);
    let found = |max_outer: usize| ActiveSet::default().max_outer(max_outer).solve(&problem);
    // the steps (3, 0, 1) and (0, 1, 3)
    for (max_outer, expected) in [(1, [0.0, 1.0, -1.0]), (2, [1.0, -1.0, 0.0])] {
        let solution = found(max_outer);
        assert_eq!(solution.outcome, Outcome::IterationLimit);
        assert!(distance(&solution.values, &expected) < 1e-14, "{:?}", solution.values);
    }
}

/// Two unknowns that a large penalty ties together and one that violates its bound by a ten millionth of the largest
/// value, which is less than rounding that the penalty amplifies: without a further system the solve has stalled, in any
/// unit of data.
#[test]
fn violations_within_amplified_rounding_are_a_stall() {
    let outcome = |penalty: f64, unit: f64| {
        let tied = 1.0 + penalty;
        let rows = [vec![tied, -penalty, 0.0], vec![-penalty, tied, 0.0], vec![0.0, 0.0, 1.0]];
        let bounds = vec![Bound::Free, Bound::Free, Bound::Lower(0.0)];
        let problem = inequality(sparse(&rows), &[unit, unit, -1e-7 * unit], bounds);
        ActiveSet::default().max_outer(1).solve(&problem).outcome
    };
    for exponent in [-30, 0, 30] {
        let unit = 2.0_f64.powi(exponent);
        assert_eq!(outcome(1e15, unit), Outcome::Stalled, "{exponent}");
        assert_eq!(outcome(1.0, unit), Outcome::IterationLimit, "{exponent}");
    }
}
