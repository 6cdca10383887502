//! What the certificate must not see: rounding beside a bound, and forces that no room lets act.

use super::cold;
use crate::problems::*;
use unilateral::algebra::{
    Bound, Contact, DirichletEnergy, DirichletTerm, Inequality, SparseMatrix,
};
use unilateral::inequality::{
    Certificate, InequalitySolver, Outcome, Solution, certify, contact_of,
};
use unilateral::prelude::*;
use unilateral::real::Precision;

#[test]
fn values_at_a_bound_but_for_rounding_are_in_contact() {
    let problem = membrane(20, 10.0, |_, _| -0.3);
    let solution = cold(&problem);
    let closed = |i: &usize| solution.contact[*i] == Contact::Lower;
    assert!((0..400).filter(closed).count() > 50);
    for by in [1e-14, 1e-12, -1e-14, -1e-12] {
        let mut u = solution.values.clone();
        (0..400).filter(closed).for_each(|i| u[i] += by);
        let certificate = certify(&problem, &u);
        assert!(certificate.largest() < 1e-9, "moved by {by}: {certificate:?}");
    }
    // what is more than rounding is seen
    let mut u = solution.values;
    let closed: Vec<usize> = (0..400).filter(|&i| solution.contact[i] == Contact::Lower).collect();
    closed.iter().for_each(|&i| u[i] += 1e-6);
    assert!(certify(&problem, &u).largest() > 1e-7);
}

/// An unknown that its lower bound lets go, but that has hardly any room below its upper one, is wrong
/// by that room at most.
#[test]
fn a_force_acts_as_far_as_the_opposite_bound() {
    let n = 5;
    let load = vec![-1.0; n * n];
    let certificate = |room: f64, force: f64| {
        let mut problem = inequality(laplacian(n, n, 4.0), &load, vec![Bound::Fixed(0.0); n * n]);
        problem.bounds[12] = Bound::Both(0.0, room);
        problem.load[12] = force;
        certify(&problem, &vec![0.0; n * n])
    };
    let narrow = certificate(1e-13, 1.0);
    assert!(narrow.largest() < 1e-12, "{narrow:?}");
    let wide = certificate(1e-3, 1.0);
    assert!(wide.multiplier > 1e-4 && wide.multiplier < 1e-2, "{wide:?}");
    // with room enough the step of a force counts: one quarter of it
    let free = certificate(1e3, 1.0);
    let ratio = free.multiplier / wide.multiplier;
    assert!((ratio - 250.0).abs() < 1e-6, "{ratio}");
    // a force towards the bound is what holds the unknown there
    assert_eq!(certificate(1e3, -1.0).largest(), 0.0);
}

/// Values near the obstacle touch it if their forces reach it: in every unit of force, from above as
/// from below.
#[test]
fn contact_is_told_from_values_alone() {
    let mut below = membrane(20, 10.0, |_, _| -0.3);
    let cold = cold(&below);
    let closed = |i: &usize| cold.contact[*i] == Contact::Lower;
    let step =
        |i: usize| (below.matrix.row_dot(i, &cold.values) - below.load[i]) / below.matrix.get(i, i);
    let least = (0..400).filter(closed).map(step).fold(f64::INFINITY, f64::min);
    let mut values = cold.values.clone();
    (0..400).filter(closed).for_each(|i| values[i] += 0.01 * least);
    for unit in [1.0, 1e-6, 1e9] {
        let mut above = below.clone();
        for problem in [&mut below, &mut above] {
            problem.matrix.values.iter_mut().for_each(|a| *a *= unit);
            problem.load.iter_mut().for_each(|b| *b *= unit);
        }
        assert_eq!(contact_of(&below, &values), cold.contact, "unit {unit}");
        above.load.iter_mut().for_each(|b| *b = -*b);
        above.bounds.fill(Bound::Upper(0.3));
        let mirrored: Vec<f64> = values.iter().map(|x| -x).collect();
        let expected = cold.contact.iter().map(|&state| match state {
            Contact::Lower => Contact::Upper,
            other => other,
        });
        assert!(contact_of(&above, &mirrored).into_iter().eq(expected), "unit {unit}, above");
    }
}

/// Where lower and upper bound coincide the unknown is active whatever the sign of its multiplier, as in the solution
/// of the active set method.
#[test]
fn contact_of_values_includes_coinciding_bounds() {
    for load in [-1.0, 1.0] {
        let bounds = vec![Bound::Free, Bound::Both(0.5, 0.5), Bound::Free];
        let string = inequality(laplacian(3, 1, 2.0), &[load; 3], bounds);
        let solution = cold(&string);
        let expected = [Contact::Inactive, Contact::Lower, Contact::Inactive];
        assert_eq!(solution.contact, expected, "load {load}");
        assert_eq!(contact_of(&string, &solution.values), expected, "load {load}");
    }
}

