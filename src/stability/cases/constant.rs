//! A constant added to obstacle and Dirichlet data.

use std::sync::Arc;

use crate::error::Error;
use crate::inequality::Outcome;
use crate::nested::Hierarchy;
use crate::problem::Datum;
use crate::real::maximum;
use crate::scenes;
use crate::scenes::Scene;
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::RowBuilder;
use crate::stability::runs::solved;

const CONSTANT: Criterion = Criterion::new(
    "constant-in-the-data",
    &[ExpectedRange::at_most(64.0)],
    "With a number c from -1e7 to 1e7 added to obstacle and Dirichlet data the solve ends the same way, and the solution less c is the same to {} units of rounding of c.",
);
pub(crate) const CASE: Case = Case { name: "constant", criteria: &[CONSTANT], plan };

fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick(8, 32);
    let constants: &[f64] = plan.pick(&[300.0, -1e7], &[300.0, 1e5, -1e7]);
    for choice in plan.compared() {
        plan.add(choice, "a constant in the data", move |c, sink| {
            compare(c, level, constants, sink)
        });
    }
}

/// The scene of radius one with a constant added to its solution.
fn with_constant(constant: f64) -> Scene<2> {
    let mut scene = scenes::radial::<2>(1.0);
    scene.problem.lower.everywhere = Some(Datum::Constant(constant));
    if let Some(exact) = &mut scene.problem.exact {
        let value = exact.value.clone();
        exact.value = Datum::Function(Arc::new(move |x| constant + value.at(x)));
    }
    scene
}

/// A solution: its values at the vertices of all cells if the solve converged, how it ended, and the number of systems,
/// which rounding decides for quadratics: these have no multipliers at vertices.
struct Found {
    values: Option<Vec<f64>>,
    outcome: Outcome,
    systems: usize,
}

fn found(scene: &Scene<2>, choice: &Choice, level: usize) -> Result<Found, Error> {
    let meshes = Hierarchy::of_domain(&scene.domain, level)?;
    let problem = choice.problem(scene);
    let found = solved(&problem, &meshes, choice)?;
    Ok(Found {
        values: found.fields().filter(|_| found.converged()).map(|fields| fields.u),
        outcome: found.outcome(),
        systems: found.solution().systems.unwrap_or_default(),
    })
}

/// Compares the solution for each constant in the data with the solution without one.
fn compare(choice: &Choice, level: usize, constants: &[f64], sink: Sink<'_>) -> Result<(), Error> {
    let without = found(&with_constant(0.0), choice, level)?;
    for &constant in constants {
        let with = found(&with_constant(constant), choice, level)?;
        let apart = |(a, b): (&f64, &f64)| (a + constant - b).abs();
        let largest = |(a, b): (&Vec<f64>, &Vec<f64>)| {
            a.iter().zip(b).map(apart).fold(0.0, maximum) / (f64::EPSILON * constant.abs())
        };
        let figure = without.values.as_ref().zip(with.values.as_ref()).map(largest);
        let is_alike = with.outcome == without.outcome;
        let row = RowBuilder::new(&CONSTANT, choice).on("radial-2d").level(level);
        sink(
            row.at("c", constant)
                .quantity("difference less c, in units of rounding of c")
                .detail(format!("{}, {} systems", with.outcome, with.systems))
                .measured(figure.filter(|_| is_alike)),
        );
    }
    Ok(())
}
