//! Orders that experience expects.

use crate::stability::table::*;

const OVER_PENALTY: Criterion = Criterion::new(
    "orders-of-over-penalty",
    &[ExpectedRange::at_least(1.9), ExpectedRange::at_least(0.97), ExpectedRange::at_least(0.9)],
    "WOPSIP on nine problems: order at least 1.9 in L2, 0.97 in H1 and 0.9 in jumps, fitted over the levels given.",
);
const INTERIOR_PENALTY: Criterion = Criterion::new(
    "jumps-of-interior-penalty",
    &[ExpectedRange::at_least(1.4)],
    "Jumps of interior penalty schemes fall with order 1.5 (at least 1.4).",
);
const DUALITY: Criterion = Criterion::new(
    "duality-of-nipg",
    &[],
    "NIPG is not consistent with the dual problem: its L2 order is reported, not judged.",
);
const STRINGS: Criterion = Criterion::new(
    "strings",
    &[ExpectedRange::at_least(0.9)],
    "Free boundaries of strings fall between vertices, so that errors oscillate with h: the order fitted over six levels is at least 0.9 in H1.",
);
const BOXES: Criterion = Criterion::new(
    "boxes-in-space",
    &[],
    "In space with eta = 1 the over-penalty is pre-asymptotic until h is about a quarter of the root of eta; with eta times the squared diameter it is not: the error over that of conforming elements is reported.",
);
pub(crate) const CASE: Case = Case {
    name: "orders",
    criteria: &[OVER_PENALTY, INTERIOR_PENALTY, DUALITY, STRINGS, BOXES],
    sweeps,
};

/// Problems in the plane on which the over-penalty is to show its orders.
const PLANE: [&str; 8] = [
    "radial-2d",
    "polynomial-2d",
    "signorini-harmonic-2d",
    "signorini-2d",
    "signorini-smooth3-2d",
    "signorini-biactive-2d",
    "signorini-two-2d",
    "signorini-layers-2d",
];

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let levels = study.effort.pick(&[16, 32, 64][..], &[32, 64, 128]);
    let n_scenes = study.effort.pick(1, PLANE.len());
    let strings = [32, 64, 128, 256];
    let norms = [L2, H1, JUMPS];
    let both = "wopsip wopsip:facet-means";
    let mut sweeps = Vec::new();
    for scene in &PLANE[..n_scenes] {
        sweeps.push(fits(both, scene, levels, &OVER_PENALTY, &norms));
    }
    for scene in ["parabola-1d", "signorini-reaction-1d"] {
        sweeps.push(fits(both, scene, &strings, &OVER_PENALTY, &norms));
    }
    let coarse = study.effort.pick([8, 16, 32], [16, 32, 64]);
    // jumps in L2 over facets: the penalty's part of the norm weighs them with `1/h`
    let in_l2: Norm = ("jumps", |row| JUMPS.1(row).map(|j| j / (row.level as f64).sqrt()));
    sweeps.push(fits("sipg nipg", "sines-2d", &coarse, &INTERIOR_PENALTY, &[in_l2]));
    sweeps.push(fits("nipg", "sines-2d", &coarse, &DUALITY, &[L2]));
    let levels = [8, 16, 32, 64, 128, 256];
    let strings = fits("", "icelike-1d", &levels, &STRINGS, &[H1, L2]);
    sweeps.push(Sweep { compares: true, ..strings });
    let boxes = study.effort.pick(&[4][..], &[4, 8, 12]);
    sweeps.push(Sweep {
        schemes: schemes("wopsip@eta=1 wopsip"),
        beside: schemes("p1"),
        places: Place::levels("radial-3d", boxes),
        columns: vec![Column::new(&BOXES, "L2 error over that of p1", |at| at.over("p1", L2))],
        ..Sweep::default()
    });
    Ok(sweeps)
}

/// Orders of schemes on a scene, fitted over levels.
fn fits(
    names: &str,
    scene: &str,
    levels: &[usize],
    criterion: &'static Criterion,
    norms: &[Norm],
) -> Sweep {
    Sweep {
        schemes: schemes(names),
        places: Place::levels(scene, levels),
        columns: Column::all_fitted(criterion, norms),
        ..Sweep::default()
    }
}
