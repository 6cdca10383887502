//! Interior penalty across its threshold of coercivity, by inertia.

use crate::error::Error;
use crate::inequality::Outcome;
use crate::kit::spectrum::{negative_eigenvalues, smallest_eigenvalue};
use crate::scenes;
use crate::scenes::sines;
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::{ExpectedRange, StabilityRow};
use crate::stability::row_builder::{RowBuilder, figures, of};
use crate::stability::runs::{free_matrix, over, row};

pub(crate) const INERTIA: Criterion = Criterion::new(
    "inertia",
    &[ExpectedRange::at_most(0.0)],
    "Interior penalty sigma/h_F on the unit square, threshold sigma = 3: the number of negative eigenvalues, counted by the pivots of a factorisation, is at most {}. Below the threshold there are some, whatever the size of the error.",
);
const REFUSED: Criterion = Criterion::new(
    "refused-or-warned",
    &[ExpectedRange::at_least(1.0), ExpectedRange::at_most(0.0)],
    "A penalty below its proven bound is not accepted silently. The figure is one if the library refuses to solve or warns: at least {} below the bound, at most {} from the bound on.",
);
pub(crate) const ERROR: Criterion = Criterion::new(
    "error-of-interior-penalty",
    &[ExpectedRange::at_most(1.25)],
    "With interior penalty sigma/h_F from the proven bound on, the broken H1 error is at most {} times that of Crouzeix-Raviart elements. Between the threshold and the bound the matrix is definite by little, and the error is known to be larger.",
);
pub(crate) const CASE: Case =
    Case { name: "coercivity", criteria: &[INERTIA, REFUSED, ERROR], plan };

/// The factor below which `sigma/h_F` is indefinite on right isosceles triangles.
const THRESHOLD: f64 = 3.0;

fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick(8, 16);
    for sigma in [0.5, 1.0, 2.0, 2.9, 3.1, 4.0, 10.0, 1000.0] {
        let choice = Choice::of(&format!("sipg@sigma={sigma}"));
        plan.add(choice, "", move |c, sink| factor(c, sigma, level, sink));
    }
    for choice in plan.compared() {
        plan.add(choice, "", move |c, sink| {
            sink(inertia(c, level)?);
            Ok(())
        });
    }
}

fn inertia(choice: &Choice, level: usize) -> Result<StabilityRow, Error> {
    let scene = sines::<2>();
    let matrix = free_matrix(&scene, &scene.domain.mesh(level)?, choice)?;
    let sigma = choice.options().sigma;
    let claim = RowBuilder::new(&INERTIA, choice).on(&scene.name).level(level);
    let claim = sigma.map_or(claim.clone(), |sigma| claim.at("sigma", sigma));
    let least = smallest_eigenvalue(&matrix);
    let least = match least {
        Ok(least) => format!("smallest eigenvalue {least:.3e} of {}", matrix.size()),
        Err(error) => error.to_string(),
    };
    Ok(claim
        .known_to_fail(sigma.is_some_and(|sigma| sigma < THRESHOLD))
        .quantity("negative eigenvalues")
        .detail(least)
        .measured(negative_eigenvalues(&matrix).map(|n| n as f64)))
}

fn factor(choice: &Choice, sigma: f64, level: usize, sink: Sink<'_>) -> Result<(), Error> {
    sink(inertia(choice, level)?);
    let scene = scenes::radial::<2>(1.0);
    let found = row(&scene, choice, 2 * level)?;
    // on Dirichlet facets |dK|/|K| with |dK| = (2 + root 2) h and |K| = h^2 / 2
    let proven = 2.0 * (2.0 + 2.0_f64.sqrt());
    let claim = |criterion| {
        RowBuilder::new(criterion, choice).on(&scene.name).level(2 * level).at("sigma", sigma)
    };
    sink(
        claim(&ERROR)
            .known_to_fail(sigma < proven)
            .quantity("H1 error over that of cr")
            .detail(figures(&found))
            .measured(over("cr", &scene, &found, |r| r.error.h1)?),
    );
    let is_warned = of(&found, |r| r.error.h1).is_some() && !found.warnings.is_empty();
    sink(
        claim(&REFUSED)
            .limit(usize::from(sigma >= proven))
            .quantity("refused to solve, or warned")
            .detail(format!("{}{}", if is_warned { "warned, " } else { "" }, figures(&found)))
            .answered(found.status == Outcome::NotCoercive || !found.warnings.is_empty()),
    );
    Ok(())
}
