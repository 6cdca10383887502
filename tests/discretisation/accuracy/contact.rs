//! Errors where the discrete solution is in contact with an obstacle that is linear.

use std::f64::consts::PI;

use crate::runs::own_scene;
use unilateral::mesh::BoxDomain;
use unilateral::prelude::*;
use unilateral::problem::Exact;
use unilateral::study::Row;

/// The row of P1, which is zero on the obstacle everywhere, against `amplitude` times a function with zeros at all
/// vertices of the square with four subdivisions, and contact everywhere.
fn row(amplitude: f64) -> Row {
    let wave = move |x: f64| (4.0 * PI * x).sin();
    let slope = move |x: f64| 4.0 * PI * (4.0 * PI * x).cos();
    let exact = Exact::<2>::new(
        move |x| amplitude * wave(x[0]) * wave(x[1]),
        move |x| Point::from([slope(x[0]) * wave(x[1]), wave(x[0]) * slope(x[1])]) * amplitude,
    );
    let problem = Problem::new()
        .constant_source(-8.0)
        .obstacle_below(|_| 0.0)
        .obstacles_of_degree(0)
        .solved_by(exact.with_contact(|_| 1.0, Vec::new()));
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let scene = own_scene("wave", square, problem.dirichlet(|_| 0.0));
    let report = Study::new(scene).scheme(ConformingP1).levels([4]).run().unwrap();
    report.rows[0].clone()
}

/// Contact and equal values at the corners do not make two functions equal within a cell.
#[test]
fn an_error_that_vanishes_at_all_vertices_is_found() {
    let found = row(1.0);
    assert!(found.converged() && found.active.unwrap() > 0, "{:?}", found.message);
    let (l2, h1) = (found.error.l2.unwrap(), found.error.h1.unwrap());
    assert!((l2 - 0.5).abs() < 0.02, "{l2}");
    assert!((h1 / (0.5 * 32.0_f64.sqrt() * PI) - 1.0).abs() < 0.05, "{h1}");
}

/// Where both are the obstacle there is no error, to the last bit.
#[test]
fn two_functions_on_the_obstacle_have_no_error() {
    let found = row(0.0);
    assert_eq!((found.error.l2, found.error.h1), (Some(0.0), Some(0.0)));
}

/// A gradient that is no number is named, also where nothing else differs.
#[test]
fn a_gradient_that_is_no_number_is_found_in_contact() {
    let found = row(f64::NAN);
    assert!(!found.converged(), "{:?}", found.status);
}
