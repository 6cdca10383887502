//! The solvers of the algebraic inequality against slow ones, and on what can go wrong.

mod certificates;
mod error_bound;
mod failures;
mod last_resort;
mod out_of_memory;
mod reach;
mod steps;
mod wrong_promises;

use crate::problems::*;
use unilateral::algebra::{Bound, Contact, Inequality, SparseMatrix, Start};
use unilateral::inequality::{
    ActiveSet, InequalitySolver, Outcome, SinglePrecision, Solution, certify,
};
use unilateral::linear::{FactorError, Factors};

/// The number of active unknowns; fixed ones do not count.
fn count_active(inequality: &Inequality<f64>, contact: &[Contact]) -> usize {
    let states = inequality.bounds.iter().zip(contact);
    states.filter(|(b, state)| b.is_inequality() && **state != Contact::Inactive).count()
}

fn cold(inequality: &Inequality<f64>) -> Solution<f64> {
    ActiveSet::default().solve(inequality)
}

fn solve_from(inequality: &Inequality<f64>, start: Start) -> Solution<f64> {
    let mut inequality = inequality.clone();
    inequality.start = start;
    cold(&inequality)
}

/// Solves from everywhere, asserts convergence and certificate, and the same solution each time.
#[track_caller]
fn solve_from_everywhere(inequality: &Inequality<f64>) -> Solution<f64> {
    let solution = cold(inequality);
    let n = inequality.size();
    let alternating =
        (0..n).map(|i| if i % 2 == 0 { Contact::Lower } else { Contact::Upper }).collect();
    for start in [vec![Contact::Lower; n], vec![Contact::Upper; n], alternating] {
        let other = solve_from(inequality, Start::Contact(start));
        assert_eq!(other.outcome, Outcome::Converged);
        let scale = 1.0 + distance(&solution.values, &vec![0.0; n]);
        assert!(distance(&other.values, &solution.values) < 1e-9 * scale);
    }
    assert_solved(inequality, &solution);
    solution
}

#[track_caller]
fn assert_solved(inequality: &Inequality<f64>, solution: &Solution<f64>) {
    assert_eq!(solution.outcome, Outcome::Converged);
    let certificate = certify(inequality, &solution.values);
    assert!(certificate.largest() < 1e-9, "{certificate:?}");
    for ((bound, contact), u) in
        inequality.bounds.iter().zip(&solution.contact).zip(&solution.values)
    {
        match contact {
            Contact::Inactive => {}
            Contact::Lower => assert_eq!(bound.lower(), Some(*u)),
            Contact::Upper => assert_eq!(bound.upper(), Some(*u)),
        }
    }
}

#[test]
fn string_over_obstacle_agrees_with_oracle() {
    let n = 40;
    let h = 1.0 / (n + 1) as f64;
    let bounds = (1..=n).map(|i| Bound::Lower(0.1 - (i as f64 * h - 0.4).powi(2))).collect();
    let problem = inequality(laplacian(n, 1, 2.0), &vec![-0.5 * h * h; n], bounds);
    let solution = solve_from_everywhere(&problem);
    assert!(distance(&solution.values, &projected_gauss_seidel(&problem)) < 1e-11);
    let contact = count_active(&problem, &solution.contact);
    assert!(contact > 5 && contact < n);
}

#[test]
fn membrane_agrees_with_oracle() {
    let problem = membrane(20, 10.0, |x, y| -0.1 - 0.3 * (x * y - 0.2).abs());
    let solution = solve_from_everywhere(&problem);
    assert!(distance(&solution.values, &projected_gauss_seidel(&problem)) < 1e-11);
}

#[test]
fn random_definite_problems_agree_with_oracle() {
    let mut random = Random::new(1);
    for n in (1..60).chain([80, 120]) {
        let matrix = random_definite(n, n, 1.0, &mut random);
        let load: Vec<f64> = (0..n).map(|_| 3.0 * random.signed()).collect();
        let problem = inequality(sparse(&matrix), &load, random_bounds(n, &mut random));
        let solution = solve_from_everywhere(&problem);
        let difference = distance(&solution.values, &projected_gauss_seidel(&problem));
        assert!(difference < 1e-9, "n = {n}: {difference}");
    }
}

