//! What the certificate must not see: rounding beside a bound, and forces that no room lets act.

use super::cold;
use crate::problems::*;
use unilateral::algebra::{Bound, Contact, Inequality, SparseMatrix};
use unilateral::inequality::{Violations, certify, contact_of};

#[test]
fn values_at_a_bound_but_for_rounding_are_in_contact() {
    let problem = membrane::<f64>(20, 10.0, |_, _| -0.3);
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
    let mut below = membrane::<f64>(20, 10.0, |_, _| -0.3);
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

/// Without energy and load, residuals are relative to the size of the values, of all parts together.
#[test]
fn parts_without_energy_have_the_scale_of_the_whole() {
    let matrix = SparseMatrix {
        row_starts: vec![0, 2, 4],
        columns: vec![0, 1, 0, 1],
        values: vec![0.0, 1.0, -1.0, 0.0],
    };
    let problem = Inequality::new(matrix, false, vec![0.0; 2], vec![Bound::Free; 2]);
    let [one, other] = [0, 1].map(|own| Violations::of(&problem, &[1.0; 2], &[], &|i| i == own));
    assert_eq!(certify(&problem, &[1.0; 2]).residual, 1.0);
    assert_eq!(one.merge(other).certificate().residual, 1.0);
}
