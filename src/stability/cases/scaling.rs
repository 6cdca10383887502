//! Invariance under a change of units.

use crate::error::Error;
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
use crate::stability::row_builder::{RowBuilder, quotient};
use crate::stability::runs::solved;

const DOMAIN: Criterion = Criterion::new(
    "size-of-domain",
    &[ExpectedRange::at_most(1e-10)],
    "On a domain L times as large, L from 1e-6 to 1e6, the solution is the same at corresponding points to {}. A factor eta without dimension is known to fail.",
);
const COEFFICIENT: Criterion = Criterion::new(
    "size-of-coefficient",
    &[ExpectedRange::at_most(1e-10)],
    "With coefficient and load c times as large, c from 1e-8 to 1e8, the solution is the same to {}. A penalty that ignores the coefficient is known to fail.",
);
pub(crate) const CASE: Case = Case { name: "scaling", criteria: &[DOMAIN, COEFFICIENT], plan };

fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick(8, 32);
    let lengths: &[f64] = plan.pick(&[1e-6, 1e6], &[1e-6, 1e-3, 1e3, 1e6]);
    let factors: &[f64] = plan.pick(&[1e-8, 1e8], &[1e-8, 1e-4, 1e4, 1e8]);
    let schemes = ["wopsip", "wopsip:facet-means"];
    for choice in plan.compared_and(&schemes.map(|scheme| Choice::with_eta(scheme, 0))) {
        plan.add(choice, "size of the domain", move |c, sink| {
            let has_dimension = c.options().eta.is_some();
            let claim = RowBuilder::new(&DOMAIN, c).known_to_fail(has_dimension);
            compare(c, level, ("L", lengths), scenes::radial, claim, sink)
        });
    }
    for choice in plan.compared_and(&schemes.map(Choice::without_coefficient)) {
        plan.add(choice, "size of the coefficient", move |c, sink| {
            let claim = RowBuilder::new(&COEFFICIENT, c).known_to_fail(c.ignores_coefficient);
            compare(c, level, ("c", factors), with_coefficient, claim, sink)
        });
    }
}

/// The scene of radius one with coefficient and load times a factor.
fn with_coefficient(factor: f64) -> Scene<2> {
    let mut scene = scenes::radial::<2>(1.0);
    scene.problem.source.everywhere = Some(Datum::Constant(-2.0 * factor));
    scene.problem = scene.problem.coefficient(move |_| factor);
    scene
}

/// Values at the vertices of all cells, and how the solve ended.
fn values(
    scene: &Scene<2>,
    choice: &Choice,
    level: usize,
) -> Result<(Option<Vec<f64>>, String), Error> {
    let meshes = Hierarchy::of_domain(&scene.domain, level)?;
    let problem = choice.problem(scene);
    let found = solved(&problem, &meshes, choice)?;
    let values = found.fields().filter(|_| found.converged()).map(|f| f.u);
    let error = found.errors()?;
    let error = error.h1.zip(error.l2);
    let error = error.map_or(String::new(), |(h1, l2)| format!(", H1 {h1:.2e}, L2 {l2:.2e}"));
    Ok((values, format!("{}{error}", found.outcome())))
}

/// The largest difference over the largest value.
fn difference(a: &Option<Vec<f64>>, b: &Option<Vec<f64>>) -> Option<f64> {
    let (a, b) = (a.as_ref()?, b.as_ref()?);
    let largest = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, maximum);
    quotient(Some(apart), Some(largest))
}

/// Compares the solutions in other units with that in units of one.
fn compare(
    choice: &Choice,
    level: usize,
    (parameter, units): (&str, &[f64]),
    make: fn(f64) -> Scene<2>,
    claim: RowBuilder,
    sink: Sink<'_>,
) -> Result<(), Error> {
    let (at_one, _) = values(&scenes::radial(1.0), choice, level)?;
    for &unit in units {
        let (here, how) = values(&make(unit), choice, level)?;
        sink(
            claim
                .clone()
                .on("radial-2d")
                .level(level)
                .at(parameter, unit)
                .quantity("relative difference of solutions")
                .detail(how)
                .measured(difference(&here, &at_one)),
        );
    }
    Ok(())
}