#[test]
fn random_dominant_problems_agree_with_oracle() {
    let mut random = Random::new(2);
    for n in (1..60).chain([150]) {
        let matrix = random_dominant(n, &mut random);
        let load: Vec<f64> = (0..n).map(|_| n as f64 * random.signed()).collect();
        let mut problem = inequality(sparse(&matrix), &load, random_bounds(n, &mut random));
        problem.symmetric = false;
        let solution = solve_from_everywhere(&problem);
        let difference = distance(&solution.values, &projected_gauss_seidel(&problem));
        assert!(difference < 1e-11, "n = {n}: {difference}");
    }
}

#[test]
fn cycles_of_the_textbook_method_are_resolved() {
    let mut cycles = 0;
    for seed in 0..1000 {
        let mut random = Random::new(seed);
        let n = 6 + seed as usize % 20;
        let matrix = random_definite(n, n / 2, 0.003, &mut random);
        let load: Vec<f64> = (0..n).map(|_| random.signed()).collect();
        let problem = inequality(sparse(&matrix), &load, vec![Bound::Lower(0.0); n]);
        let solution = cold(&problem);
        if textbook_cycles(&matrix, &load) {
            cycles += 1;
            assert!(solution.stages.len() > 1, "seed {seed}");
        }
        assert_solved(&problem, &solution);
    }
    assert!(cycles > 30, "only {cycles} cycles");
}

/// `I + C` with `C` a weighted cyclic shift: a P-matrix on which the method runs in circles from
/// any start with one contact (Ben Gharbia, Gilbert, Math. Program. 134 (2012) 349-364).
#[test]
fn cycle_of_a_matrix_without_symmetry_is_resolved() {
    let matrix = vec![vec![1.0, 0.0, 2.0], vec![2.0, 1.0, 0.0], vec![0.0, 2.0, 1.0]];
    let mut problem = inequality(sparse(&matrix), &[1.0; 3], vec![Bound::Lower(0.0); 3]);
    problem.symmetric = false;
    for first in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]] {
        let start = first.map(|c| if c == 1 { Contact::Lower } else { Contact::Inactive });
        let start = Start::Contact(start.to_vec());
        let solution = solve_from(&problem, start);
        assert!(solution.stages.len() > 1);
        assert_solved(&problem, &solution);
        assert!(distance(&solution.values, &[1.0 / 3.0; 3]) < 1e-15);
    }
}

/// Bounds on both sides, large problems condensed: every unknown of a cycle has two bounds.
#[test]
fn cycles_between_two_bounds_are_resolved() {
    let mut cycles = 0;
    for seed in 0..200 {
        let mut random = Random::new(5000 + seed);
        let n = 40;
        let matrix = random_definite(n, n / 2, 0.003, &mut random);
        let load: Vec<f64> = (0..n).map(|_| random.signed()).collect();
        let problem = inequality(sparse(&matrix), &load, vec![Bound::Both(-0.5, 0.7); n]);
        let solution = cold(&problem);
        cycles += usize::from(solution.stages.len() > 1);
        assert_solved(&problem, &solution);
    }
    assert!(cycles > 10, "only {cycles} cycles");
}

#[test]
fn penalised_string_over_curved_obstacle_is_solved() {
    for (cells, penalty) in [(32, 1e3), (128, 1e5), (256, 1e8)] {
        let h = 1.0 / cells as f64;
        let end = |k: usize| k.div_ceil(2) as f64 * h;
        let bounds =
            (0..2 * cells).map(|k| Bound::Lower(0.2 - 2.0 * (end(k) - 0.5).powi(2))).collect();
        let problem =
            inequality(penalised_string(cells, penalty), &vec![-0.5 * h; 2 * cells], bounds);
        assert_solved(&problem, &cold(&problem));
    }
}

