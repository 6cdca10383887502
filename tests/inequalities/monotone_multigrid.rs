//! The monotone multigrid method: counts that do not depend on strict complementarity nor on the
//! mesh, and the solutions of the active set.

use unilateral::inequality::{
    ActiveSet, InequalitySolver, MonotoneMultigrid, SinglePrecision, Stage,
};
use unilateral::linear::LinearMethod;
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
        assert!(row.certificate.algebraic_bound.unwrap() < 1e-3, "{what}: {:?}", row.certificate);
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