/// Without energy and load, residuals are relative to the size of the values.
#[test]
fn without_energy_the_values_are_the_scale() {
    let matrix = SparseMatrix {
        row_starts: vec![0, 2, 4],
        columns: vec![0, 1, 0, 1],
        values: vec![0.0, 1.0, -1.0, 0.0],
    };
    let problem = Inequality::new(matrix, false, vec![0.0; 2], vec![Bound::Free; 2]);
    assert_eq!(certify(&problem, &[1.0; 2]).residual, 1.0);
}

/// Each of the four violations alone, and the bound on the algebraic error, where there is one, decide on the limits.
#[test]
fn each_violation_counts_in_the_largest_one() {
    let exact = Certificate::new([0.0; 4]);
    for which in 0..4 {
        let mut violations = [0.0; 4];
        violations[which] = 0.5;
        let certificate = Certificate::new(violations);
        assert_eq!(certificate.largest(), 0.5, "{which}");
        assert!(!certificate.is_within_limits(Precision::Double), "{which}");
    }
    let limit = Precision::Double.algebraic_bound_limit();
    let is_within =
        |bound: Option<f64>| exact.with_algebraic_bound(bound).is_within_limits(Precision::Double);
    assert_eq!([None, Some(limit), Some(2.0 * limit)].map(is_within), [true, true, false]);
}

/// One unknown with the matrix four.
fn single(load: f64, bound: Bound<f64>) -> Inequality<f64> {
    let matrix = SparseMatrix { row_starts: vec![0, 1], columns: vec![0], values: vec![4.0] };
    Inequality::new(matrix, true, vec![load], vec![bound])
}

/// The violations of one unknown by their formulas: relative to the largest of values and admissible values, and to the
/// energy norm, without Dirichlet data.
#[test]
fn the_certificate_of_one_unknown_follows_by_hand() {
    // the value 1/2 is 3/2 below the bound two
    assert_eq!(certify(&single(-2.0, Bound::Lower(2.0)), &[0.5]).feasibility, 0.75);
    // the residual 6 - 4 x at zero, whose energy vanishes, beside the load 6, of which 2 is of Dirichlet data
    let mut problem = single(6.0, Bound::Free);
    assert_eq!(certify(&problem, &[0.0]).residual, 1.0);
    let term = DirichletTerm { unknown: 0, load: 2.0, linear: 4.0, constant: 0.0 };
    problem.dirichlet_energy = Some(DirichletEnergy { terms: vec![term] });
    assert_eq!(certify(&problem, &[0.0]).residual, 1.5);
    // a step of one half towards the bound 1/10 away, with the energy norm 2 * 0.1
    let found = certify(&single(-1.6, Bound::Lower(0.0)), &[0.1]);
    assert_eq!([found.residual, found.multiplier, found.feasibility], [0.0; 3]);
    assert!((found.complementarity - 1.0).abs() < 1e-14, "{found:?}");
}

/// A value beside a bound touches it if its force pushes it there, not if the force pulls it away.
#[test]
fn a_force_away_from_a_bound_is_no_contact() {
    let of = |load: f64, bound, value: f64| contact_of(&single(load, bound), &[value])[0];
    for (load, state) in [(-8.0, Contact::Lower), (8.0, Contact::Inactive)] {
        assert_eq!(of(load, Bound::Lower(0.0), 0.01), state, "{load}");
        assert_eq!(of(load, Bound::Both(0.0, 9.0), 0.01), state, "{load}, both");
    }
    for (load, state) in [(8.0, Contact::Upper), (-8.0, Contact::Inactive)] {
        assert_eq!(of(load, Bound::Upper(0.0), -0.01), state, "{load}");
        assert_eq!(of(load, Bound::Both(-9.0, 0.0), -0.01), state, "{load}, both");
    }
}

