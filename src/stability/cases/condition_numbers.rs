//! Condition numbers over penalty factors, by the method of Lanczos: a part of the case of penalty factors.

use crate::algebra::SparseMatrix;
use crate::kit::spectrum::{MeanJump, extreme_eigenvalues};
use crate::measure::observed_order;
use crate::stability::table::*;

pub(super) const OVER_FACTORS: Criterion = Criterion::new(
    "condition-over-factors",
    &[ExpectedRange::at_most(2.0)],
    "The condition number, preconditioned by the diagonal in means and jumps, is at most 2 times that at eta = 1 for all larger eta. Without preconditioning it grows like eta, and below one it is known to grow like 1/eta.",
);
pub(super) const OVER_MESHES: Criterion = Criterion::new(
    "condition-over-meshes",
    &[ExpectedRange::at_most(2.1)],
    "The preconditioned condition number grows like h^-2 (order at most 2.1). Without preconditioning it grows like h^-4.",
);

/// A condition number by the matrix to which it belongs.
type Part = (&'static str, fn(&At<'_>) -> Option<f64>);

const PARTS: [Part; 2] =
    [("not preconditioned", plain), ("diagonal of means and jumps", in_means_and_jumps)];

pub(super) fn sweeps(effort: Effort) -> [Sweep; 2] {
    let level = effort.pick(8, 16);
    let exponents = effort.pick(&[-2, 2, 6][..], &[-4, -2, 2, 4, 6]);
    let over_factors = Sweep {
        schemes: with_eta("wopsip", exponents),
        beside: schemes("wopsip@eta=1"),
        parameter: "eta",
        places: Place::levels("sines-2d", &[level]),
        columns: PARTS.map(over_factors).into(),
        ..Sweep::default()
    };
    let over_meshes = Sweep {
        schemes: schemes("wopsip@eta=1 p1 cr sipg p2"),
        places: Place::levels("sines-2d", &[level, 2 * level]),
        columns: PARTS.map(over_meshes).into(),
        ..Sweep::default()
    };
    [over_factors, over_meshes]
}

fn over_factors((name, condition): Part) -> Column {
    let quantity = format!("condition number over that at eta = 1, {name}");
    let ratio = move |at: &At<'_>| Some(condition(at)? / condition(&at.beside("wopsip@eta=1"))?);
    let is_plain = name == PARTS[0].0;
    Column::new(&OVER_FACTORS, &quantity, ratio)
        .asked(move |at| Asked::limit_unless(is_plain || at.value() < Some(1.0)))
}

fn over_meshes((name, condition): Part) -> Column {
    let order = move |at: &At<'_>| {
        let coarse = at.before()?;
        let order = observed_order(condition(&coarse)?, condition(at)?, coarse.size(), at.size());
        order.map(|order| -order)
    };
    let is_plain = name == PARTS[0].0;
    let asked = move |at: &At<'_>| match (at.place, is_over_penalised(at)) {
        (0, _) => Asked::NoRow,
        (_, false) if !is_plain => Asked::NoRow,
        (_, is_over_penalised) => Asked::limit_unless(is_over_penalised && is_plain),
    };
    Column::new(&OVER_MESHES, &format!("order of growth, {name}"), order).asked(asked)
}

fn is_over_penalised(at: &At<'_>) -> bool {
    at.scheme().name() == "wopsip"
}

/// The condition number of `B^-1 A`, `B` a diagonal matrix; none where a factorisation fails or Lanczos' method does not converge.
fn condition(a: &SparseMatrix<f64>, b: Vec<f64>) -> Option<f64> {
    let found = extreme_eigenvalues(a, &SparseMatrix::from_diagonal(b), 1e-6);
    found.ok().map(|found| found.condition())
}

/// Of the matrix as it is.
fn plain(at: &At<'_>) -> Option<f64> {
    let matrix = at.matrix(None)?;
    condition(&matrix, vec![1.0; matrix.size()])
}

/// In means and jumps with the diagonal as preconditioner. The values of broken linears at facet means are the nodes of
/// means and jumps.
fn in_means_and_jumps(at: &At<'_>) -> Option<f64> {
    let mesh = at.scene()?.domain.mesh(at.place().level).ok()?;
    let matrix = MeanJump::new(&mesh).transform(&at.matrix(Some("facet-means"))?);
    condition(&matrix, matrix.diagonal())
}
