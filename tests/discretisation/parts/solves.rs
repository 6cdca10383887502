//! Inequalities solved over the parts of a mesh against one process.

use super::gathered::process;
use crate::shapes;
use std::sync::Arc;
use unilateral::inequality::Outcome;
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::processes::{Exchange, InProcess, in_process};
use unilateral::scenes::Scene;
use unilateral::study::Row;

/// Errors of a solve and of another one differ by less than this share.
const ALGEBRA: f64 = 1e-6;

fn study<const D: usize>(
    scene: &Scene<D>,
    schemes: &[&str],
    levels: &[usize],
) -> Study<'static, D> {
    let named = NamedScheme::list(schemes.iter().copied()).unwrap();
    let study = Study::new(scene.clone()).levels(levels.iter().copied());
    named.iter().fold(study, Study::named_scheme)
}

/// The rows of a study over so many parts, in every part.
fn on_parts<const D: usize>(
    scene: &Scene<D>,
    (schemes, levels): (&[&str], &[usize]),
    parts: usize,
) -> Vec<Vec<Row>> {
    in_process(parts, |number, exchange| {
        let process = process(number, exchange);
        study(scene, schemes, levels).run_on_parts(&process).unwrap().rows
    })
}

/// Holds rows over parts to those of one process: sizes, errors, totals, and the iterations to
/// those of a single part.
#[track_caller]
fn holds<const D: usize>(scene: &Scene<D>, schemes: &[&str], levels: &[usize], parts: &[usize]) {
    let serial = study(scene, schemes, levels).run().unwrap().rows;
    let alone = on_parts(scene, (schemes, levels), 1).remove(0);
    for &parts in parts {
        let of_parts = on_parts(scene, (schemes, levels), parts);
        for ((row, one), alone) in of_parts[0].iter().zip(&serial).zip(&alone) {
            let label = format!("{} {} {} on {parts} parts", row.scene, row.label, row.level);
            assert_eq!(row.status, Outcome::Converged, "{label}: {:?}", row.message);
            assert_eq!([row.unknowns, row.nonzeros], [one.unknowns, one.nonzeros], "{label}");
            assert_eq!(row.cells, one.cells, "{label}");
            // some midpoint values of quadratics touch the obstacle without a force but for rounding
            let is_strict = !row.scheme.ends_with("p2");
            if is_strict {
                assert_eq!(row.active, one.active, "{label}");
            }
            let numbers = |row: &Row| {
                let errors = [row.error.l2, row.error.h1, row.error.energy, row.error.max];
                let contact = row.contact_measure.filter(|_| is_strict);
                [&errors[..], &[row.energy, row.objective, contact, row.resultant]].concat()
            };
            for (k, (found, expected)) in numbers(row).into_iter().zip(numbers(one)).enumerate() {
                let (Some(found), Some(expected)) = (found, expected) else {
                    assert_eq!(found, expected, "{label}, number {k}");
                    continue;
                };
                let difference = (found - expected).abs();
                assert!(
                    difference <= ALGEBRA * expected.abs(),
                    "{label}, number {k}: {found} {expected}"
                );
            }
            compare_bounds(row, one, &label);
            let ranks = row.ranks.as_ref().unwrap();
            assert_eq!(ranks.count, parts);
            let [many, few] = [row, alone].map(|row| row.iterations.linear as f64);
            assert!(
                (many - few).abs() <= (0.1 * few).max(2.0),
                "{label}: {few} and {many} iterations"
            );
        }
        for rows in &of_parts[1..] {
            for (row, first) in rows.iter().zip(&of_parts[0]) {
                assert_eq!((&row.error, &row.iterations), (&first.error, &first.iterations));
            }
        }
    }
}

