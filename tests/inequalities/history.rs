//! The history of a solve: linear systems, seconds and certificates after every outer step.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use crate::problems::{inequality, laplacian};
use unilateral::algebra::{Bound, Distribution};
use unilateral::inequality::{
    ActiveSet, InequalitySolver, InitialGuess, Outcome, SOLVERS, SinglePrecision, Stage, certify,
    solver_by_name,
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
        assert_eq!((&with.error, with.certificate), (&without.error, without.certificate));
    }
}

/// One part that has all unknowns, which counts its sums over parts and takes its time for each.
#[derive(Debug)]
struct Slow {
    sums: AtomicUsize,
    pause: Duration,
}

impl Distribution for Slow {
    fn owns(&self, _: usize) -> bool {
        true
    }
    fn number(&self, unknown: usize) -> u64 {
        unknown as u64
    }
    fn exchange(&self, _: &dyn Fn(usize) -> f64, _: &mut dyn FnMut(usize, f64)) {}
    fn sum(&self, _: &mut [f64]) {
        self.sums.fetch_add(1, Ordering::Relaxed);
        std::thread::sleep(self.pause);
    }
    fn largest(&self, _: &mut [f64]) {}
}

/// A certificate asks for sums over the parts: with a history there are those of one certificate for each system more
/// than without, and their time is in no point.
#[test]
fn the_clock_stands_still_for_certificates_and_none_is_computed_without_a_history() {
    let n = 4;
    let mut string = inequality(laplacian(n, 1, 2.0), &vec![-1.0; n], vec![Bound::Lower(-1.5); n]);
    string.is_definite = true;
    let pause = Duration::from_millis(2);
    let mut run = |keeps_history: bool| {
        let slow = Arc::new(Slow { sums: AtomicUsize::new(0), pause });
        string.distribution = Some(slow.clone());
        let guess = InitialGuess::default().keeps_history(keeps_history);
        let begin = Instant::now();
        let solution = ActiveSet::default().solve_from(&string, &guess);
        let seconds = begin.elapsed().as_secs_f64();
        assert_eq!(solution.outcome, Outcome::Converged);
        let n_sums = slow.sums.load(Ordering::Relaxed);
        assert!(certify(&string, &solution.values).largest() < 1e-9);
        let of_certificate = slow.sums.load(Ordering::Relaxed) - n_sums;
        (solution, seconds, n_sums, of_certificate)
    };
    let (with, seconds, n_with, of_certificate) = run(true);
    let (without, _, n_without, _) = run(false);
    let systems = with.systems.unwrap();
    assert!(systems > 1 && of_certificate > 0 && without.history.is_empty());
    assert_eq!(without.systems, with.systems);
    assert_eq!(n_with - n_without, systems * of_certificate);
    let history = &with.history;
    assert!(history.is_sorted_by(|a, b| a.seconds < b.seconds), "{history:?}");
    let in_certificates = (n_with - n_without) as f64 * pause.as_secs_f64();
    assert!(history.last().unwrap().seconds + in_certificates <= seconds, "{history:?} {seconds}");
}