/// Values moved by a constant in one cell have the same balances as before, with the same jump multipliers: their jumps
/// alone tell.
#[test]
fn jumps_that_their_multipliers_do_not_have_are_seen() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&domain, [2, 2]).unwrap();
    let problem = Problem::new().constant_source(1.0);
    let solved = solve(&problem, &mesh, &Wopsip::default()).unwrap();
    let inequality = solved.inequality();
    let penalised = inequality.penalised.as_ref().unwrap();
    let mut values = solved.values().to_vec();
    let multipliers = penalised.jump_multipliers(|i| values[i]);
    struct Given(Vec<f64>, Vec<f64>);
    impl InequalitySolver<f64> for Given {
        fn name(&self) -> &'static str {
            "given"
        }
        fn solve(&self, inequality: &Inequality<f64>) -> Solution<f64> {
            let Self(values, multipliers) = self;
            Solution::of_values(inequality, values.clone(), multipliers.clone(), Outcome::Converged)
        }
    }
    let of = |u: &[f64]| {
        let given = Given(u.to_vec(), multipliers.clone());
        let mut nested = NestedIteration::new(&problem, &mesh).solver(given);
        nested.solve(&Wopsip::default()).unwrap().certificate()
    };
    assert!(of(&values).largest() < 1e-9);
    values[..3].iter_mut().for_each(|u| *u += 1e-3);
    let largest = values.iter().fold(0.0, |largest: f64, u| largest.max(u.abs()));
    let found = of(&values).residual * largest;
    assert!((found / 1e-3 - 1.0).abs() < 1e-6, "{found}");
}

/// What a solver says of itself counts only if its values do.
#[test]
fn a_solver_is_not_believed() {
    struct Confident;
    impl InequalitySolver<f64> for Confident {
        fn name(&self) -> &'static str {
            "confident"
        }
        fn solve(&self, inequality: &Inequality<f64>) -> Solution<f64> {
            let n = inequality.size();
            Solution::new(vec![0.0; n], vec![Contact::Inactive; n], Outcome::Converged)
        }
    }
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&domain, [2, 2]).unwrap();
    for (load, outcome) in [(1.0, Outcome::Stalled), (0.0, Outcome::Converged)] {
        let problem = Problem::new().constant_source(load);
        let solved = NestedIteration::new(&problem, &mesh).solver(Confident).solve(&ConformingP1);
        assert_eq!(solved.unwrap().outcome(), outcome, "{load}");
    }
}

/// Two coupled unknowns with bounds, and an unknown without load and coupling, whose value is zero; data and values in
/// this unit.
fn in_unit(unit: f64) -> (Inequality<f64>, [f64; 3]) {
    let matrix = sparse(&[vec![3.0, -1.0, 0.0], vec![-1.0, 2.0, 0.0], vec![0.0, 0.0, 1.0]]);
    let bounds = vec![Bound::Lower(-0.5 * unit), Bound::Upper(0.3 * unit), Bound::Free];
    let problem = inequality(matrix, &[-2.0 * unit, unit, 0.0], bounds);
    (problem, [-0.4 * unit, 0.31 * unit, 0.0])
}

/// Forces and values in a unit that is smaller or larger by a power of two, without and with weak Dirichlet data.
#[test]
fn certificates_do_not_depend_on_the_unit_of_data() {
    let of_unit = |unit: f64| {
        let (mut problem, values) = in_unit(unit);
        let free = certify(&problem, &values);
        let (load, linear) = (0.5 * unit, unit);
        let term = DirichletTerm { unknown: 1, load, linear, constant: unit * unit };
        problem.dirichlet_energy = Some(DirichletEnergy { terms: vec![term] });
        let with_data = certify(&problem, &values);
        assert_ne!(with_data, free);
        (free, with_data)
    };
    let (free, with_data) = of_unit(1.0);
    assert!(free.feasibility > 0.0 && free.complementarity > 0.0);
    for exponent in [-60, -30, 30, 60] {
        assert_eq!(of_unit(2.0_f64.powi(exponent)), (free, with_data), "{exponent}");
    }
}

/// The largest violation of a certificate is NaN if one of its violations is, so that it is within no limit.
#[test]
fn what_is_not_a_number_is_within_no_limit() {
    for which in 0..4 {
        let mut numbers = [0.0; 4];
        numbers[which] = f64::NAN;
        assert!(Certificate::new(numbers).largest().is_nan(), "violation {which}");
        assert!(!Certificate::new(numbers).is_within_limits(Precision::Double));
    }
    let not_a_number = f64::NAN;
    let (problem, values) = in_unit(1.0);
    for bound in [
        Bound::Lower(not_a_number),
        Bound::Upper(not_a_number),
        Bound::Fixed(not_a_number),
        Bound::Both(not_a_number, 1.0),
        Bound::Both(-1.0, not_a_number),
    ] {
        let mut wrong = problem.clone();
        wrong.bounds[0] = bound;
        assert_eq!(certify(&wrong, &values), Certificate::INVALID, "{bound:?}");
    }
}
