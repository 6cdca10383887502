//! Inequalities that are not what they are declared to be.

use super::{cold, solve_from};
use crate::problems::*;
use unilateral::algebra::{Bound, Contact, DofLocation, Inequality, Start};
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome, certify};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;

/// What converged satisfies the conditions, computed here from the matrix as it is.
#[track_caller]
fn assert_honest(problem: &Inequality<f64>, values: &[f64], what: &str) {
    let scale = values.iter().chain(&problem.load).fold(1.0_f64, |s, x| s.max(x.abs()));
    for (i, bound) in problem.bounds.iter().enumerate() {
        let (columns, entries) = problem.matrix.row(i);
        let au: f64 = columns.iter().zip(entries).map(|(&j, a)| a * values[j as usize]).sum();
        let force = (au - problem.load[i]) / scale;
        let gap = bound.lower().map_or(f64::INFINITY, |l| (values[i] - l) / scale);
        assert!(gap > -1e-8, "{what}: unknown {i} lies {gap} below its bound");
        // force without contact, or a force that pulls
        let wrong = force.abs().min(gap.abs()).max(-force);
        assert!(wrong < 1e-6, "{what}: unknown {i} has force {force} and gap {gap}");
    }
}

#[test]
fn a_matrix_declared_symmetric_that_is_not_never_converges_to_a_wrong_answer() {
    let mut converged = 0;
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let mut matrix = laplacian(7, 7, 4.5);
        let size = [0.05, 0.3, 1.0][seed as usize % 3];
        for i in 0..matrix.size() {
            for k in matrix.row_starts[i] as usize..matrix.row_starts[i + 1] as usize {
                if matrix.columns[k] as usize != i {
                    matrix.values[k] += size * random.signed();
                }
            }
        }
        let load: Vec<f64> = (0..49).map(|_| random.signed()).collect();
        let problem = inequality(matrix, &load, vec![Bound::Lower(-0.1); 49]);
        assert!(problem.symmetric);
        let solution = cold(&problem);
        if solution.outcome == Outcome::Converged {
            converged += 1;
            assert_honest(&problem, &solution.values, &format!("seed {seed}"));
        } else {
            let honest = [Outcome::Malformed];
            assert!(honest.contains(&solution.outcome), "seed {seed}: {}", solution.outcome);
        }
    }
    assert!(converged < 60, "no declaration was wrong enough to be noticed");
}

/// `-u'' - c u` on the square is positive definite for `c` below two pi squared.
#[test]
fn a_negative_reaction_converges_while_the_form_is_coercive() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&domain, [16; 2]).unwrap();
    for (reaction, expected) in [
        (-1.0, Outcome::Converged),
        (-15.0, Outcome::Converged),
        (-25.0, Outcome::NotCoercive),
        (-1000.0, Outcome::NotCoercive),
    ] {
        let problem = Problem::new().reaction(reaction).source(|_| -1.0).obstacle_below(|_| -10.0);
        for scheme in [&ConformingP1 as &dyn Scheme<2>, &Sipg::default()] {
            let outcome = solve(&problem, &mesh, scheme).unwrap().solution().outcome;
            assert_eq!(outcome, expected, "{} with {reaction}", scheme.name());
        }
    }
}

#[test]
fn locations_out_of_range_are_refused_before_arrays_are_made() {
    let good = || membrane(3, 1.0, |_, _| -0.01);
    let locations = |last: u32, n: usize| -> Vec<DofLocation> {
        (0..n as u32).map(|i| DofLocation::new(None, &[if i == 8 { last } else { i }])).collect()
    };
    let iterative = ActiveSet::default().linear(LinearMethod::Iterative);
    let outcome = |problem: &Inequality<f64>| {
        let outcomes = [iterative.solve(problem), cold(problem)].map(|s| s.outcome);
        assert_eq!(outcomes[0], outcomes[1]);
        outcomes[0]
    };
    let with_locations = |locations| {
        let mut problem = good();
        problem.locations = locations;
        problem
    };
    assert_eq!(outcome(&with_locations(locations(8, 9))), Outcome::Converged);
    for last in [36, 4_000_000_000, u32::MAX - 1] {
        let problem = with_locations(locations(last, 9));
        assert!(!problem.is_well_formed());
        assert_eq!(outcome(&problem), Outcome::Malformed, "vertex {last}");
        assert_eq!(certify(&problem, &[0.0; 9]).largest(), f64::INFINITY);
    }
    assert_eq!(outcome(&with_locations(locations(8, 8))), Outcome::Malformed);
}

/// A start in contact everywhere must not hide that nothing was factored.
#[test]
fn a_start_in_contact_gives_the_answer_of_a_cold_one() {
    let problem = membrane(12, 3.0, |_, _| -0.05);
    let start = Start::Contact(vec![Contact::Lower; 144]);
    let warm = solve_from(&problem, start);
    assert_eq!(warm.outcome, Outcome::Converged);
    assert!(distance(&warm.values, &cold(&problem).values) < 1e-12);
    assert_honest(&problem, &warm.values, "warm");
}
