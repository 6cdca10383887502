//! Condition numbers, by the method of Lanczos.

use crate::algebra::SparseMatrix;
use crate::error::Error;
use crate::kit::spectrum::{CholeskyMatrix, Diagonal, Lanczos, MeanJump, PositiveDefinite};
use crate::measure::observed_order;
use crate::mesh::Mesh;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::RowBuilder;
use crate::stability::runs::{free_matrix, sines};

/// The two matrices with a condition number.
const PARTS: [&str; 2] = ["not preconditioned", "diagonal of means and jumps"];

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick(8, 16);
    let exponents: &[i32] = plan.pick(&[-2, 2, 6], &[-4, -2, 2, 4, 6]);
    for &exponent in exponents {
        let choice = Choice::new("wopsip", Penalty::Eta(10.0_f64.powi(exponent)));
        plan.add("penalty-factor", choice, "condition number", move |c, sink| {
            factors(c, exponent, level, sink)
        });
    }
    let finest = plan.pick(16, 32);
    for choice in [
        Choice::new("wopsip", Penalty::Eta(1.0)),
        Choice::default("p1"),
        Choice::default("cr"),
        Choice::default("sipg"),
        Choice::default("p2"),
    ] {
        plan.add("penalty-factor", choice, "condition number", move |c, sink| {
            meshes(c, finest, sink)
        });
    }
}

/// The condition number of `B^-1 A`; none where it is out of reach.
fn condition(matrix: &SparseMatrix<f64>, b: &dyn PositiveDefinite) -> Option<f64> {
    let a = CholeskyMatrix::new(matrix).ok()?;
    let lanczos = Lanczos::default().with_tolerance(1e-6);
    lanczos.extremes(&a, b).ok().map(|found| found.condition())
}

/// The matrix as it is, and in means and jumps with its diagonal as preconditioner.
fn both(choice: &Choice, level: usize) -> Result<[Option<f64>; 2], Error> {
    let scene = sines::<2>();
    let mesh: Mesh<2> = scene.domain.mesh(level)?;
    let matrix = free_matrix(&scene.problem, &mesh, choice)?;
    let plain = condition(&matrix, &Diagonal::identity(matrix.size()));
    let means = Choice::new("wopsip:facet-means", choice.penalty);
    if !choice.is_over_penalised() {
        return Ok([plain, None]);
    }
    let matrix = MeanJump::new(&mesh).transform(&free_matrix(&scene.problem, &mesh, &means)?);
    Ok([plain, condition(&matrix, &Diagonal(matrix.diagonal()))])
}

fn factors(choice: &Choice, exponent: i32, level: usize, sink: Sink<'_>) -> Result<(), Error> {
    let here = both(choice, level)?;
    let at_one = both(&Choice::new(choice.scheme, Penalty::Eta(1.0)), level)?;
    for (k, what) in PARTS.into_iter().enumerate() {
        let claim = RowBuilder::new("condition-over-factors", choice)
            .with(what)
            .on("sines-2d")
            .level(level)
            .at("eta", 10.0_f64.powi(exponent))
            .quantity("condition number over that at eta = 1")
            .at_most(2.0)
            .known_to_fail(k == 0 || exponent < 0)
            .underlying("condition number", here[k])
            .detail(here[k].map_or(String::new(), |c| format!("condition number {c:.3e}")));
        sink(claim.measured(here[k].zip(at_one[k]).map(|(a, b)| a / b)));
    }
    Ok(())
}

fn meshes(choice: &Choice, finest: usize, sink: Sink<'_>) -> Result<(), Error> {
    let levels = [finest / 2, finest];
    let [coarse, fine] = [both(choice, levels[0])?, both(choice, levels[1])?];
    let parts: &[&str] = if choice.is_over_penalised() { &PARTS } else { &PARTS[..1] };
    for (k, what) in parts.iter().enumerate() {
        let pair = coarse[k].zip(fine[k]);
        let order = pair.and_then(|(a, b)| {
            let [h, half] = levels.map(|n| 1.0 / n as f64);
            observed_order(a, b, h, half).map(|order| -order)
        });
        sink(
            RowBuilder::new("condition-over-meshes", choice)
                .with(what)
                .on("sines-2d")
                .level(finest)
                .quantity("order of growth")
                .at_most(2.1)
                .known_to_fail(choice.is_over_penalised() && k == 0)
                .detail(fine[k].map_or(String::new(), |c| format!("condition number {c:.3e}")))
                .measured(order),
        );
    }
    Ok(())
}
