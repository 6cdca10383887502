//! No strict complementarity: gap and multiplier vanish together.

use std::sync::Arc;

use crate::error::Error;
use crate::inequality::{InequalitySolver, InteriorPoint};
use crate::nested::Hierarchy;
use crate::scenes;
use crate::scenes::Scene;
use crate::stability::choice::Choice;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{RowBuilder, figures, fitted_order, listed, of};
use crate::stability::runs::{row, rows, solved_by, solver};
use crate::study::Row;

pub(crate) fn plan(plan: &mut Plan<'_>) {
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
            plan.add("biactive", choice, &make().name, move |c, sink| {
                orders(make, c, levels, sink)?;
                levels.iter().try_for_each(|&level| steps(make, c, level, sink))
            });
        }
        let string: fn() -> Scene<1> = scenes::oscillating_1d;
        plan.add("biactive", choice, "oscillating-1d", move |c, sink| {
            orders(&string, c, strings, sink)?;
            steps(&string, c, strings[0], sink)
        });
        plan.add("biactive", choice, "free boundary", move |c, sink| distances(c, finest, sink));
    }
}

fn orders<const D: usize>(
    make: &fn() -> Scene<D>,
    choice: &Choice,
    levels: &[usize],
    sink: Sink<'_>,
) -> Result<(), Error> {
    let rows = rows::<D>(make(), choice, levels)?;
    let name = make().name;
    type Norm = (&'static str, f64, fn(&Row) -> Option<f64>);
    let norms: [Norm; 2] = [("L2", 1.8, |r| r.error.l2), ("H1", 0.9, |r| r.error.h1)];
    for (norm, least, error) in norms {
        let errors: Vec<(usize, f64)> =
            rows.iter().filter_map(|r| Some((r.level, of(r, error)?))).collect();
        let order = (errors.len() == levels.len()).then(|| fitted_order(&errors)).flatten();
        let claim = RowBuilder::new("orders-on-biactive-sets", choice)
            .on(&name)
            .quantity(&format!("order in {norm}, fitted"))
            .at_least(least)
            .detail(format!("{norm} error {}", listed(&errors)));
        // a re-entrant corner limits the orders whatever the contact
        let claim = if name == "lshape-2d" { claim.only_reported() } else { claim };
        sink(claim.measured(order));
    }
    Ok(())
}

/// Linear systems of the library's own solver and of the interior point method from a cold start.
fn steps<const D: usize>(
    make: &fn() -> Scene<D>,
    choice: &Choice,
    level: usize,
    sink: Sink<'_>,
) -> Result<(), Error> {
    let scene = make();
    type Solver = Arc<dyn InequalitySolver<f64>>;
    let kinds: [(&str, Solver); 2] = [
        ("active-sets-tried", Arc::new(solver())),
        ("interior-point-steps", Arc::new(InteriorPoint)),
    ];
    let meshes = Hierarchy::of_domain(&scene.domain, level)?;
    for (criterion, solver) in kinds {
        let problem = choice.constrain(scene.problem.clone());
        let found = solved_by(solver, &problem, &meshes, choice, false)?;
        let steps = found.outer().filter(|_| found.converged());
        sink(
            RowBuilder::new(criterion, choice)
                .on(&scene.name)
                .level(level)
                .quantity("linear systems, cold")
                .at_most(40.0)
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
        RowBuilder::new("free-boundary", choice).on(name).level(level).quantity("distance over h")
    };
    let name = scene.name.clone();
    let found = row::<2>(scene, choice, level)?;
    let distance = |row: &Row| row.contact.free_boundary_distance.map(|d| d / size);
    sink(claim(&name).at_most(2.0).detail(figures(&found)).measured(of(&found, distance)));
    let found = row::<2>(scenes::biactive_half_2d(), choice, level)?;
    let why = "gap and multiplier vanish together: the contact set is no datum";
    sink(claim(&found.scene).not_applicable(why));
    Ok(())
}
