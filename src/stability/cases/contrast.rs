//! Coefficients that jump.

use crate::assemble::{DataQuadrature, Discretisation};
use crate::error::Error;
use crate::scenes;
use crate::scenes::Scene;
use crate::scheme::ConformingP1;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{RowBuilder, figures, fitted_order, listed, of, quotient};
use crate::stability::runs::{row, rows};
use crate::study::Row;

/// Most active sets that count as bounded.
const MOST_SETS: f64 = 25.0;

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick_of(8, 16, 32);
    let exponents: &[i32] = plan.pick(&[-8, -4, 4, 8], &[-8, -6, -4, -2, 2, 4, 6, 8]);
    let further = [
        Choice::new("wopsip", Penalty::Unweighted),
        Choice::new("wopsip:facet-means", Penalty::Unweighted),
        Choice::new("sipg", Penalty::Sigma(10.0)),
    ];
    for choice in plan.compared_and(&further) {
        plan.add("contrast", choice, "two layers", move |c, sink| {
            aligned(c, level, exponents, sink)
        });
    }
    let middle = plan.pick_of(8, 32, 32);
    for choice in plan.compared() {
        plan.add("contrast", choice, "two materials", move |c, sink| across(c, middle, sink));
    }
    let levels: &[usize] = plan.pick_of(&[4, 8], &[8, 16, 32], &[8, 16, 32, 64]);
    for choice in plan.compared() {
        plan.add("contrast", choice, "disc of another material", move |c, sink| {
            inside_cells(c, levels, sink)
        });
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
        let row = row::<2>(scene, choice, level)?;
        let error = quotient(of(&row, |r| r.error.energy), norm);
        let broken = quotient(of(&row, |r| r.error.broken_energy), norm);
        Ok((row, [error, broken]))
    };
    let (_, [at_one, _]) = relative(1.0)?;
    for &exponent in exponents {
        let contrast = 10.0_f64.powi(exponent);
        let (row, [error, broken]) = relative(contrast)?;
        let relative = error.map_or(String::new(), |e| format!(", relative energy error {e:.2e}"));
        let claim = |name| {
            RowBuilder::new(name, choice)
                .on(&row.scene)
                .level(level)
                .at("contrast", contrast)
                .detail(format!("{}{relative}", figures(&row)))
        };
        sink(
            claim("error-over-contrast")
                .quantity("relative energy error over that at contrast 1")
                .at_most(1.5)
                .underlying("relative error in the broken energy norm", broken)
                // below one it is larger than it need be, which harms less
                .known_to_fail(choice.penalty == Penalty::Unweighted && contrast > 1.0)
                .measured(quotient(error, at_one)),
        );
        let sets = of(&row, |r| r.iterations.outer.map(|n| n as f64));
        sink(
            claim("iterations-over-contrast")
                .quantity("active sets tried")
                .at_most(MOST_SETS)
                .measured(sets),
        );
    }
    Ok(())
}

fn across(choice: &Choice, level: usize, sink: Sink<'_>) -> Result<(), Error> {
    for contrast in [1e-6, 1e6] {
        let ours = row::<2>(scenes::contrast::<2>(contrast), choice, level)?;
        let p1 = Choice::default("p1");
        let theirs = row::<2>(scenes::contrast::<2>(contrast), &p1, level)?;
        let error = |r: &Row| r.error.h1;
        sink(
            RowBuilder::new("interface-across-flux", choice)
                .on(&ours.scene)
                .level(level)
                .at("contrast", contrast)
                .quantity("H1 error over that of p1")
                .at_most(1.15)
                .detail(figures(&ours))
                .measured(quotient(of(&ours, error), of(&theirs, error))),
        );
    }
    Ok(())
}

fn inside_cells(choice: &Choice, levels: &[usize], sink: Sink<'_>) -> Result<(), Error> {
    let contrast = 1e6;
    let rows = rows::<2>(scenes::contrast_disc_2d(contrast), choice, levels)?;
    let errors: Vec<(usize, f64)> =
        rows.iter().filter_map(|r| Some((r.level, of(r, |r| r.error.h1)?))).collect();
    sink(
        RowBuilder::new("interface-inside-cells", choice)
            .on("contrast-disc-2d")
            .at("contrast", contrast)
            .quantity("order in H1, fitted")
            .detail(format!("H1 error {}", listed(&errors)))
            .measured(fitted_order(&errors)),
    );
    Ok(())
}
