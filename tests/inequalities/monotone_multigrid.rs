//! The monotone multigrid method: counts that do not depend on strict complementarity nor on the
//! mesh, and the solutions of the active set.

use crate::problems::{inequality, laplacian, sparse};
use unilateral::algebra::{Bound, Inequality};
use unilateral::inequality::{
    ActiveSet, InequalitySolver, InitialGuess, MonotoneMultigrid, Outcome, SinglePrecision, Stage,
    StepCounter,
};
use unilateral::linear::{CoarseSpaces, LinearMethod, P1Level};
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::Row;

fn rows<const D: usize>(
    scene: Scene<D>,
    levels: &[usize],
    solver: impl InequalitySolver<f64> + 'static,
) -> Vec<Row> {
    let study = Study::<D>::new(scene).scheme(ConformingP1).solver(solver);
    study.levels(levels.iter().copied()).run().unwrap().rows
}

fn scenes_without_strictness() -> Vec<fn() -> Scene<2>> {
    vec![
        scenes::biactive_half_2d,
        scenes::biactive_ring_2d,
        || scenes::degenerate(2),
        || scenes::degenerate(4),
        scenes::spiral_2d,
        || scenes::radial(1.0),
        scenes::ball_2d,
    ]
}

/// Prints cycles next to active sets; returns the cycles.
fn compare(scene: fn() -> Scene<2>, levels: &[usize]) -> Vec<usize> {
    let found = rows(scene(), levels, MonotoneMultigrid::default());
    let exact = rows(scene(), levels, ActiveSet::default());
    for (row, exact) in found.iter().zip(&exact) {
        let what = format!("{} {}", row.scene, row.level);
        assert!(row.converged(), "{what}");
        assert!(row.certificate.largest() < 1e-9, "{what}: {:?}", row.certificate);
        let (a, b) = (row.objective.unwrap(), exact.objective.unwrap());
        assert!((a - b).abs() <= 1e-8 * b.abs(), "{what}: objective {a} and {b}");
        println!(
            "| {} | {} | {} | {} |",
            row.scene,
            row.level,
            row.iterations.outer.unwrap(),
            exact.iterations.outer.unwrap()
        );
    }
    found.iter().map(|row| row.iterations.outer.unwrap()).collect()
}

#[test]
fn cycles_do_not_grow() {
    for scene in scenes_without_strictness() {
        let cycles = compare(scene, &[16, 32, 64]);
        assert!(cycles.iter().all(|&cycles| cycles <= 25), "{cycles:?}");
    }
}

#[test]
#[ignore = "takes a minute: prints the cycles"]
fn cycles_do_not_grow_on_fine_meshes() {
    for scene in scenes_without_strictness() {
        let cycles = compare(scene, &[32, 64, 128, 256]);
        assert!(cycles.iter().all(|&cycles| cycles <= 25), "{cycles:?}");
    }
}

/// The L-shaped membrane with a ring in contact without force, by schemes of which a sweep by unknowns sees all that a
/// penalty couples.
fn lshape() -> Study<'static, 2> {
    Study::new(scenes::lshape_2d())
        .scheme(Sipg::default())
        .scheme_on(Wopsip::default(), FacetMeans)
        .scheme(NonconformingP1)
        .scheme(ConformingP2)
}

#[test]
fn cycles_with_the_preconditioner_of_a_scheme_find_the_solution_of_factors() {
    let run = |study: Study<'_, 2>| study.levels([16, 32]).run().unwrap().rows;
    let found = run(lshape().solver(MonotoneMultigrid::default()));
    let exact = run(lshape().solver(ActiveSet::default().linear(LinearMethod::Direct)));
    for (row, exact) in found.iter().zip(&exact) {
        let what = format!("{} {}", row.label, row.level);
        assert!(row.converged() && exact.converged(), "{what}");
        let (a, b) = (row.objective.unwrap(), exact.objective.unwrap());
        assert!((a - b).abs() <= 1e-9 * b.abs(), "{what}: objective {a} and {b}");
        let cycles = row.iterations.outer.unwrap();
        assert!(cycles <= 40, "{what}: {cycles}");
    }
}

/// Changes of a cycle below rounding do not fall: the certificate and the bound on the error decide.
#[test]
fn cycles_in_single_precision_end_at_rounding() {
    let study = Study::<2>::new(scenes::lshape_2d())
        .scheme(Sipg::default())
        .scheme_on(Wopsip::default(), FacetMeans)
        .scheme(ConformingP2);
    let solver = SinglePrecision::new(MonotoneMultigrid::default());
    for row in study.levels([8, 32]).solver(solver).run().unwrap().rows {
        let what = format!("{} {}", row.label, row.level);
        assert!(row.converged(), "{what}: {:?}", row.status);
        // of quadratics it has what rounding of the matrix does
        let limit = if row.scheme == "p2" { 2e-3 } else { 1e-3 };
        assert!(row.certificate.algebraic_bound.unwrap() < limit, "{what}: {:?}", row.certificate);
        assert!(row.iterations.outer.unwrap() <= 60, "{what}: {:?}", row.iterations);
    }
}

/// The cycles of the last stage, which is monotone multigrid.
fn cycles(row: &Row) -> usize {
    let (stages, what) = (&row.iterations.stages, format!("{} {}", row.label, row.level));
    let last = stages.last().unwrap();
    assert_eq!(last.stage, Stage::MonotoneMultigrid, "{what}: {stages:?}");
    assert!(row.converged() && row.certificate.largest() < 1e-9, "{what}: {:?}", row.certificate);
    let bound = row.certificate.algebraic_bound.unwrap();
    assert!(bound > 0.0 && bound < 1e-8, "{what}: {bound}");
    last.outer
}