/// Bounds differ by multipliers that parts do not exchange with one another.
#[track_caller]
fn compare_bounds(row: &Row, one: &Row, label: &str) {
    if one.scheme.ends_with("p2") {
        let reason = row.bound.reason.as_deref().unwrap();
        assert!(reason.contains("linear functions"), "{label}: {reason}");
        return;
    }
    let numbers = |row: &Row| [row.bound.total, row.bound.distance].map(Option::unwrap);
    let [total, _] = numbers(one);
    // multipliers of obstacles are not exchanged between parts
    let most = if row.scene == "signorini-2d" { ALGEBRA } else { 0.1 };
    for (found, expected) in numbers(row).into_iter().zip(numbers(one)) {
        assert!((found - expected).abs() <= most * total, "{label}: {found} {expected}");
    }
    assert_eq!(row.bound.guaranteed, one.bound.guaranteed, "{label}");
    assert_eq!(row.bound.effectivity.is_some(), one.bound.effectivity.is_some(), "{label}");
    assert!(row.bound.effectivity.is_none_or(|e| e >= 1.0 - 1e-8), "{label}: {:?}", row.bound);
}

#[test]
fn obstacle_problems_in_the_plane_have_the_solution_of_one_process() {
    let schemes = [
        "p1",
        "p2",
        "cr",
        "sipg",
        "nipg",
        "iipg",
        "ldg",
        "br2",
        "bmmpr",
        "sipg-p2",
        "wopsip",
        "wopsip:facet-means",
    ];
    holds(&scenes::radial::<2>(1.0), &schemes, &[8, 16], &[2, 3]);
}

#[test]
fn contact_problems_in_the_plane_have_the_solution_of_one_process() {
    let scene = scenes::catalogue().into_iter().find(|scene| scene.name == "signorini-2d").unwrap();
    let scenes::AnyScene::Two(scene) = scene.make(&scenes::Parameters::new()).unwrap() else {
        panic!("two dimensions")
    };
    let schemes = ["p1", "cr", "sipg", "wopsip", "wopsip:facet-means"];
    holds(&scene, &schemes, &[16], &[3]);
}

#[test]
fn problems_on_a_line_and_in_space_have_the_solution_of_one_process() {
    // the coarsest mesh has 16 cells for each part, and conforming P1 starts from it
    holds(&scenes::radial::<1>(1.0), &["p1", "sipg", "wopsip"], &[128, 256], &[2, 3]);
    let schemes = ["p1", "cr", "sipg", "wopsip", "wopsip:facet-means"];
    holds(&scenes::radial::<3>(1.0), &schemes, &[4], &[2]);
}

#[test]
fn problems_on_curved_boundaries_have_the_solution_of_one_process() {
    let of = |problem: Problem<2>| Scene::of_problem("disc", problem, shapes::disc()).unwrap();
    let schemes = ["p1", "p2", "cr", "sipg", "wopsip"];
    holds(&of(shapes::paraboloid(&["rim"])), &schemes, &[0, 1], &[2, 3]);
}

/// Where the preconditioner does not suffice, factors of the matrix do.
#[test]
fn contrasts_are_solved_with_factors() {
    let scene =
        scenes::catalogue().into_iter().find(|scene| scene.name == "contrast-disc-2d").unwrap();
    let scenes::AnyScene::Two(scene) = scene.make(&scenes::Parameters::new()).unwrap() else {
        panic!("two dimensions")
    };
    let serial = study(&scene, &["sipg", "wopsip"], &[8]).run().unwrap().rows;
    for (row, one) in on_parts(&scene, (&["sipg", "wopsip"], &[8]), 3).remove(0).iter().zip(&serial)
    {
        assert_eq!(row.status, Outcome::Converged, "{}", row.label);
        assert_eq!(row.active, one.active);
        let [found, expected] = [row, one].map(|row| row.error.l2.unwrap());
        assert!(
            (found - expected).abs() <= ALGEBRA * expected,
            "{}: {found} {expected}",
            row.label
        );
    }
}

