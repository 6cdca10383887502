//! Levels that are refinements of each other share their meshes, and the solutions from which schemes start.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use unilateral::algebra::Inequality;
use unilateral::inequality::{ActiveSet, InequalitySolver, InitialGuess, Solution};
use unilateral::prelude::*;

/// The active set method, which counts its solves.
#[derive(Default)]
struct Counted(Arc<AtomicUsize>);

impl InequalitySolver<f64> for Counted {
    fn name(&self) -> &'static str {
        "counted"
    }
    fn solve(&self, inequality: &Inequality<f64>) -> Solution<f64> {
        self.solve_from(inequality, &InitialGuess::default())
    }
    fn solve_from(&self, inequality: &Inequality<f64>, guess: &InitialGuess<f64>) -> Solution<f64> {
        self.0.fetch_add(1, Ordering::Relaxed);
        ActiveSet::default().solve_from(inequality, guess)
    }
}

/// The number of solves of a study of one scheme, those of its starts included.
fn solves(levels: &[usize]) -> usize {
    let solver = Counted::default();
    let count = Arc::clone(&solver.0);
    let study = Study::<2>::new(scenes::radial(1.0)).scheme(Sipg::default()).solver(solver);
    let report = study.levels(levels.to_vec()).run().unwrap();
    assert!(report.rows.iter().all(|row| row.converged()));
    count.load(Ordering::Relaxed)
}

/// A level of a hierarchy has one solve more, that of the scheme: its starts are there already. Of 8, 12, 16, 6 and 7 the
/// levels 8 and 16 are in one hierarchy, 6 and 12 in another one.
#[test]
fn levels_that_are_refinements_of_each_other_share_a_hierarchy() {
    let [of_16, of_12, of_7] = [[16], [12], [7]].map(|levels| solves(&levels));
    assert!(of_16 > of_12 && of_12 > of_7, "{of_16} {of_12} {of_7}");
    assert_eq!(solves(&[8, 16]), of_16 + 1);
    assert_eq!(solves(&[6, 12]), of_12 + 1);
    assert_eq!(solves(&[8, 12, 16, 6, 7]), of_16 + 1 + of_12 + 1 + of_7);
}