/// No load in contact, and an obstacle with the same curvature as the solution elsewhere: gap and
/// multiplier both vanish on a set of positive measure.
#[test]
fn biactive_contact_does_not_cycle() {
    for n in [7, 30, 61] {
        let mut problem = membrane(n, 0.0, |_, _| 0.0);
        solve_from_everywhere(&problem);
        // The solution of a linear problem is its own obstacle on a half.
        let h = 1.0 / (n + 1) as f64;
        problem.load = vec![-h * h; n * n];
        let free = inequality(problem.matrix.clone(), &problem.load, vec![Bound::Free; n * n]);
        let linear = cold(&free).values;
        problem.bounds = (0..n * n)
            .map(|k| Bound::Lower(if k % n < n / 2 { linear[k] } else { -1.0 }))
            .collect();
        let solution = solve_from_everywhere(&problem);
        assert!(distance(&solution.values, &linear) < 1e-13);
        assert!(solution.outer < 2 * n, "{}", solution.outer);
    }
}

#[test]
fn contact_everywhere() {
    let problem = membrane(12, 1.0, |_, _| 0.5);
    let solution = solve_from_everywhere(&problem);
    assert_eq!(count_active(&problem, &solution.contact), 12 * 12);
    assert!(solution.values.iter().all(|&u| u == 0.5));
    let mut pinned = problem.clone();
    pinned.bounds = vec![Bound::Fixed(2.0); 12 * 12];
    let solution = solve_from_everywhere(&pinned);
    assert_eq!((count_active(&pinned, &solution.contact), solution.outer), (0, 1));
}

#[test]
fn contact_nowhere() {
    let mut problem = membrane(12, 1.0, |_, _| -9.0);
    let solution = solve_from_everywhere(&problem);
    assert_eq!((count_active(&problem, &solution.contact), cold(&problem).outer), (0, 1));
    problem.bounds = vec![Bound::Free; 12 * 12];
    assert_eq!(cold(&problem).values, solution.values);
    assert_eq!(cold(&problem).outer, 1);
}

#[test]
fn nothing_at_all() {
    let problem = inequality(sparse(&[]), &[], vec![]);
    assert_solved(&problem, &cold(&problem));
}

#[test]
fn bounds_that_coincide_cost_no_iterations() {
    let mut problem = membrane(12, 10.0, |_, _| -9.0);
    for k in [3, 50, 77] {
        problem.bounds[k] = Bound::Both(0.25, 0.25);
    }
    let solution = solve_from_everywhere(&problem);
    assert_eq!((count_active(&problem, &solution.contact), solution.outer), (3, 1));
    assert_eq!(solution.values[50], 0.25);
}

#[test]
fn body_held_by_the_obstacle_alone() {
    // Natural boundary conditions: the linear problem has no solution, the inequality has.
    let n = 30;
    let mut rows = vec![vec![0.0; n]; n];
    for i in 0..n - 1 {
        for (a, b) in [(i, i), (i + 1, i + 1)] {
            rows[a][b] += 1.7;
        }
        rows[i][i + 1] -= 1.7;
        rows[i + 1][i] -= 1.7;
    }
    let load: Vec<f64> = (0..n).map(|i| 0.1 * (i as f64).sin() - 0.02).collect();
    let bounds = (0..n).map(|i| Bound::Lower(-(i as f64 / 10.0 - 1.0).powi(2))).collect();
    let mut problem = inequality(sparse(&rows), &load, bounds);
    let solution = cold(&problem);
    assert_solved(&problem, &solution);
    assert!(distance(&solution.values, &projected_gauss_seidel(&problem)) < 1e-8);
    // Pulled away from it, there is no solution.
    problem.load = vec![1.0; n];
    let outcome = cold(&problem).outcome;
    assert!(matches!(outcome, Outcome::Singular | Outcome::NotCoercive), "{outcome}");
}

#[test]
fn warm_start_needs_one_step() {
    let problem = membrane(30, 10.0, |_, _| -0.3);
    let solution = cold(&problem);
    let again = solve_from(&problem, Start::Contact(solution.contact));
    assert_eq!((again.outcome, again.outer), (Outcome::Converged, 1));
    assert!(distance(&again.values, &solution.values) < 1e-14);
}

