//! What can go wrong in a solve has a name, and the certificate sees it.

use super::{cold, solve_from};
use crate::penalised_cells::assembled;
use crate::problems::*;
use crate::support::panics::message_of_panic;
use unilateral::algebra::{
    Bound, Contact, Inequality, JumpTerm, Jumps, PenalisedMatrix, SparseMatrix, Start,
};
use unilateral::inequality::{
    ActiveSet, InequalitySolver, InteriorPoint, MonotoneMultigrid, Outcome, ProximalPoint, certify,
    contact_of,
};
use unilateral::linear::is_positive_definite;
use unilateral::prelude::*;

#[test]
fn indefinite_matrix_is_not_coercive() {
    // The smallest eigenvalue of the five-point matrix is about 2 (pi h)^2 = 0.2 here.
    for (n, diagonal) in [(9, 3.7), (60, 3.9)] {
        let matrix = laplacian(n, n, diagonal);
        let load = vec![-1.0; n * n];
        let problem = inequality(matrix, &load, vec![Bound::Lower(-1e-3); n * n]);
        let solution = cold(&problem);
        assert_eq!(solution.outcome, Outcome::NotCoercive);
        assert!(solution.values.iter().all(|u| u.is_finite()));
        // from contact everywhere no iterate shows it
        let start = Start::Contact(vec![Contact::Lower; n * n]);
        let mut warm = problem.clone();
        warm.start = start;
        assert_eq!(cold(&warm).outcome, Outcome::NotCoercive);
        warm.is_definite = true;
        assert_eq!(cold(&warm).outcome, Outcome::Converged);
        let mut unsymmetric = problem.clone();
        unsymmetric.symmetric = false;
        assert_eq!(cold(&unsymmetric).outcome, Outcome::NotCoercive);
    }
}

/// Contact hides two unknowns.
#[test]
fn every_solver_checks_definiteness_first() {
    let dense = vec![
        vec![1.0, -2.0, 0.0, 0.0],
        vec![-2.0, 1.0, 0.0, 0.0],
        vec![0.0, 0.0, 2.0, -1.0],
        vec![0.0, 0.0, -1.0, 2.0],
    ];
    let bounds = vec![Bound::Lower(0.0), Bound::Lower(0.0), Bound::Free, Bound::Free];
    let problem = inequality(sparse(&dense), &[-1e3, -1e3, 1.0, 1.0], bounds);
    let outcomes = [
        cold(&problem).outcome,
        InteriorPoint.solve(&problem).outcome,
        MonotoneMultigrid::default().solve(&problem).outcome,
        ProximalPoint.solve(&problem).outcome,
    ];
    assert_eq!(outcomes, [Outcome::NotCoercive; 4]);
}

/// Two coupled unknowns with lower bounds zero, and a load twice which overflows the scalar: the start is not
/// finite.
#[test]
fn a_start_that_overflows_is_named() {
    let (row_starts, columns) = (vec![0, 2, 4], vec![0, 1, 0, 1]);
    let matrix = SparseMatrix { row_starts, columns, values: vec![1.0, -0.9, -0.9, 1.0] };
    let bounds = vec![Bound::Lower(0.0); 2];
    let inequality = Inequality::<f32>::new(matrix, true, vec![3e38; 2], bounds);
    let found = InteriorPoint.solve(&inequality);
    assert_ne!(found.outcome, Outcome::Converged);
    assert!(found.outer <= 2, "{}", found.outer);
}

#[test]
fn definiteness_is_that_of_the_symmetric_part() {
    let free = [0, 1, 2];
    let rotation = vec![vec![1.0, 9.0, 0.0], vec![-9.0, 1.0, 0.0], vec![0.0, 0.5, 1.0]];
    assert_eq!(is_positive_definite(&sparse(&rotation), false, &free), Ok(true));
    let shear = vec![vec![1.0, 2.1, 0.0], vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]];
    assert_eq!(is_positive_definite(&sparse(&shear), false, &free), Ok(false));
    assert_eq!(is_positive_definite(&sparse(&shear), false, &[0, 2]), Ok(true));
    assert_eq!(is_positive_definite(&sparse(&shear), true, &[]), Ok(true));
}

