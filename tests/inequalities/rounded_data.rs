//! Inequalities rounded to single precision.

use crate::problems::{inequality, sparse};
use unilateral::algebra::Bound;
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome, SinglePrecision, in_precision};
use unilateral::prelude::*;
use unilateral::real::Precision;
use unilateral::scenes::Scene;

const THIRD: f64 = 1.0 / 3.0;

#[test]
fn each_number_is_rounded_once_and_bounds_may_coincide() {
    let bounds = vec![Bound::Both(THIRD, THIRD + 1e-12)];
    let rounded = inequality(sparse(&[vec![THIRD]]), &[-THIRD], bounds).in_precision::<f32>();
    assert_eq!(rounded.matrix.values, [THIRD as f32]);
    assert_eq!(rounded.load, [-THIRD as f32]);
    assert_eq!(rounded.bounds, [Bound::Both(THIRD as f32, THIRD as f32)]);
}

/// The inner vertices of a square, between obstacles that differ by less than rounding in single precision.
#[test]
fn bounds_that_rounding_makes_equal_are_counted() {
    // of a constant nothing is left that could be rounded
    let plane = |x: &Point<2>| THIRD + x[0] - 0.5;
    let warnings = |precision: Precision, distance: f64| {
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let problem = Problem::new()
            .constant_source(-1.0)
            .dirichlet(plane)
            .obstacle_below(plane)
            .obstacle_above(move |x| plane(x) + distance);
        let scene = Scene::new("slit", domain, problem).summary("a membrane between obstacles");
        let study = Study::<2>::new(scene).scheme(ConformingP1).levels([4]);
        let study = study.boxed_solver(in_precision(precision, ActiveSet::default()));
        study.run().unwrap().rows.remove(0).warnings
    };
    let single = warnings(Precision::Single, 1e-12);
    let is_told = |warning: &String| {
        warning.contains("the lower and the upper bound of 9 unknowns differ by less than rounding")
    };
    assert!(single.iter().any(is_told), "{single:?}");
    for (precision, distance) in
        [(Precision::Double, 1e-12), (Precision::Single, 1e-3), (Precision::Single, 0.0)]
    {
        let others = warnings(precision, distance);
        assert!(!others.iter().any(|w| w.contains("differ by less than rounding")), "{others:?}");
    }
}

#[test]
fn what_underflows_or_overflows_is_beyond_the_range() {
    let solver = SinglePrecision::new(ActiveSet::default());
    let outcome = |a: f64, b: f64, bound: f64| {
        let problem = inequality(sparse(&[vec![a]]), &[b], vec![Bound::Lower(bound)]);
        solver.solve(&problem).outcome
    };
    assert_eq!(outcome(1.0, 0.0, -1.0), Outcome::Converged);
    for (a, b, bound) in [
        (1e-42, 1.0, 0.0),
        (1e39, 1.0, 0.0),
        (1.0, 1e-60, 0.0),
        (1.0, 1e39, 0.0),
        (1e10, 1e39, 0.0),
        (1.0, 0.0, 1e-50),
        (1e-20, 1e20, 0.0),
    ] {
        assert_eq!(outcome(a, b, bound), Outcome::OutOfRange, "{a} {b} {bound}");
    }
    // the smallest diagonal entry, the largest of all entries
    for (diagonal, beside) in [(1e-42, 0.0), (1.0, 1e39)] {
        let matrix = sparse(&[vec![1.0, beside], vec![-beside, diagonal]]);
        let mut problem = inequality(matrix, &[1.0, 0.0], vec![Bound::Both(0.0, 1.0); 2]);
        problem.symmetric = false;
        assert_eq!(solver.solve(&problem).outcome, Outcome::OutOfRange, "{diagonal} {beside}");
    }
}