/// A penalty that is too small is found by factors, as in one process, whatever a Krylov method sees of it.
#[test]
fn a_matrix_that_is_not_positive_definite_is_no_solution() {
    let scene = scenes::radial::<2>(1.0);
    let schemes = ["sipg@sigma=3", "sipg@sigma=1", "nipg@sigma=1"];
    let serial = study(&scene, &schemes, &[8]).run().unwrap().rows;
    let found = on_parts(&scene, (&schemes, &[8]), 2).remove(0);
    for (row, one) in found.iter().zip(&serial) {
        assert_eq!(row.status, one.status, "{}", row.label);
        assert_eq!(row.error.l2.is_some(), one.error.l2.is_some(), "{}", row.label);
        assert_eq!(row.energy.is_some(), one.energy.is_some(), "{}", row.label);
    }
    assert_eq!(found[0].status, Outcome::NotCoercive);
}

/// The sizes of data are those of all parts: a part may have small ones alone.
#[test]
fn data_that_vanish_in_one_part_are_in_range() {
    let mut scene = scenes::radial::<2>(1.0);
    let corner = Point::from([-1.4, -1.4]);
    let load = move |x: &Point<2>| -100.0 * (-2000.0 * (x - corner).norm_squared()).exp();
    scene.problem.source = Datum::from(load).into();
    scene.problem.lower.everywhere = None;
    scene.problem.exact = None;
    scene.problem = scene.problem.dirichlet(|_| 0.0);
    for row in on_parts(&scene, (&["p1", "sipg"], &[8]), 4).remove(0) {
        assert_eq!(row.status, Outcome::Converged, "{}", row.label);
    }
}

/// Bounds that contradict each other, in one part, have the status that they have in one process.
#[test]
fn contradicting_bounds_are_infeasible() {
    let mut scene = scenes::radial::<2>(1.0);
    scene.problem.exact = None;
    scene.problem =
        scene.problem.obstacle_above(|x: &Point<2>| if x[0] > 1.2 { -5.0 } else { 5.0 });
    let serial = study(&scene, &["p1"], &[8]).run().unwrap().rows;
    let rows = on_parts(&scene, (&["p1"], &[8]), 2).remove(0);
    assert_eq!([serial[0].status, rows[0].status], [Outcome::Infeasible; 2]);
}

/// Data that are no numbers in one part, and a scheme that parts do not have: a row of every part says so.
#[test]
fn a_failure_in_one_part_is_a_row_of_all_parts() {
    let mut scene = scenes::radial::<2>(1.0);
    scene.problem =
        scene.problem.source(|x| if x[0] > 1.4 && x[1] > 1.4 { f64::NAN } else { -2.0 });
    let all = on_parts(&scene, (&["p1", "sipg"], &[8]), 3);
    for rows in &all {
        assert_eq!(rows.len(), 2);
        for row in rows {
            assert_eq!(row.status, Outcome::NotFinite);
            let message = row.message.as_deref().unwrap();
            assert!(message.starts_with("part ") && message.contains("source is NaN"), "{message}");
            assert_eq!(row.message, all[0][0].message);
        }
    }
    let rows = on_parts(&scenes::radial::<2>(1.0), (&["wopsip-p2"], &[8]), 2).remove(0);
    assert_eq!(rows[0].status, Outcome::OutOfRange);
    assert!(rows[0].message.as_deref().unwrap().contains("over-penalised quadratics"));
}

/// A thread that ends early ends the others with an error: nobody waits for it.
#[test]
fn a_part_that_leaves_ends_the_others() {
    let scene = scenes::radial::<2>(1.0);
    let ended = in_process(3, |number, exchange: &Arc<InProcess>| {
        if number == 1 {
            // it takes part once
            let _ = exchange.largest(&[0.0]);
            return None;
        }
        let process = process(number, exchange);
        exchange.largest(&[0.0]).unwrap();
        Some(study(&scene, &["p1"], &[8]).run_on_parts(&process).is_err())
    });
    assert_eq!(ended, [Some(true), None, Some(true)]);
}
