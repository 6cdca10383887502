//! Condition numbers over penalty factors, by the method of Lanczos: a part of the case of penalty factors.

use crate::algebra::SparseMatrix;
use crate::error::Error;
use crate::kit::spectrum::{CholeskyMatrix, Diagonal, Lanczos, MeanJump, PositiveDefinite};
use crate::measure::observed_order;
use crate::mesh::Mesh;
use crate::scenes::sines;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, quotient};
use crate::stability::runs::free_matrix;

pub(super) const OVER_FACTORS: Criterion = Criterion::new(
    "condition-over-factors",
    &[ExpectedRange::at_most(2.0)],
    "The condition number, preconditioned by the diagonal in means and jumps, is at most {} times that at eta = 1 for all larger eta. Without preconditioning it grows like eta, and below one it is known to grow like 1/eta.",
);
pub(super) const OVER_MESHES: Criterion = Criterion::new(
    "condition-over-meshes",
    &[ExpectedRange::at_most(2.1)],
    "The preconditioned condition number grows like h^-2 (order at most {}). Without preconditioning it grows like h^-4.",
);

/// The two matrices with a condition number.
const PARTS: [&str; 2] = ["not preconditioned", "diagonal of means and jumps"];

pub(super) fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick(8, 16);
    let exponents: &[i32] = plan.pick(&[-2, 2, 6], &[-4, -2, 2, 4, 6]);
    for &exponent in exponents {
        let choice = Choice::with_eta("wopsip", exponent);
        plan.add(choice, "condition number", move |c, sink| over_factors(c, exponent, level, sink));
    }
    let finest = plan.pick(16, 32);
    for scheme in ["wopsip@eta=1", "p1", "cr", "sipg", "p2"] {
        plan.add(Choice::of(scheme), "condition number", move |c, sink| {
            over_meshes(c, finest, sink)
        });
    }
}

/// The condition number of `B^-1 A`; none where a factorisation fails or Lanczos' method does not converge.
fn condition(matrix: &SparseMatrix<f64>, b: &dyn PositiveDefinite) -> Option<f64> {
    let a = CholeskyMatrix::new(matrix).ok()?;
    let lanczos = Lanczos::default().with_tolerance(1e-6);
    lanczos.extremes(&a, b).ok().map(|found| found.condition())
}

/// The condition numbers of the matrix as it is, and in means and jumps with its diagonal as preconditioner.
fn both(choice: &Choice, level: usize) -> Result<[Option<f64>; 2], Error> {
    let scene = sines::<2>();
    let mesh: Mesh<2> = scene.domain.mesh(level)?;
    let matrix = free_matrix(&scene, &mesh, choice)?;
    let plain = condition(&matrix, &Diagonal::identity(matrix.size()));
    if !choice.is_over_penalised() {
        return Ok([plain, None]);
    }
    // the values of broken linears at facet means are the nodes of means and jumps
    let means = Choice::of(&format!("wopsip:facet-means@{}", choice.options()));
    let matrix = MeanJump::new(&mesh).transform(&free_matrix(&scene, &mesh, &means)?);
    Ok([plain, condition(&matrix, &Diagonal(matrix.diagonal()))])
}

fn over_factors(choice: &Choice, exponent: i32, level: usize, sink: Sink<'_>) -> Result<(), Error> {
    let here = both(choice, level)?;
    let at_one = both(&Choice::with_eta("wopsip", 0), level)?;
    for (k, part) in PARTS.into_iter().enumerate() {
        sink(
            RowBuilder::new(&OVER_FACTORS, choice)
                .known_to_fail(k == 0 || exponent < 0)
                .on("sines-2d")
                .level(level)
                .at("eta", 10.0_f64.powi(exponent))
                .quantity(&format!("condition number over that at eta = 1, {part}"))
                .underlying(&format!("condition number, {part}"), here[k])
                .detail(here[k].map_or(String::new(), |c| format!("condition number {c:.3e}")))
                .measured(quotient(here[k], at_one[k])),
        );
    }
    Ok(())
}

fn over_meshes(choice: &Choice, finest: usize, sink: Sink<'_>) -> Result<(), Error> {
    let levels = [finest / 2, finest];
    let [coarse, fine] = [both(choice, levels[0])?, both(choice, levels[1])?];
    let parts: &[&str] = if choice.is_over_penalised() { &PARTS } else { &PARTS[..1] };
    for (k, part) in parts.iter().enumerate() {
        let pair = coarse[k].zip(fine[k]);
        let order = pair.and_then(|(a, b)| {
            let [h, half] = levels.map(|n| 1.0 / n as f64);
            observed_order(a, b, h, half).map(|order| -order)
        });
        sink(
            RowBuilder::new(&OVER_MESHES, choice)
                .known_to_fail(choice.is_over_penalised() && k == 0)
                .on("sines-2d")
                .level(finest)
                .quantity(&format!("order of growth, {part}"))
                .detail(fine[k].map_or(String::new(), |c| format!("condition number {c:.3e}")))
                .measured(order),
        );
    }
    Ok(())
}