#[test]
fn single_precision() {
    for n in [10, 40, 90] {
        let obstacle = |x: f64, y: f64| -0.05 - (x - 0.6).powi(2) - (y - 0.5).powi(2);
        let problem = membrane(n, 5.0, obstacle);
        let solution = SinglePrecision::new(ActiveSet::default()).solve(&problem);
        assert_eq!(solution.outcome, Outcome::Converged);
        let certificate = certify(&problem, &solution.values);
        assert!(certificate.largest() < 1e-4, "{certificate:?}");
        let double = cold(&problem);
        assert!(distance(&solution.values, &double.values) < 1e-5);
    }
}

/// An obstacle above the free solution by less than the rounding band is not touched.
#[test]
fn no_difference_within_the_rounding_band_changes_a_state() {
    let free = inequality(laplacian(3, 1, 2.0), &[-1.0; 3], vec![Bound::Free; 3]);
    let middle = cold(&free).values[1];
    let contact = |above: f64| {
        let mut obstacle = free.clone();
        obstacle.bounds[1] = Bound::Lower(middle + above);
        let solution = cold(&obstacle);
        assert_eq!(solution.outcome, Outcome::Converged);
        count_active(&obstacle, &solution.contact)
    };
    assert_eq!(contact(1e-12), 1);
    assert_eq!(contact(1e-16), 0);
}

/// A zero diagonal entry makes a matrix singular if the other entries of its row and column are zero, else indefinite.
#[test]
fn a_zero_diagonal_entry_is_singular_without_other_entries() {
    let error = |coupling: f64| {
        let matrix = SparseMatrix {
            row_starts: vec![0, 2, 5, 7],
            columns: vec![0, 1, 0, 1, 2, 1, 2],
            values: vec![2.0, -1.0, -1.0, 2.0, coupling, coupling, 0.0],
        };
        Factors::new(&matrix, true, &[0, 1, 2]).err()
    };
    assert_eq!(error(0.0), Some(FactorError::Singular));
    assert_eq!(error(0.5), Some(FactorError::NotPositive));
    let zero_first = |coupling: f64| {
        let matrix = SparseMatrix {
            row_starts: vec![0, 2, 4],
            columns: vec![0, 1, 0, 1],
            values: vec![0.0, coupling, coupling, 2.0],
        };
        Factors::new(&matrix, true, &[0, 1]).err()
    };
    assert_eq!(zero_first(0.0), Some(FactorError::Singular));
    assert_eq!(zero_first(0.5), Some(FactorError::NotPositive));
}

#[test]
fn factors_solve_for_several_right_hand_sides() {
    let matrix = laplacian(30, 30, 4.0);
    let free: Vec<u32> = (0..900).filter(|i| i % 7 != 3).collect();
    for symmetric in [true, false] {
        let factors = Factors::new(&matrix, symmetric, &free).unwrap();
        let mut x: Vec<f64> = (0..3 * free.len()).map(|k| (k as f64).sin()).collect();
        factors.solve_in_place(&mut x, 3);
        for side in 0..3 {
            let mut u = vec![0.0; 900];
            for (k, &i) in free.iter().enumerate() {
                u[i as usize] = x[side * free.len() + k];
            }
            for (k, &i) in free.iter().enumerate() {
                let b = ((side * free.len() + k) as f64).sin();
                assert!((matrix.row_dot(i as usize, &u) - b).abs() < 1e-12);
            }
        }
    }
}

/// So many rows that several tasks gather them.
#[test]
fn factors_have_the_same_bits_for_any_number_of_threads() {
    let matrix = laplacian(62, 62, 4.0);
    let free: Vec<u32> = (0..matrix.size() as u32).filter(|i| i % 7 != 3).collect();
    let b: Vec<f64> = free.iter().map(|&i| f64::from(i).sin()).collect();
    for symmetric in [true, false] {
        let solution = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut x = b.clone();
                Factors::new(&matrix, symmetric, &free).unwrap().solve_in_place(&mut x, 1);
                x
            })
        };
        let x = solution(3);
        assert!(x == solution(1));
        let mut u = vec![0.0; matrix.size()];
        free.iter().zip(&x).for_each(|(&i, &x)| u[i as usize] = x);
        for (&i, b) in free.iter().zip(&b) {
            assert!((matrix.row_dot(i as usize, &u) - b).abs() < 1e-12, "{i}");
        }
    }
}
