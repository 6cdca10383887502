//! The over-penalty factor over fourteen powers of ten, and contact forces over larger ones.

use crate::error::Error;
use crate::inequality::in_precision;
use crate::nested::{Hierarchy, NestedIteration};
use crate::real::Precision;
use crate::scenes;
use crate::scenes::Scene;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{RowBuilder, figures, jump, of, quotient};
use crate::stability::runs::{definite, imbalance, row, rows_in, solver};
use crate::study::Row;

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick_of(8, 32, 32);
    let all: Vec<i32> = (-4..=10).collect();
    let exponents: Vec<i32> = plan.pick_of(vec![-4, 2], vec![-4, 0, 2, 6, 10], all);
    let large: Vec<i32> = plan.pick_of(vec![2], vec![2, 8, 14], (0..=14).collect());
    let problems: [fn() -> Scene<2>; 2] = [scenes::polynomial::<2>, scenes::signorini_2d];
    for scheme in ["wopsip", "wopsip:facet-means"] {
        for make in problems {
            for &exponent in &exponents {
                let choice = Choice::new(scheme, Penalty::Eta(10.0_f64.powi(exponent)));
                plan.add("penalty-factor", choice, &make().name, move |c, sink| {
                    factor(make, c, exponent, level, sink)
                });
            }
            for &exponent in &large {
                let choice = Choice::new(scheme, Penalty::Eta(10.0_f64.powi(exponent)));
                plan.add("penalty-factor", choice, &make().name, move |c, sink| {
                    forces(Precision::Double, make, (c, exponent), sink)?;
                    forces(Precision::Single, make, (c, exponent), sink)
                });
            }
        }
    }
}

fn factor(
    make: fn() -> Scene<2>,
    choice: &Choice,
    exponent: i32,
    level: usize,
    sink: Sink<'_>,
) -> Result<(), Error> {
    let eta = 10.0_f64.powi(exponent);
    let scene = make();
    let claim = |name| RowBuilder::new(name, choice).on(&scene.name).level(level).at("eta", eta);
    let mesh = scene.domain.mesh(level)?;
    sink(
        claim("definite-for-every-factor")
            .quantity("has a Cholesky factor")
            .at_least(1.0)
            .measured(definite(&scene.problem, &mesh, choice)?),
    );
    let ours = row::<2>(make(), choice, level)?;
    let means = row::<2>(make(), &Choice::default("cr"), level)?;
    let error = claim("error-of-large-factors")
        .quantity("H1 error over that of cr")
        .at_most(1.05)
        .known_to_fail(exponent < 0)
        .underlying("broken H1 error", of(&ours, |r| r.error.h1))
        .detail(figures(&ours));
    sink(error.measured(quotient(of(&ours, |r| r.error.h1), of(&means, |r| r.error.h1))));
    let middle = Choice::new(choice.scheme, Penalty::Eta(100.0));
    let middle = row::<2>(make(), &middle, level)?;
    let scaled = quotient(of(&ours, jump), of(&middle, jump)).map(|r| r * (eta / 100.0).sqrt());
    let jumps = claim("jumps-of-large-factors")
        .quantity("jump part times eta^(1/2), over the same at 100")
        .at_least(1.0 / 1.5)
        .at_most(1.5)
        .known_to_fail(exponent < 0)
        .underlying("jump part of the error", of(&ours, jump))
        .detail(of(&ours, jump).map_or_else(|| figures(&ours), |j| format!("jump part {j:.2e}")));
    sink(jumps.measured(scaled));
    Ok(())
}

/// The largest imbalance of forces.
fn largest_imbalance(precision: Precision) -> f64 {
    match precision {
        Precision::Double => 1e-6,
        Precision::Single => 1e-3,
    }
}

/// The level of forces: on coarser meshes the contact sets of vertices and of facet means differ by more than by
/// rounding.
const LEVEL_OF_FORCES: usize = 32;

/// The power of ten from which on factors in single precision may be singular.
const SINGULAR_IN_SINGLE: i32 = 12;

fn forces(
    precision: Precision,
    make: fn() -> Scene<2>,
    (choice, exponent): (&Choice, i32),
    sink: Sink<'_>,
) -> Result<(), Error> {
    let (eta, level) = (10.0_f64.powi(exponent), LEVEL_OF_FORCES);
    let scene = make();
    let claim = |name| {
        let of = RowBuilder::new(name, choice).on(&scene.name).precision(precision.name());
        of.level(level).at("eta", eta)
    };
    // the factors of the active set have no quarter of the digits of single precision
    let is_singular = precision == Precision::Single && exponent >= SINGULAR_IN_SINGLE;
    let ours = rows_in::<2>(precision, make(), choice, &[level])?.swap_remove(0);
    let means = row::<2>(make(), &Choice::default("cr"), level)?;
    let l1 = |row: &Row| row.contact.multiplier_l1;
    let error = claim("multiplier-of-large-factors")
        .quantity("L1 error of the multiplier over that of cr")
        .at_most(1.5)
        .known_to_fail(exponent < 1 || is_singular)
        .underlying("L1 error of the multiplier", of(&ours, l1))
        .detail(figures(&ours));
    sink(error.measured(quotient(of(&ours, l1), of(&means, l1))));
    let problem = choice.constrain(scene.problem.clone());
    let meshes = Hierarchy::<2>::of_domain(&scene.domain, level)?;
    let mut nested = NestedIteration::new(&problem, &meshes)
        .shared_solver(in_precision(precision, solver()).into());
    let left = imbalance(&nested.solve(&*choice.make())?);
    let equilibrium = claim("equilibrium")
        .quantity("load less reaction, forces and fluxes, over the absolute load")
        .at_most(largest_imbalance(precision))
        .known_to_fail(is_singular);
    sink(equilibrium.measured(left));
    Ok(())
}
