//! Orders that experience expects.

use crate::error::Error;
use crate::scenes;
use crate::scenes::Scene;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{
    RowBuilder, figures, fitted_order, jump, listed, of, quotient,
};
use crate::stability::runs::{row, rows, sines};
use crate::study::Row;

/// A norm of the error by name, and the least order expected of it.
type Norm = (&'static str, Option<f64>, fn(&Row) -> Option<f64>);

const OVER_PENALTY: [Norm; 3] = [
    ("L2", Some(1.9), |r| r.error.l2),
    ("H1", Some(0.97), |r| r.error.h1),
    ("jumps", Some(0.9), jump),
];

/// Problems in the plane on which the over-penalty is to show its orders.
const PLANE: [fn() -> Scene<2>; 8] = [
    || scenes::radial(1.0),
    scenes::polynomial::<2>,
    scenes::signorini_harmonic::<2>,
    scenes::signorini_2d,
    || scenes::signorini_smooth(3),
    scenes::signorini_biactive_2d,
    scenes::signorini_two_2d,
    || scenes::signorini_layers_2d(1e4),
];

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let levels: &[usize] = plan.pick_of(&[8, 16], &[16, 32, 64], &[32, 64, 128]);
    let plane = if plan.is_full() { &PLANE[..] } else { &PLANE[..1] };
    let strings: &[usize] = &[32, 64, 128, 256];
    for scheme in ["wopsip", "wopsip:facet-means"] {
        let choice = Choice::default(scheme);
        for make in plane {
            plan.add("orders", choice, &make().name, move |c, sink| {
                fit("orders-of-over-penalty", make(), c, levels, &OVER_PENALTY, sink)
            });
        }
        for make in [scenes::parabola_1d as fn() -> Scene<1>, scenes::signorini_reaction_1d] {
            plan.add("orders", choice, &make().name, move |c, sink| {
                fit("orders-of-over-penalty", make(), c, strings, &OVER_PENALTY, sink)
            });
        }
    }
    let coarse: &[usize] = plan.pick(&[8, 16, 32], &[16, 32, 64]);
    for scheme in ["sipg", "nipg"] {
        plan.add("orders", Choice::default(scheme), "sines-2d", move |c, sink| {
            interior_penalty(c, coarse, sink)
        });
    }
    let norms: &[Norm] = &[("H1", Some(0.9), |r| r.error.h1), ("L2", None, |r| r.error.l2)];
    for choice in plan.compared() {
        plan.add("orders", choice, "icelike-1d", move |c, sink| {
            let levels = [8, 16, 32, 64, 128, 256];
            fit("strings", scenes::icelike_1d(), c, &levels, norms, sink)
        });
    }
    let boxes: &[usize] = plan.pick_of(&[2], &[4], &[4, 8, 12]);
    for choice in [Choice::new("wopsip", Penalty::Eta(1.0)), Choice::default("wopsip")] {
        plan.add("orders", choice, "radial-3d", move |c, sink| in_space(c, boxes, sink));
    }
}

fn fit<const D: usize>(
    criterion: &'static str,
    scene: Scene<D>,
    choice: &Choice,
    levels: &[usize],
    norms: &[Norm],
    sink: Sink<'_>,
) -> Result<(), Error> {
    let name = scene.name.clone();
    let rows = rows::<D>(scene, choice, levels)?;
    for (norm, least, error) in norms {
        let errors: Vec<(usize, f64)> =
            rows.iter().filter_map(|r| Some((r.level, of(r, error)?))).collect();
        let order = (errors.len() == levels.len()).then(|| fitted_order(&errors)).flatten();
        let claim = RowBuilder::new(criterion, choice)
            .on(&name)
            .quantity(&format!("order in {norm}, fitted"))
            .detail(format!("error {}", listed(&errors)));
        let claim = least.map_or(claim.clone(), |least| claim.at_least(least));
        sink(claim.measured(order));
    }
    Ok(())
}

/// Jumps in L2 over facets: the penalty's part of the norm weighs them with `1/h`.
fn interior_penalty(choice: &Choice, levels: &[usize], sink: Sink<'_>) -> Result<(), Error> {
    let jumps: [Norm; 1] = [("jumps", Some(1.4), |r| jump(r).map(|j| j / (r.level as f64).sqrt()))];
    fit("jumps-of-interior-penalty", sines::<2>(), choice, levels, &jumps, sink)?;
    if choice.scheme == "nipg" {
        let l2: [Norm; 1] = [("L2", None, |r| r.error.l2)];
        fit("duality-of-nipg", sines::<2>(), choice, levels, &l2, sink)?;
    }
    Ok(())
}

fn in_space(choice: &Choice, levels: &[usize], sink: Sink<'_>) -> Result<(), Error> {
    for &level in levels {
        let ours = row::<3>(scenes::radial::<3>(1.0), choice, level)?;
        let p1 = row::<3>(scenes::radial::<3>(1.0), &Choice::default("p1"), level)?;
        sink(
            RowBuilder::new("boxes-in-space", choice)
                .on(&ours.scene)
                .level(level)
                .quantity("L2 error over that of p1")
                .detail(figures(&ours))
                .measured(quotient(of(&ours, |r| r.error.l2), of(&p1, |r| r.error.l2))),
        );
    }
    Ok(())
}
