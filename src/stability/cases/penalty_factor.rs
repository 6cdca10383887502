//! The over-penalty factor over fourteen powers of ten, and contact forces over larger ones.

use std::sync::Arc;

use super::condition_numbers;
use crate::error::Error;
use crate::inequality::{InequalitySolver, in_precision};
use crate::nested::Hierarchy;
use crate::real::Precision;
use crate::scenes;
use crate::scenes::Scene;
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, figures, jumps, of, quotient};
use crate::stability::runs::{definite, imbalance, over, row, row_in, solved_by, solver};
use crate::study::Row;

pub(crate) const DEFINITE: Criterion = Criterion::new(
    "definite-for-every-factor",
    &[ExpectedRange::at_least(1.0)],
    "The over-penalised matrix has a Cholesky factor for every eta > 0, from 1e-4 to 1e10: {} if it has.",
);
pub(crate) const ERROR: Criterion = Criterion::new(
    "error-of-large-factors",
    &[ExpectedRange::at_most(1.05)],
    "The broken H1 error is at most {} times that of Crouzeix-Raviart elements for eta from 1 to 1e10. Factors below one penalise too little and are known to fail.",
);
const JUMPS: Criterion = Criterion::new(
    "jumps-of-large-factors",
    &[ExpectedRange::within(1.5)],
    "From eta = 1 on the error in the jump seminorm falls like eta^(-1/2): times eta^(1/2) it stays within a factor of {} of its value at eta = 100. Below one jumps are too large to fall like that.",
);
pub(crate) const MULTIPLIER: Criterion = Criterion::new(
    "multiplier-of-large-factors",
    &[ExpectedRange::at_most(1.5)],
    "The L1 error of the multiplier is at most {} times that of Crouzeix-Raviart elements for eta from 10 to 1e14, in f32 to 1e11: contact forces keep their digits where the weight leaves none in differences of values. With one jumps still count, and in f32 matrices may be singular from 1e12 on: both are known to fail.",
);
pub(crate) const EQUILIBRIUM: Criterion = Criterion::new(
    "equilibrium",
    &[ExpectedRange::at_most(1e-6), ExpectedRange::at_most(1e-3)],
    "Contact forces and the fluxes through facets with Dirichlet data balance the load, less the reaction: what is left is at most {} of the integral of the absolute load in f64, and {} in f32, where matrices are known to fail from 1e12 on.",
);
pub(crate) const CASE: Case = Case {
    name: "penalty-factor",
    criteria: &[
        DEFINITE,
        ERROR,
        JUMPS,
        MULTIPLIER,
        EQUILIBRIUM,
        condition_numbers::OVER_FACTORS,
        condition_numbers::OVER_MESHES,
    ],
    plan,
};

fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick_of(8, 32, 32);
    let all: Vec<i32> = (-4..=10).collect();
    let exponents: Vec<i32> = plan.pick_of(vec![-4, 2], vec![-4, 0, 2, 6, 10], all);
    let large: Vec<i32> = plan.pick_of(vec![2], vec![2, 8, 14], (0..=14).collect());
    let problems: [fn() -> Scene<2>; 2] = [scenes::polynomial::<2>, scenes::signorini_2d];
    for scheme in ["wopsip", "wopsip:facet-means"] {
        for make in problems {
            for &exponent in &exponents {
                let choice = Choice::with_eta(scheme, exponent);
                plan.add(choice, &make().name, move |c, sink| {
                    let at_100 = Choice::with_eta(scheme, 2);
                    factor(&make(), (c, exponent), &at_100, level, sink)
                });
            }
            for &exponent in &large {
                let choice = Choice::with_eta(scheme, exponent);
                plan.add(choice, &make().name, move |c, sink| {
                    forces(Precision::Double, &make(), (c, exponent), sink)?;
                    forces(Precision::Single, &make(), (c, exponent), sink)
                });
            }
        }
    }
    condition_numbers::plan(plan);
}

fn factor(
    scene: &Scene<2>,
    (choice, exponent): (&Choice, i32),
    at_100: &Choice,
    level: usize,
    sink: Sink<'_>,
) -> Result<(), Error> {
    let eta = 10.0_f64.powi(exponent);
    let claim =
        |criterion| RowBuilder::new(criterion, choice).on(&scene.name).level(level).at("eta", eta);
    sink(claim(&DEFINITE).quantity("has a Cholesky factor").measured(definite(
        scene,
        &scene.domain.mesh(level)?,
        choice,
    )?));
    let ours = row(scene, choice, level)?;
    sink(
        claim(&ERROR)
            .known_to_fail(exponent < 0)
            .quantity("H1 error over that of cr")
            .underlying("broken H1 error", of(&ours, |r| r.error.h1))
            .detail(figures(&ours))
            .measured(over("cr", scene, &ours, |r| r.error.h1)?),
    );
    let (here, there) = (of(&ours, jumps), of(&row(scene, at_100, level)?, jumps));
    sink(
        claim(&JUMPS)
            .known_to_fail(exponent < 0)
            .quantity("jump seminorm times eta^(1/2), over the same at 100")
            .underlying("error in the jump seminorm", here)
            .detail(here.map_or_else(|| figures(&ours), |j| format!("jump seminorm {j:.2e}")))
            .measured(quotient(here, there).map(|r| r * (eta / 100.0).sqrt())),
    );
    Ok(())
}

/// The level of forces: on coarser meshes the contact sets of vertices and of facet means differ by more than by
/// rounding.
const LEVEL_OF_FORCES: usize = 32;

/// The power of ten from which on factors in single precision may be singular.
const SINGULAR_IN_SINGLE: i32 = 12;

fn forces(
    precision: Precision,
    scene: &Scene<2>,
    (choice, exponent): (&Choice, i32),
    sink: Sink<'_>,
) -> Result<(), Error> {
    let (eta, level) = (10.0_f64.powi(exponent), LEVEL_OF_FORCES);
    let is_single = precision == Precision::Single;
    let claim = |criterion, limit| {
        let of = RowBuilder::new(criterion, choice).limit(limit).on(&scene.name);
        of.precision(precision.name()).level(level).at("eta", eta)
    };
    // the factors of the active set have no quarter of the digits of single precision
    let is_singular = is_single && exponent >= SINGULAR_IN_SINGLE;
    let ours = row_in(precision, scene, choice, level)?;
    let l1 = |row: &Row| row.contact.multiplier_l1;
    sink(
        claim(&MULTIPLIER, 0)
            .known_to_fail(exponent < 1 || is_singular)
            .quantity("L1 error of the multiplier over that of cr")
            .underlying("L1 error of the multiplier", of(&ours, l1))
            .detail(figures(&ours))
            .measured(over("cr", scene, &ours, l1)?),
    );
    let solver: Arc<dyn InequalitySolver<f64>> = in_precision(precision, solver()).into();
    let problem = choice.problem(scene);
    let meshes = Hierarchy::<2>::of_domain(&scene.domain, level)?;
    sink(
        claim(&EQUILIBRIUM, usize::from(is_single))
            .known_to_fail(is_singular)
            .quantity("load less reaction, forces and fluxes, over the absolute load")
            .measured(imbalance(&solved_by(solver, &problem, &meshes, choice, false)?)),
    );
    Ok(())
}
