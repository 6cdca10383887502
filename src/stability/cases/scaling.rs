//! Invariance under a change of units.

use crate::error::Error;
use crate::nested::Hierarchy;
use crate::problem::Datum;
use crate::scenes;
use crate::scenes::Scene;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{RowBuilder, quotient};
use crate::stability::runs::solved;

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick(8, 32);
    let lengths: &[f64] = plan.pick(&[1e-6, 1e6], &[1e-6, 1e-3, 1e3, 1e6]);
    let factors: &[f64] = plan.pick(&[1e-8, 1e8], &[1e-8, 1e-4, 1e4, 1e8]);
    for choice in plan.compared_and(&[
        Choice::new("wopsip", Penalty::Eta(1.0)),
        Choice::new("wopsip:facet-means", Penalty::Eta(1.0)),
    ]) {
        plan.add("scaling", choice, "size of the domain", move |c, sink| {
            domain(c, level, lengths, sink)
        });
    }
    for choice in plan.compared_and(&[
        Choice::new("wopsip", Penalty::Unweighted),
        Choice::new("wopsip:facet-means", Penalty::Unweighted),
    ]) {
        plan.add("scaling", choice, "size of the coefficient", move |c, sink| {
            coefficient(c, level, factors, sink)
        });
    }
}

/// Values at the vertices of all cells, and how the solve ended.
fn values(
    scene: &Scene<2>,
    choice: &Choice,
    level: usize,
) -> Result<(Option<Vec<f64>>, String), Error> {
    let meshes = Hierarchy::of_domain(&scene.domain, level)?;
    let problem = choice.constrain(scene.problem.clone());
    let found = solved(&problem, &meshes, choice, true)?;
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
    // what is not a number must not hide
    let worse = |m: f64, d: f64| if d.is_nan() || d > m { d } else { m };
    let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, worse);
    quotient(Some(apart), Some(largest))
}

fn domain(choice: &Choice, level: usize, lengths: &[f64], sink: Sink<'_>) -> Result<(), Error> {
    let (at_one, _) = values(&scenes::radial(1.0), choice, level)?;
    for &length in lengths {
        let (here, how) = values(&scenes::radial(length), choice, level)?;
        sink(
            RowBuilder::new("size-of-domain", choice)
                .on("radial-2d")
                .level(level)
                .at("L", length)
                .quantity("relative difference of solutions")
                .at_most(1e-10)
                .known_to_fail(choice.penalty == Penalty::Eta(1.0))
                .detail(how)
                .measured(difference(&here, &at_one)),
        );
    }
    Ok(())
}

fn coefficient(
    choice: &Choice,
    level: usize,
    factors: &[f64],
    sink: Sink<'_>,
) -> Result<(), Error> {
    let (at_one, _) = values(&scenes::radial(1.0), choice, level)?;
    for &factor in factors {
        let mut scene = scenes::radial::<2>(1.0);
        scene.problem.source.everywhere = Some(Datum::Constant(-2.0 * factor));
        scene.problem = scene.problem.coefficient(move |_| factor);
        let (here, how) = values(&scene, choice, level)?;
        sink(
            RowBuilder::new("size-of-coefficient", choice)
                .on("radial-2d")
                .level(level)
                .at("c", factor)
                .quantity("relative difference of solutions")
                .at_most(1e-10)
                .known_to_fail(choice.penalty == Penalty::Unweighted)
                .detail(how)
                .measured(difference(&here, &at_one)),
        );
    }
    Ok(())
}
