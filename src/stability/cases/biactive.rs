//! No strict complementarity: gap and multiplier vanish together.

use crate::stability::table::*;

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

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let levels = study.effort.pick(&[8, 16, 32][..], &[8, 16, 32, 64]);
    let n_scenes = study.effort.pick(1, 4);
    let strings = study.effort.pick(&[64, 128, 256][..], &[64, 128, 256, 512]);
    let mut sweeps = Vec::new();
    for scene in
        &["biactive-half-2d", "biactive-ring-2d", "degenerate4-2d", "lshape-2d"][..n_scenes]
    {
        sweeps.extend([orders(scene, levels), steps(scene, levels)]);
    }
    sweeps.extend([orders("oscillating-1d", strings), steps("oscillating-1d", &strings[..1])]);
    let finest = study.effort.pick(16, 32);
    sweeps.push(Sweep {
        compares: true,
        parameter: "h",
        places: Place::levels("polynomial-2d", &[finest]).into_iter().map(Place::at_size).collect(),
        columns: vec![Column::new(&FREE_BOUNDARY, "distance over h", |at| {
            Some(at.of(|row| row.contact.free_boundary_distance)? / at.value()?)
        })],
        ..Sweep::default()
    });
    Ok(sweeps)
}

fn orders(scene: &str, levels: &[usize]) -> Sweep {
    let mut columns = Column::all_fitted(&ORDERS, &[L2, H1]);
    // a re-entrant corner limits the orders whatever the contact
    if scene == "lshape-2d" {
        columns = columns.into_iter().map(|column| column.asked(|_| Asked::Report)).collect();
    }
    Sweep { compares: true, places: Place::levels(scene, levels), columns, ..Sweep::default() }
}

/// Linear systems of the library's own solver and of the interior point method from a cold start.
fn steps(scene: &str, levels: &[usize]) -> Sweep {
    let quantity = "linear systems, cold";
    let places = Place::levels(scene, levels).into_iter();
    Sweep {
        compares: true,
        places: places.map(|place| place.with_interior_point(true)).collect(),
        columns: vec![
            Column::new(&ACTIVE_SETS, quantity, |at| at.outer(0)),
            Column::new(&INTERIOR_POINT, quantity, |at| at.outer(1)),
        ],
        ..Sweep::default()
    }
}