#[test]
fn stagnating_active_sets_lead_to_cycles() {
    let study = Study::<2>::new(scenes::lshape_2d())
        .scheme(Sipg::default())
        .scheme_on(Wopsip::default(), FacetMeans);
    for row in study.levels([64]).run().unwrap().rows {
        assert!(cycles(&row) <= 30, "{}: {:?}", row.label, row.iterations.stages);
    }
}

#[test]
#[ignore = "takes a minute: prints the cycles"]
fn cycles_of_other_schemes_hardly_grow() {
    for row in lshape().levels([64, 128, 256]).run().unwrap().rows {
        println!("| {} | {} | {} |", row.label, row.level, cycles(&row));
        assert!(cycles(&row) <= 50, "{} {}", row.label, row.level);
    }
}

/// Second differences on `n` points without fixed ends, beside the rows `others` of two further unknowns.
fn beside_free_string(n: usize, others: [[f64; 2]; 2]) -> Inequality<f64> {
    let mut matrix = laplacian(n, 1, 2.0);
    for end in [0, n - 1] {
        let k = (matrix.row_starts[end] as usize..matrix.row_starts[end + 1] as usize)
            .find(|&k| matrix.columns[k] as usize == end);
        matrix.values[k.unwrap()] = 1.0;
    }
    for row in others {
        matrix.columns.extend([n as u32, n as u32 + 1]);
        matrix.values.extend(row);
        matrix.row_starts.push(matrix.columns.len() as u32);
    }
    inequality(matrix, &vec![-1.0; n + 2], vec![Bound::Lower(0.0); n + 2])
}

/// Both unknowns are in contact, so that no correction meets the direction (1, 1), in which the energy has negative
/// curvature and no lower bound.
#[test]
fn contact_does_not_hide_an_indefinite_matrix() {
    let matrix = sparse(&[vec![1.0, -2.0], vec![-2.0, 1.0]]);
    let held = inequality(matrix, &[-1.0; 2], vec![Bound::Lower(0.0); 2]);
    assert_eq!(MonotoneMultigrid::default().solve(&held).outcome, Outcome::NotCoercive);
}

/// The smallest eigenvalue of the string is zero, so that no eigenvalue bounds the error of the iterate, and both
/// further unknowns are in contact. The matrix must be positive semidefinite on all unknowns, not on admissible
/// directions alone.
#[test]
fn a_string_that_bounds_alone_hold_does_not_hide_an_indefinite_matrix() {
    let solve = |others| MonotoneMultigrid::default().solve(&beside_free_string(1000, others));
    assert_eq!(solve([[1.0, 2.0], [2.0, 1.0]]).outcome, Outcome::NotCoercive);
    assert_eq!(solve([[2.0, 1.0], [1.0, 2.0]]).outcome, Outcome::Converged);
}

/// A limit of zero admits cycles until the first one that does not halve the change of the values.
#[test]
fn the_limit_of_stagnating_cycles_counts_cycles_that_stagnate() {
    let string = string(2000);
    let of = |limit| MonotoneMultigrid::default().stagnation_cycles(limit).solve(&string);
    let whole = of(200);
    assert_eq!(whole.outcome, Outcome::Converged);
    let short = of(0);
    assert!(short.outer > 1 && short.outer < whole.outer, "{} {}", short.outer, whole.outer);
    assert_eq!(short.outcome, Outcome::Stalled);
}

/// Second differences on `n` points, fixed at both ends, above -1/30: the contact set is in the middle.
fn string(n: usize) -> Inequality<f64> {
    let mut bounds = vec![Bound::Lower(-1.0 / 30.0); n];
    (bounds[0], bounds[n - 1]) = (Bound::Fixed(0.0), Bound::Fixed(0.0));
    inequality(laplacian(n, 1, 2.0), &vec![-1.0 / (n * n) as f64; n], bounds)
}

#[test]
fn a_coarser_level_of_another_size_is_not_used() {
    let string = string(2000);
    let expected = MonotoneMultigrid::default().solve(&string);
    for other in [1500, 2500] {
        let level = P1Level::new(laplacian(other, 1, 2.0), vec![false; other], None).unwrap();
        let coarse_spaces = CoarseSpaces::CoarseLevel(level.coarser().unwrap().clone());
        let guess = InitialGuess::default().coarse_spaces(coarse_spaces);
        let found = MonotoneMultigrid::default().solve_from(&string, &guess);
        assert_eq!((found.outcome, found.values), (expected.outcome, expected.values.clone()));
    }
}

/// Cycles after the systems of an active set that stagnates count on.
#[test]
fn the_counter_includes_the_steps_before_the_first_cycle() {
    let steps = StepCounter::default();
    let study = Study::<2>::new(scenes::lshape_2d()).scheme(Sipg::default()).levels([64]);
    let rows = study.steps(steps.clone()).run().unwrap().rows;
    let stages = &rows[0].iterations.stages;
    assert!(stages.len() == 2 && stages[0].outer > 0 && cycles(&rows[0]) > 0, "{stages:?}");
    assert_eq!(steps.get(), stages[0].outer + stages[1].outer);
}
