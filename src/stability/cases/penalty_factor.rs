//! The over-penalty factor over fourteen powers of ten, and contact forces over larger ones.

use super::condition_numbers;
use crate::real::Precision;
use crate::scheme::NamedScheme;
use crate::stability::table::*;

const DEFINITE: Criterion = Criterion::new(
    "definite-for-every-factor",
    &[ExpectedRange::at_least(1.0)],
    "The over-penalised matrix has a Cholesky factor for every eta > 0, from 1e-4 to 1e10: 1 if it has.",
);
const ERROR: Criterion = Criterion::new(
    "error-of-large-factors",
    &[ExpectedRange::at_most(1.05)],
    "The broken H1 error is at most 1.05 times that of Crouzeix-Raviart elements for eta from 1 to 1e10. Factors below one penalise too little and are known to fail.",
);
const LARGE_JUMPS: Criterion = Criterion::new(
    "jumps-of-large-factors",
    &[ExpectedRange::within(1.5)],
    "From eta = 1 on the error in the jump seminorm falls like eta^(-1/2): times eta^(1/2) it stays within a factor of 1.5 of its value at eta = 100. Below one jumps are too large to fall like that.",
);
const MULTIPLIER: Criterion = Criterion::new(
    "multiplier-of-large-factors",
    &[ExpectedRange::at_most(1.5)],
    "The L1 error of the multiplier is at most 1.5 times that of Crouzeix-Raviart elements for eta from 10 to 1e14, in f32 to 1e11: contact forces keep their digits where the weight leaves none in differences of values. With one jumps still count, and in f32 matrices may be singular from 1e12 on: both are known to fail.",
);
const EQUILIBRIUM: Criterion = Criterion::new(
    "equilibrium",
    &[ExpectedRange::at_most(1e-6), ExpectedRange::at_most(1e-3)],
    "Contact forces and the fluxes through facets with Dirichlet data balance the load, less the reaction: what is left is at most 1e-6 of the integral of the absolute load in f64, and 1e-3 in f32, where matrices are known to fail from 1e12 on.",
);
pub(crate) const CASE: Case = Case {
    name: "penalty-factor",
    criteria: &[
        DEFINITE,
        ERROR,
        LARGE_JUMPS,
        MULTIPLIER,
        EQUILIBRIUM,
        condition_numbers::OVER_FACTORS,
        condition_numbers::OVER_MESHES,
    ],
    sweeps,
};

/// On coarser meshes the contact sets of vertices and of facet means differ by more than by rounding.
const LEVEL: usize = 32;

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let exponents = study.effort.pick(vec![-4, 0, 2, 6, 10], (-4..=10).collect());
    let large = study.effort.pick(vec![2, 8, 14], (0..=14).collect());
    let mut sweeps = Vec::new();
    for scheme in ["wopsip", "wopsip:facet-means"] {
        for scene in ["polynomial-2d", "signorini-2d"] {
            sweeps.push(factors(scheme, &exponents, Place::levels(scene, &[LEVEL])));
            sweeps.push(forces(with_eta(scheme, &large), scene));
        }
    }
    sweeps.extend(condition_numbers::sweeps(study.effort));
    Ok(sweeps)
}

fn factors(scheme: &str, exponents: &[i32], places: Vec<Place>) -> Sweep {
    let at_100 = format!("{scheme}@eta=100");
    let asked = |at: &At<'_>| Asked::limit_unless(at.value() < Some(1.0));
    Sweep {
        schemes: with_eta(scheme, exponents),
        beside: schemes(&format!("cr {at_100}")),
        parameter: "eta",
        places,
        columns: vec![
            Column::new(&DEFINITE, "has a Cholesky factor", |at| at.definite()),
            Column::new(&ERROR, "H1 error over that of cr", |at| at.over("cr", H1)).asked(asked),
            Column::new(
                &LARGE_JUMPS,
                "jump seminorm times eta^(1/2), over the same at 100",
                move |at| Some(at.over(&at_100, JUMPS)? * (at.value()? / 100.0).sqrt()),
            )
            .asked(asked),
        ],
        ..Sweep::default()
    }
}

fn forces(of: Vec<NamedScheme>, scene: &str) -> Sweep {
    let places = Place::levels(scene, &[LEVEL; 2]).into_iter();
    let precisions = [Precision::Double, Precision::Single];
    let is_single = |at: &At<'_>| at.place().precision == Precision::Single;
    // the factors of the active set have no quarter of the digits of single precision
    let is_singular = move |at: &At<'_>| is_single(at) && at.value() >= Some(1e12);
    let multiplier = |at: At<'_>| at.of(|row| row.contact.multiplier_l1);
    Sweep {
        schemes: of,
        beside: schemes("cr"),
        parameter: "eta",
        places: places.zip(precisions).map(|(place, of)| place.precision(of)).collect(),
        columns: vec![
            Column::new(&MULTIPLIER, "L1 error of the multiplier over that of cr", move |at| {
                // in double precision
                Some(multiplier(*at)? / multiplier(at.beside("cr").first())?)
            })
            .asked(move |at| Asked::limit_unless(at.value() < Some(10.0) || is_singular(at))),
            Column::new(
                &EQUILIBRIUM,
                "load less reaction, forces and fluxes, over the absolute load",
                |at| at.imbalance(),
            )
            .asked(move |at| match (is_single(at), is_singular(at)) {
                (_, true) => Asked::Failure(1),
                (is_single, _) => Asked::Limit(usize::from(is_single)),
            }),
        ],
        ..Sweep::default()
    }
}