#[test]
fn singular_matrix_is_singular() {
    // Every row sums to zero: constants are free, large enough for supernodes too.
    for n in [5, 90] {
        let mut matrix = laplacian(n, n, 4.0);
        for i in 0..n * n {
            let range = matrix.row_starts[i] as usize..matrix.row_starts[i + 1] as usize;
            let neighbours = (range.len() - 1) as f64;
            for k in range {
                if matrix.columns[k] as usize == i {
                    matrix.values[k] = neighbours;
                }
            }
        }
        let load: Vec<f64> = (0..n * n).map(|k| if k == 0 { 1.0 } else { 0.0 }).collect();
        let mut problem = inequality(matrix, &load, vec![Bound::Free; n * n]);
        assert_eq!(cold(&problem).outcome, Outcome::Singular);
        problem.symmetric = false;
        assert_eq!(cold(&problem).outcome, Outcome::Singular);
    }
}

#[test]
fn numbers_that_are_not_finite_are_noticed() {
    let good = membrane(5, 1.0, |_, _| -0.01);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut in_matrix = good.clone();
        in_matrix.matrix.values[7] = bad;
        let mut in_load = good.clone();
        in_load.load[3] = bad;
        let mut in_bounds = good.clone();
        in_bounds.bounds[20] = Bound::Both(-1.0, bad);
        for problem in [in_matrix, in_load, in_bounds] {
            let solution = cold(&problem);
            assert_eq!((solution.outcome, solution.outer), (Outcome::NotFinite, 0));
            assert!(solution.values.iter().all(|u| u.is_finite()));
        }
        let mut u = cold(&good).values;
        u[4] = bad;
        assert_eq!(certify(&good, &u).largest(), f64::INFINITY);
    }
    let mut overflow = good.clone();
    overflow.load = vec![1e308; 25];
    assert_eq!(cold(&overflow).outcome, Outcome::OutOfRange);
}

#[test]
fn bad_input_is_named() {
    let good = membrane(5, 1.0, |_, _| -0.01);
    let mut empty = good.clone();
    empty.bounds[3] = Bound::Both(1.0, 0.5);
    assert_eq!(cold(&empty).outcome, Outcome::Infeasible);
    let mut short = good.clone();
    short.bounds.pop();
    let mut outside = good.clone();
    *outside.matrix.columns.last_mut().unwrap() = 25;
    let mut descending = good.clone();
    descending.matrix.columns.swap(0, 1);
    for problem in [short, outside, descending] {
        assert_eq!(cold(&problem).outcome, Outcome::Malformed);
        assert_eq!(certify(&problem, &[0.0; 25]).largest(), f64::INFINITY);
    }
    let start = Start::Contact(vec![Contact::Upper; 3]);
    let solution = solve_from(&good, start);
    assert_eq!(solution.outcome, Outcome::Converged);
    assert!(certify(&good, &solution.values).largest() < 1e-9);
}

#[test]
fn iteration_limit_comes_with_the_best_iterate() {
    let problem = membrane(30, 10.0, |_, _| -0.3);
    let exact = cold(&problem);
    assert!(exact.outer > 5);
    let mut before = f64::INFINITY;
    for max_outer in [1, 3, 5] {
        let solver = ActiveSet::default().max_outer(max_outer);
        let solution = solver.solve(&problem);
        assert_eq!((solution.outcome, solution.outer), (Outcome::IterationLimit, max_outer));
        let error = distance(&solution.values, &exact.values);
        assert!(error < before && certify(&problem, &solution.values).largest() > 1e-9);
        before = error;
    }
}

#[test]
fn certificate_sees_every_violation() {
    let problem = membrane(20, 10.0, |_, _| -0.3);
    let solution = cold(&problem);
    let open = solution.contact.iter().position(|c| *c == Contact::Inactive).unwrap();
    let closed = solution.contact.iter().position(|c| *c == Contact::Lower).unwrap();
    let moved = |i: usize, by: f64| {
        let mut u = solution.values.clone();
        u[i] += by;
        certify(&problem, &u)
    };
    assert!(moved(closed, -1e-3).feasibility > 1e-3);
    assert!(moved(closed, 1e-3).complementarity > 1e-3);
    assert!(moved(open, -1e-3).residual > 1e-3);
    // Held at the obstacle by hand, a membrane pulls on it.
    let held: Vec<f64> = vec![-0.3; 400];
    let mut up = problem.clone();
    up.load.iter_mut().for_each(|b| *b = -*b);
    assert!(certify(&up, &held).multiplier > 0.1);
    // Neither does it depend on units, nor on bounds that nothing comes near.
    let mut scaled = problem.clone();
    scaled.matrix.values.iter_mut().for_each(|a| *a *= 1e7);
    scaled.load.iter_mut().for_each(|b| *b *= 1e4);
    scaled.bounds = vec![Bound::Both(-0.3e-3, 1e9); 400];
    let mut u = solution.values.clone();
    u[open] += 1e-3;
    let reference = certify(&problem, &u);
    u.iter_mut().for_each(|u| *u *= 1e-3);
    let certificate = certify(&scaled, &u);
    assert!((certificate.largest() / reference.largest() - 1.0).abs() < 1e-9);
}

