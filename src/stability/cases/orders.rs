//! Orders that experience expects.

use crate::error::Error;
use crate::scenes;
use crate::scenes::{Scene, sines};
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, figures, jumps};
use crate::stability::runs::{H1, L2, Norm, fit, over, row};

const OVER_PENALTY: Criterion = Criterion::new(
    "orders-of-over-penalty",
    &[ExpectedRange::at_least(1.9), ExpectedRange::at_least(0.97), ExpectedRange::at_least(0.9)],
    "WOPSIP on nine problems: order at least {} in L2, {} in H1 and {} in jumps, fitted over the levels given.",
);
const JUMPS: Criterion = Criterion::new(
    "jumps-of-interior-penalty",
    &[ExpectedRange::at_least(1.4)],
    "Jumps of interior penalty schemes fall with order 1.5 (at least {}).",
);
const DUALITY: Criterion = Criterion::new(
    "duality-of-nipg",
    &[],
    "NIPG is not consistent with the dual problem: its L2 order is reported, not judged.",
);
const STRINGS: Criterion = Criterion::new(
    "strings",
    &[ExpectedRange::at_least(0.9)],
    "Free boundaries of strings fall between vertices, so that errors oscillate with h: the order fitted over six levels is at least {} in H1.",
);
const BOXES: Criterion = Criterion::new(
    "boxes-in-space",
    &[],
    "In space with eta = 1 the over-penalty is pre-asymptotic until h is about a quarter of the root of eta; with eta times the squared diameter it is not: the error over that of conforming elements is reported.",
);
pub(crate) const CASE: Case =
    Case { name: "orders", criteria: &[OVER_PENALTY, JUMPS, DUALITY, STRINGS, BOXES], plan };

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

fn plan(plan: &mut Plan<'_>) {
    let levels: &[usize] = plan.pick_of(&[8, 16], &[16, 32, 64], &[32, 64, 128]);
    let plane = plan.pick(&PLANE[..1], &PLANE[..]);
    let strings: &[usize] = &[32, 64, 128, 256];
    let norms = &[L2, H1, ("jumps", jumps)];
    for scheme in ["wopsip", "wopsip:facet-means"] {
        let choice = Choice::of(scheme);
        for make in plane {
            plan.add(choice, &make().name, move |c, sink| {
                fit(&OVER_PENALTY, &make(), c, levels, norms, sink)
            });
        }
        for make in [scenes::parabola_1d as fn() -> Scene<1>, scenes::signorini_reaction_1d] {
            plan.add(choice, &make().name, move |c, sink| {
                fit(&OVER_PENALTY, &make(), c, strings, norms, sink)
            });
        }
    }
    let coarse: &[usize] = plan.pick(&[8, 16, 32], &[16, 32, 64]);
    for scheme in ["sipg", "nipg"] {
        plan.add(Choice::of(scheme), "sines-2d", move |c, sink| {
            // jumps in L2 over facets: the penalty's part of the norm weighs them with `1/h`
            let jumps: Norm = ("jumps", |r| jumps(r).map(|j| j / (r.level as f64).sqrt()));
            fit(&JUMPS, &sines::<2>(), c, coarse, &[jumps], sink)?;
            match scheme {
                "nipg" => fit(&DUALITY, &sines::<2>(), c, coarse, &[L2], sink),
                _ => Ok(()),
            }
        });
    }
    for choice in plan.compared() {
        plan.add(choice, "icelike-1d", move |c, sink| {
            let levels = [8, 16, 32, 64, 128, 256];
            fit(&STRINGS, &scenes::icelike_1d(), c, &levels, &[H1, L2], sink)
        });
    }
    let boxes: &[usize] = plan.pick_of(&[2], &[4], &[4, 8, 12]);
    for scheme in ["wopsip@eta=1", "wopsip"] {
        plan.add(Choice::of(scheme), "radial-3d", move |c, sink| in_space(c, boxes, sink));
    }
}

fn in_space(choice: &Choice, levels: &[usize], sink: Sink<'_>) -> Result<(), Error> {
    let scene = scenes::radial::<3>(1.0);
    for &level in levels {
        let ours = row(&scene, choice, level)?;
        sink(
            RowBuilder::new(&BOXES, choice)
                .on(&scene.name)
                .level(level)
                .quantity("L2 error over that of p1")
                .detail(figures(&ours))
                .measured(over("p1", &scene, &ours, |r| r.error.l2)?),
        );
    }
    Ok(())
}
