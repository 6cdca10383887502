//! The history of a solve: linear systems, seconds and certificates after every outer step.

use unilateral::inequality::{
    ActiveSet, InequalitySolver, SOLVERS, SinglePrecision, Stage, solver_by_name,
};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;
use unilateral::real::Precision;
use unilateral::scenes::{AnyScene, Parameters};
use unilateral::study::Row;

type Solver = Box<dyn InequalitySolver<f64>>;

fn named(name: &str, linear: LinearMethod) -> Solver {
    solver_by_name(name, linear, Precision::Double).unwrap()
}

/// The rows of schemes on a scene of the catalogue in the plane.
fn rows_on(
    (scene, levels): (&str, &[usize]),
    schemes: &[&str],
    solver: Solver,
    keeps_history: bool,
) -> Vec<Row> {
    let scene = scenes::by_name(scene).unwrap().make(&Parameters::default()).unwrap();
    let AnyScene::Two(scene) = scene else { panic!("a scene in the plane") };
    let study = Study::<2>::new(scene).boxed_solver(solver).levels(levels.to_vec());
    let add =
        |study: Study<'static, 2>, scheme: &&str| study.named_scheme(&scheme.parse().unwrap());
    schemes.iter().fold(study, add).history(keeps_history).run().unwrap().rows
}

fn rows(solver: Solver, keeps_history: bool) -> Vec<Row> {
    rows_on(("radial-2d", &[8, 32]), &["p1", "sipg", "wopsip"], solver, keeps_history)
}

/// Checks the histories of all rows that converged; returns how many these are.
fn check(rows: &[Row], limit: f64) -> usize {
    let converged = rows.iter().filter(|row| row.converged());
    for row in converged.clone() {
        let what = format!("{}, {}, {}", row.label, row.solver, row.level);
        let history = row.history.as_ref().unwrap();
        let (systems, seconds, certificate) = *history.last().unwrap();
        assert_eq!(Some(history.len()), row.iterations.outer, "{what}");
        assert_eq!(Some(systems), row.iterations.systems, "{what}");
        assert!(history.is_sorted_by(|a, b| a.0 < b.0 && a.1 < b.1), "{what}: {history:?}");
        assert!(history[0].1 > 0.0 && seconds.is_finite(), "{what}: {history:?}");
        assert!(certificate <= Some(limit) && certificate.is_some(), "{what}: {certificate:?}");
        assert!(history[0].2 > certificate || history.len() == 1, "{what}: {history:?}");
    }
    converged.count()
}

#[test]
fn histories_of_all_solvers_end_at_their_solutions() {
    for (name, _) in SOLVERS {
        let rows = rows(named(name, LinearMethod::BySize), true);
        assert!(check(&rows, 1e-9) >= 5, "{name}");
        for row in rows.iter().filter(|row| row.converged() && row.solver != "active-set") {
            let last = row.history.as_ref().unwrap().last().unwrap();
            assert_eq!(row.iterations.systems, row.iterations.outer, "{name}");
            // nothing changes the values after the last step
            assert_eq!(last.2, Some(row.certificate.largest()), "{name}, {}", row.label);
        }
    }
}

/// Where a Krylov method solves the system of an active set again, more accurately, it counts again, and so does the
/// correction that gives jump multipliers.
#[test]
fn systems_that_are_solved_again_count() {
    let rows = rows(named("active-set", LinearMethod::Iterative), true);
    assert_eq!(check(&rows, 1e-9), rows.len());
    assert!(rows.iter().any(|row| row.iterations.systems > row.iterations.outer));
}

/// Where the active set stagnates other methods follow: the history goes on.
#[test]
fn stages_share_a_history() {
    for (scene, level, scheme, last) in [
        ("degenerate2-2d", 128, "p1", Stage::MonotoneMultigrid),
        ("biactive-half-2d", 16, "wopsip-p2", Stage::DirectActiveSet),
    ] {
        let solver = named("active-set", LinearMethod::BySize);
        let rows = rows_on((scene, &[level]), &[scheme], solver, true);
        let stages = &rows[0].iterations.stages;
        assert!(stages.len() > 1 && stages.last().map(|run| run.stage) == Some(last), "{stages:?}");
        assert_eq!(check(&rows, 1e-9), 1);
    }
}

#[test]
fn single_precision_has_a_history() {
    let rows = rows(Box::new(SinglePrecision::new(ActiveSet::default())), true);
    assert_eq!(check(&rows, 1e-4), rows.len());
}

#[test]
fn a_history_changes_nothing_else() {
    let [with, without] =
        [true, false].map(|keeps| rows(named("active-set", LinearMethod::BySize), keeps));
    for (with, without) in with.iter().zip(&without) {
        assert!(with.history.is_some() && without.history.is_none());
        assert_eq!(with.iterations, without.iterations);
        assert_eq!((with.error, with.certificate), (without.error, without.certificate));
    }
}
