//! No strict complementarity: gap and multiplier vanish together.

use super::table::*;
use crate::scenes::AnyScene;

const ORDERS: Criterion = Criterion::new(
    "orders-on-biactive-sets",
    &[ExpectedRange::at_least(1.8), ExpectedRange::at_least(0.9)],
    "Gap and multiplier that vanish together do not change orders: fitted over all levels, L2 at least 1.8 and H1 at least 0.9 where the solution is smooth enough.",
);
const ACTIVE_SETS: Criterion = Criterion::new(
    "active-sets-tried",
    &[ExpectedRange::at_most(40.0)],
    "From a cold start the active set method and what follows where it stagnates solve at most 40 linear systems.",
);
const INTERIOR_POINT: Criterion = Criterion::new(
    "interior-point-steps",
    &[ExpectedRange::at_most(40.0)],
    "The interior point method solves at most 40 linear systems.",
);
const FREE_BOUNDARY: Criterion = Criterion::new(
    "free-boundary",
    &[ExpectedRange::at_most(2.0)],
    "Where gap and multiplier vanish together the contact set is no datum of the problem; its distance from the exact one is meaningful for the strictly complementary part only, and is then at most 2h.",
);
pub(crate) const CASE: Case = Case {
    name: "biactive",
    criteria: &[ORDERS, ACTIVE_SETS, INTERIOR_POINT, FREE_BOUNDARY],
    sweeps,
};

fn sweeps(study: &Stability<'_>) -> Result<Vec<Sweep>, Error> {
    let levels = study.effort.pick([&[4, 8][..], &[8, 16, 32], &[8, 16, 32, 64]]);
    let n_scenes = study.effort.pick([1, 1, 4]);
    let strings = study.effort.pick([&[64, 128, 256][..], &[64, 128, 256], &[64, 128, 256, 512]]);
    let plane: [fn() -> AnyScene; 4] = [
        || scenes::biactive_half_2d().into(),
        || scenes::biactive_ring_2d().into(),
        || scenes::degenerate(4).into(),
        || scenes::lshape_2d().into(),
    ];
    let mut sweeps = Vec::new();
    for (number, scene) in plane.into_iter().take(n_scenes).enumerate() {
        // a re-entrant corner limits the orders whatever the contact
        sweeps.extend([orders(scene, levels, number < 3), steps(scene, levels)]);
    }
    let oscillating: fn() -> AnyScene = || scenes::oscillating_1d().into();
    sweeps.extend([orders(oscillating, strings, true), steps(oscillating, &strings[..1])]);
    let finest = study.effort.pick([8, 16, 32]);
    let scene = scenes::polynomial::<2>();
    let size = scene.domain.length() / finest as f64;
    sweeps.push(Sweep {
        compares: true,
        places: vec![Place::new(scene, finest)],
        columns: vec![Column::new(&FREE_BOUNDARY, "distance over h", move |at| {
            at.of(|row| row.contact.free_boundary_distance.map(|distance| distance / size))
        })],
        ..Sweep::default()
    });
    Ok(sweeps)
}

fn orders(scene: fn() -> AnyScene, levels: &[usize], is_judged: bool) -> Sweep {
    let mut columns = Column::all_fitted(&ORDERS, &[L2, H1]);
    if !is_judged {
        columns = columns.into_iter().map(|column| column.asked(|_| Asked::Report)).collect();
    }
    let places = levels.iter().map(|&level| Place::new(scene(), level)).collect();
    Sweep { compares: true, places, columns, ..Sweep::default() }
}

/// Linear systems of the library's own solver and of the interior point method from a cold start.
fn steps(scene: fn() -> AnyScene, levels: &[usize]) -> Sweep {
    let quantity = "linear systems, cold";
    Sweep {
        compares: true,
        places: levels.iter().map(|&level| Place::new(scene(), level)).collect(),
        is_cold: true,
        has_interior_point: true,
        columns: vec![
            Column::new(&ACTIVE_SETS, quantity, |at| at.outer(0)),
            Column::new(&INTERIOR_POINT, quantity, |at| at.outer(1)),
        ],
        ..Sweep::default()
    }
}
