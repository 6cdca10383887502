//! Work between the levels that were run: exact for powers, and nowhere else.

use crate::rows::report;
use crate::work_precision::synthetic::measured;
use unilateral::inequality::Outcome;
use unilateral::measure::{ErrorNorm, Errors};
use unilateral::study::Row;
use unilateral::work_precision::Standing;

/// The rows of a scheme with these errors in L2 and seconds, from coarse to fine; none is a run that failed.
fn levels(scheme: &str, points: &[Option<(f64, f64)>]) -> Vec<Row> {
    let row = |(k, point): (usize, &Option<(f64, f64)>)| {
        let mut row = measured(scheme, 8 << k, 1.0);
        row.error = Errors::default();
        match *point {
            Some((error, seconds)) => {
                row.error.l2 = Some(error);
                row.seconds.total = seconds;
            }
            None => row.status = Outcome::Cycling,
        }
        row
    };
    points.iter().enumerate().map(row).collect()
}

/// The errors that a scheme reaches, of those at which schemes are compared, and the seconds that it takes.
fn reached(scheme: &str, rows: Vec<Row>) -> Vec<(f64, f64)> {
    let reach = report(rows).work_at_errors();
    assert!(reach.iter().all(|at| at.norm == ErrorNorm::L2));
    let of_scheme = reach.into_iter().filter(|at| at.variant.label == scheme);
    of_scheme.filter_map(|at| Some((at.error, at.seconds?))).collect()
}

/// One, two and five times powers of ten from a large error down to a small one, both included.
fn round_errors(largest: f64, smallest: f64) -> Vec<f64> {
    let of = |exponent: i32| [5, 2, 1].map(|digit| format!("{digit}e{exponent}").parse().unwrap());
    let all = (-8..=2).rev().flat_map(of);
    all.filter(|error: &f64| (smallest..=largest).contains(error)).collect()
}

#[test]
fn work_is_found_between_levels_and_not_beyond_them() {
    let rows = levels("p1", &[1e-1, 1e-3].map(|error| Some((error, 1.0 / error))));
    let found = reached("p1", rows.clone());
    let errors: Vec<f64> = found.iter().map(|at| at.0).collect();
    assert_eq!(errors, round_errors(1e-1, 1e-3));
    for (error, seconds) in found {
        assert!((seconds * error - 1.0).abs() < 1e-12, "{error}: {seconds}");
    }
    // another scheme is compared at errors beyond these
    let further = [1.0, 1e-1, 1e-3, 1e-5].map(|error| Some((error, 1.0 / error)));
    let mut both = rows;
    both.extend(levels("cr", &further));
    both.extend(levels("sipg", &further));
    let errors = |scheme: &str| -> Vec<f64> {
        reached(scheme, both.clone()).into_iter().map(|at| at.0).collect()
    };
    assert_eq!(errors("p1"), round_errors(1e-1, 1e-3));
    assert_eq!(errors("cr"), round_errors(1.0, 1e-5));
}

#[test]
fn interpolation_is_exact_for_power_laws_and_ends_with_the_data() {
    for (order, cost) in [(2.0, 3.0), (1.0, 2.0), (0.5, 1.1)] {
        let point = |n: f64| (3.0 * n.powf(-order), 7.0 * n.powf(cost));
        let ends = [4.0, 32.0].map(|n| point(n).0);
        let found = reached("p1", levels("p1", &[4.0, 9.0, 32.0].map(|n| Some(point(n)))));
        let errors: Vec<f64> = found.iter().map(|at| at.0).collect();
        assert_eq!(errors, round_errors(ends[0], ends[1]), "{order}");
        for (error, seconds) in found {
            let (_, expected) = point((3.0 / error).powf(1.0 / order));
            assert!((seconds / expected - 1.0).abs() <= 1e-12, "{order} {cost} {error}: {seconds}");
        }
    }
}

#[test]
fn a_level_that_failed_is_not_bridged_and_a_plateau_is_not_crossed_backwards() {
    let gap = [Some((1e-1, 1.0)), None, Some((1e-3, 4.0))];
    assert_eq!(reached("p1", levels("p1", &gap)), []);
    let up = [Some((1e-3, 1.0)), Some((1e-1, 2.0))];
    assert_eq!(reached("p1", levels("p1", &up)), []);
    assert_eq!(reached("p1", levels("p1", &[None, None])), []);
    // no work has a logarithm that is none
    let free = [Some((1e-1, 0.0)), Some((1e-3, 4.0))];
    assert_eq!(reached("p1", levels("p1", &free)), []);
    // beside schemes that reach an error, those that do not say why
    let mut rows = levels("p1", &gap);
    rows.extend(levels("sipg", &up));
    for scheme in ["cr", "wopsip"] {
        rows.extend(levels(scheme, &[Some((1.0, 1.0)), Some((1e-4, 4.0))]));
    }
    for at in report(rows).work_at_errors() {
        let expected = match (&at.variant.label[..], at.error) {
            ("cr" | "wopsip", _) => Standing::Reached,
            ("p1", error) if error >= 1e-1 => continue,
            ("p1", error) if error < 1e-3 => Standing::NotReached,
            ("p1", _) => Standing::Failed,
            (_, error) if error >= 1e-3 => Standing::Undercut,
            _ => continue,
        };
        assert_eq!(at.standing, expected, "{} {}", at.variant.label, at.error);
    }
}
