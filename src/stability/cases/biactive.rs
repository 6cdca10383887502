//! No strict complementarity: gap and multiplier vanish together.

use std::sync::Arc;

use crate::error::Error;
use crate::inequality::{InequalitySolver, InteriorPoint};
use crate::nested::Hierarchy;
use crate::scenes;
use crate::scenes::Scene;
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, figures, of};
use crate::stability::runs::{H1, L2, fit, row, solved_by, solver};

const ORDERS: Criterion = Criterion::new(
    "orders-on-biactive-sets",
    &[ExpectedRange::at_least(1.8), ExpectedRange::at_least(0.9)],
    "Gap and multiplier that vanish together do not change orders: fitted over all levels, L2 at least {} and H1 at least {} where the solution is smooth enough.",
);
const ACTIVE_SETS: Criterion = Criterion::new(
    "active-sets-tried",
    &[ExpectedRange::at_most(40.0)],
    "From a cold start the active set method and what follows where it stagnates solve at most {} linear systems.",
);
const INTERIOR_POINT: Criterion = Criterion::new(
    "interior-point-steps",
    &[ExpectedRange::at_most(40.0)],
    "The interior point method solves at most {} linear systems.",
);
const FREE_BOUNDARY: Criterion = Criterion::new(
    "free-boundary",
    &[ExpectedRange::at_most(2.0)],
    "Where gap and multiplier vanish together the contact set is no datum of the problem; its distance from the exact one is meaningful for the strictly complementary part only, and is then at most {}h.",
);
pub(crate) const CASE: Case = Case {
    name: "biactive",
    criteria: &[ORDERS, ACTIVE_SETS, INTERIOR_POINT, FREE_BOUNDARY],
    plan,
};

fn plan(plan: &mut Plan<'_>) {
    let levels: &[usize] = plan.pick_of(&[4, 8], &[8, 16, 32], &[8, 16, 32, 64]);
    let plane: &[fn() -> Scene<2>] = plan.pick(
        &[scenes::biactive_half_2d],
        &[
            scenes::biactive_half_2d,
            scenes::biactive_ring_2d,
            || scenes::degenerate(4),
            || scenes::lshape_2d(),
        ],
    );
    let strings: &[usize] = plan.pick(&[64, 128, 256], &[64, 128, 256, 512]);
    let finest = plan.pick_of(8, 16, 32);
    for choice in plan.compared() {
        for make in plane {
            plan.add(choice, &make().name, move |c, sink| {
                fit(&ORDERS, &make(), c, levels, &[L2, H1], sink)?;
                levels.iter().try_for_each(|&level| steps(&make(), c, level, sink))
            });
        }
        plan.add(choice, "oscillating-1d", move |c, sink| {
            fit(&ORDERS, &scenes::oscillating_1d(), c, strings, &[L2, H1], sink)?;
            steps(&scenes::oscillating_1d(), c, strings[0], sink)
        });
        plan.add(choice, "free boundary", move |c, sink| distances(c, finest, sink));
    }
}

/// Linear systems of the library's own solver and of the interior point method from a cold start.
fn steps<const D: usize>(
    scene: &Scene<D>,
    choice: &Choice,
    level: usize,
    sink: Sink<'_>,
) -> Result<(), Error> {
    let kinds: [(_, Arc<dyn InequalitySolver<f64>>); 2] =
        [(&ACTIVE_SETS, Arc::new(solver())), (&INTERIOR_POINT, Arc::new(InteriorPoint))];
    let meshes = Hierarchy::of_domain(&scene.domain, level)?;
    for (criterion, solver) in kinds {
        let problem = choice.problem(scene);
        let found = solved_by(solver, &problem, &meshes, choice, true)?;
        let steps = found.outer().filter(|_| found.converged());
        sink(
            RowBuilder::new(criterion, choice)
                .on(&scene.name)
                .level(level)
                .quantity("linear systems, cold")
                .detail(format!("{} after {}", found.outcome(), found.outer().unwrap_or(0)))
                .measured(steps.map(|n| n as f64)),
        );
    }
    Ok(())
}

fn distances(choice: &Choice, level: usize, sink: Sink<'_>) -> Result<(), Error> {
    let scene = scenes::polynomial::<2>();
    let size = scene.domain.length() / level as f64;
    let claim = |name: &str| {
        let of = RowBuilder::new(&FREE_BOUNDARY, choice).on(name).level(level);
        of.quantity("distance over h")
    };
    let found = row(&scene, choice, level)?;
    let distance = of(&found, |row| row.contact.free_boundary_distance.map(|d| d / size));
    sink(claim(&scene.name).detail(figures(&found)).measured(distance));
    let why = "gap and multiplier vanish together: the contact set is no datum";
    sink(claim(&scenes::biactive_half_2d().name).not_applicable(why));
    Ok(())
}
