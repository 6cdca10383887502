//! Coefficients that jump.

use crate::scheme::ConformingP1;
use crate::stability::table::*;
use crate::study::Study;

const ERROR: Criterion = Criterion::new(
    "error-over-contrast",
    &[ExpectedRange::at_most(1.5)],
    "Coefficients 1e-8 to 1e8, aligned with the mesh: the relative energy error is at most 1.5 times that at contrast one.",
);
const ITERATIONS: Criterion = Criterion::new(
    "iterations-over-contrast",
    &[ExpectedRange::at_most(25.0)],
    "The number of active sets tried is bounded over the same contrasts: at most 25.",
);
const ACROSS_FLUX: Criterion = Criterion::new(
    "interface-across-flux",
    &[ExpectedRange::at_most(1.15)],
    "An obstacle problem with flux across an aligned interface only: the energy error without penalties (broken H1) is at most 1.15 times that of conforming P1.",
);
const INSIDE_CELLS: Criterion = Criterion::new(
    "interface-inside-cells",
    &[],
    "An interface that no mesh resolves: the error is that of resolving data, about order one half in H1, and no scheme is judged by it.",
);
pub(crate) const CASE: Case =
    Case { name: "contrast", criteria: &[ERROR, ITERATIONS, ACROSS_FLUX, INSIDE_CELLS], sweeps };

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let [level, middle] = study.effort.pick([16, 32], [32, 32]);
    let exponents = study.effort.pick(&[-8, -4, 4, 8][..], &[-8, -6, -4, -2, 2, 4, 6, 8]);
    let levels = study.effort.pick(&[8, 16, 32][..], &[8, 16, 32, 64]);
    let sweep = |places, columns| Sweep {
        compares: true,
        parameter: "contrast",
        places,
        columns,
        ..Sweep::default()
    };
    let layers =
        |contrast: f64| Place::new(scenes::signorini_layers_2d(contrast), level).at(contrast);
    let aligned = [1.0].into_iter().chain(exponents.iter().map(|&k| 10.0_f64.powi(k)));
    let across = |contrast: f64| Place::new(scenes::contrast::<2>(contrast), middle).at(contrast);
    // the contrast one is that with which the others are compared
    let asked = |at: &At<'_>| if at.place == 0 { Asked::NoRow } else { Asked::Limit(0) };
    Ok(vec![
        Sweep {
            schemes: schemes("sipg@sigma=10"),
            ..sweep(
                aligned.map(layers).collect(),
                vec![
                    Column::new(&ERROR, "relative energy error over that at contrast 1", |at| {
                        Some(relative(*at)? / relative(at.first())?)
                    })
                    .asked(asked),
                    Column::new(&ITERATIONS, "active sets tried", |at| at.outer(0)).asked(asked),
                ],
            )
        },
        Sweep {
            beside: schemes("p1"),
            ..sweep(
                [1e-6, 1e6].map(across).into(),
                vec![Column::new(&ACROSS_FLUX, "H1 error over that of p1", |at| at.over("p1", H1))],
            )
        },
        sweep(
            Place::levels("contrast-disc-2d", levels)
                .into_iter()
                .map(|place| place.at(1e6))
                .collect(),
            Column::all_fitted(&INSIDE_CELLS, &[H1]),
        ),
    ])
}

/// The energy error over the energy norm of the exact solution, which is the error of conforming elements that vanish.
fn relative(at: At<'_>) -> Option<f64> {
    let study = Study::<2>::new(at.scene()?.clone()).scheme(ConformingP1);
    let zeros = vec![0.0; at.mesh()?.vertices().len()];
    let of_zeros = study.levels([at.place().level]).judge(&zeros, None).ok()?;
    Some(at.of(ENERGY.1)? / of_zeros.error.energy?)
}
