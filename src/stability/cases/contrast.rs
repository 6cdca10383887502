//! Coefficients that jump.

use crate::assemble::{DataQuadrature, Discretisation};
use crate::error::Error;
use crate::scenes;
use crate::scenes::Scene;
use crate::scheme::ConformingP1;
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, figures, of, quotient};
use crate::stability::runs::{over, row, rows};
use crate::study::Row;

const ERROR: Criterion = Criterion::new(
    "error-over-contrast",
    &[ExpectedRange::at_most(1.5)],
    "Coefficients 1e-8 to 1e8, aligned with the mesh: the relative energy error is at most {} times that at contrast one. A penalty that ignores the coefficient is known to fail.",
);
const ITERATIONS: Criterion = Criterion::new(
    "iterations-over-contrast",
    &[ExpectedRange::at_most(25.0)],
    "The number of active sets tried is bounded over the same contrasts: at most {}.",
);
const ACROSS_FLUX: Criterion = Criterion::new(
    "interface-across-flux",
    &[ExpectedRange::at_most(1.15)],
    "An obstacle problem with flux across an aligned interface only: the energy error without penalties (broken H1) is at most {} times that of conforming P1.",
);
const INSIDE_CELLS: Criterion = Criterion::new(
    "interface-inside-cells",
    &[],
    "An interface that no mesh resolves: the error is that of resolving data, about order one half in H1, and no scheme is judged by it.",
);
pub(crate) const CASE: Case =
    Case { name: "contrast", criteria: &[ERROR, ITERATIONS, ACROSS_FLUX, INSIDE_CELLS], plan };

fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick_of(8, 16, 32);
    let exponents: &[i32] = plan.pick(&[-8, -4, 4, 8], &[-8, -6, -4, -2, 2, 4, 6, 8]);
    let further = [
        Choice::without_coefficient("wopsip"),
        Choice::without_coefficient("wopsip:facet-means"),
        Choice::of("sipg@sigma=10"),
    ];
    for choice in plan.compared_and(&further) {
        plan.add(choice, "two layers", move |c, sink| aligned(c, level, exponents, sink));
    }
    let middle = plan.pick_of(8, 32, 32);
    let levels: &[usize] = plan.pick_of(&[4, 8], &[8, 16, 32], &[8, 16, 32, 64]);
    for choice in plan.compared() {
        plan.add(choice, "two materials", move |c, sink| across(c, middle, sink));
    }
    for choice in plan.compared() {
        plan.add(choice, "disc of another material", move |c, sink| inside_cells(c, levels, sink));
    }
}

/// The energy norm of the exact solution.
fn norm(scene: &Scene<2>, level: usize) -> Result<Option<f64>, Error> {
    let mesh = scene.domain.mesh(level)?;
    let quadrature = DataQuadrature::default();
    let space = Discretisation::new(&ConformingP1, &scene.problem, &mesh, quadrature)?;
    Ok(space.errors(&vec![0.0; space.unknowns()])?.energy)
}

fn aligned(choice: &Choice, level: usize, exponents: &[i32], sink: Sink<'_>) -> Result<(), Error> {
    let relative = |contrast: f64| -> Result<(Row, [Option<f64>; 2]), Error> {
        let scene = scenes::signorini_layers_2d(contrast);
        let norm = norm(&scene, level)?;
        let row = row(&scene, choice, level)?;
        let error = quotient(of(&row, |r| r.error.energy), norm);
        let broken = quotient(of(&row, |r| r.error.broken_energy), norm);
        Ok((row, [error, broken]))
    };
    let (_, [at_one, _]) = relative(1.0)?;
    for &exponent in exponents {
        let contrast = 10.0_f64.powi(exponent);
        let (row, [error, broken]) = relative(contrast)?;
        let relative = error.map_or(String::new(), |e| format!(", relative energy error {e:.2e}"));
        let claim = |criterion| {
            RowBuilder::new(criterion, choice)
                .on(&row.scene)
                .level(level)
                .at("contrast", contrast)
                .detail(format!("{}{relative}", figures(&row)))
        };
        sink(
            claim(&ERROR)
                // below one it is larger than it need be, which harms less
                .known_to_fail(choice.ignores_coefficient && contrast > 1.0)
                .quantity("relative energy error over that at contrast 1")
                .underlying("relative error in the broken energy norm", broken)
                .measured(quotient(error, at_one)),
        );
        let sets = of(&row, |r| r.iterations.outer.map(|n| n as f64));
        sink(claim(&ITERATIONS).quantity("active sets tried").measured(sets));
    }
    Ok(())
}

fn across(choice: &Choice, level: usize, sink: Sink<'_>) -> Result<(), Error> {
    for contrast in [1e-6, 1e6] {
        let scene = scenes::contrast::<2>(contrast);
        let ours = row(&scene, choice, level)?;
        sink(
            RowBuilder::new(&ACROSS_FLUX, choice)
                .on(&scene.name)
                .level(level)
                .at("contrast", contrast)
                .quantity("H1 error over that of p1")
                .detail(figures(&ours))
                .measured(over("p1", &scene, &ours, |r| r.error.h1)?),
        );
    }
    Ok(())
}

fn inside_cells(choice: &Choice, levels: &[usize], sink: Sink<'_>) -> Result<(), Error> {
    let contrast = 1e6;
    let scene = scenes::contrast_disc_2d(contrast);
    let claim = RowBuilder::new(&INSIDE_CELLS, choice).on(&scene.name).at("contrast", contrast);
    let claim = claim.quantity("order in H1, fitted");
    sink(claim.fitted(&rows(&scene, choice, levels)?, |r| r.error.h1));
    Ok(())
}