#[test]
fn data_whose_squares_underflow_are_refused_and_not_certified() {
    let good = membrane(20, 10.0, |_, _| -0.3);
    let scaled = |factor: f64| {
        let mut problem = good.clone();
        problem.load.iter_mut().for_each(|b| *b *= factor);
        problem.bounds = vec![Bound::Lower(-0.3 * factor); 400];
        problem
    };
    let zero = vec![0.0; 400];
    assert!(certify(&good, &zero).largest() > 0.1);
    for factor in [1e-300, 1e-170, 1e-130] {
        let tiny = scaled(factor);
        assert_eq!(cold(&tiny).outcome, Outcome::OutOfRange);
        assert_eq!(certify(&tiny, &zero).largest(), f64::INFINITY);
    }
    for factor in [1e-100, 1e100] {
        assert_eq!(cold(&scaled(factor)).outcome, Outcome::Converged);
    }
}

/// The form is coercive for every penalty: a negative pivot is one of rounding, and no penalty is too small.
#[test]
fn a_huge_penalty_is_not_called_too_small() {
    let report = Study::<3>::new(scenes::radial(1.0))
        .scheme(Wopsip { eta: Eta::Absolute(1e11), ..Wopsip::default() })
        .levels([4])
        .run()
        .unwrap();
    let status = report.rows[0].status;
    assert!(matches!(status, Outcome::Singular | Outcome::Converged), "{status}");
}

/// No jump couples the second of two cells, on which the stiffness is singular: the pivot of its last unknown is zero.
#[test]
fn a_cell_that_nothing_holds_is_singular() {
    let held = [[2.0, -1.0, -1.0], [-1.0, 2.0, -1.0], [-1.0, -1.0, 2.0]];
    let term = |here| JumpTerm { here, there: JumpTerm::<f64>::NO_UNKNOWN, weight: 0.5 };
    let outcome = |reaction: f64| {
        let mut blocks = [held, held].as_flattened().as_flattened().to_vec();
        blocks[17] += reaction;
        let penalised = PenalisedMatrix {
            blocks,
            jumps: Jumps::new((2, 3), vec![0, 2], vec![term(0), term(1)]).unwrap(),
            weights: vec![10.0],
            jump_data: vec![0.0],
            mean_jumps: None,
        };
        let load = [0.0, 0.0, 0.0, 1.0, -1.0, 0.0];
        let mut given = inequality(assembled(&penalised), &load, vec![Bound::Free; 6]);
        given.penalised = Some(penalised);
        cold(&given).outcome
    };
    assert_eq!(outcome(1.0), Outcome::Converged);
    assert_eq!(outcome(0.0), Outcome::Singular);
}

/// What is no inequality has no contact states and no certificate.
#[test]
fn contact_states_and_certificates_of_what_is_no_inequality() {
    let sound = inequality(laplacian(3, 3, 4.0), &[1.0; 9], vec![Bound::Lower(0.0); 9]);
    let mut short = sound.clone();
    short.bounds.truncate(4);
    let mut torn = sound.clone();
    torn.matrix.columns[5] = 99;
    for (problem, values, said) in [
        (&short, 9, "the inequality of 9 unknowns is not well formed"),
        (&torn, 9, "the inequality of 9 unknowns is not well formed"),
        (&sound, 0, "0 values for 9 unknowns: contact states need one for each"),
        (&sound, 10, "10 values for 9 unknowns: contact states need one for each"),
    ] {
        let values = vec![0.0; values];
        assert_eq!(message_of_panic(|| drop(contact_of(problem, &values))), said);
        assert!(certify(problem, &values).largest().is_infinite(), "{said}");
    }
    assert_eq!(contact_of(&sound, &[0.1; 9]).len(), 9);
}
