//! Stretched cells.

use crate::error::Error;
use crate::facet::WeightRule;
use crate::scenes::sines;
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::meshes::stretched;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, figures, jumps, of, quotient};
use crate::stability::runs::{definite, over, row};

const ERROR: Criterion = Criterion::new(
    "error-on-stretched-cells",
    &[ExpectedRange::at_most(1.5)],
    "Poisson on an N by N a mesh, aspect ratios a to 256: the energy error over that of Crouzeix-Raviart elements is at most {} times its value at a = 1. The weight 1/h_F^3 is known to fail.",
);
const DEFINITE: Criterion = Criterion::new(
    "definite-on-stretched-cells",
    &[ExpectedRange::at_least(1.0)],
    "The matrix of a symmetric scheme is positive definite for every aspect ratio: {} if it is. A penalty 10/h_F is known to fail from the ratio five on.",
);
pub(crate) const CASE: Case = Case { name: "stretched-cells", criteria: &[ERROR, DEFINITE], plan };

/// The penalty `sigma/h_F` shown beside the proven one.
const SIGMA: f64 = 10.0;

fn plan(plan: &mut Plan<'_>) {
    let n = plan.pick(8, 16);
    let ratios: &[usize] = plan.pick_of(&[1, 16], &[1, 16, 64], &[1, 4, 16, 64, 256]);
    let further = [
        Choice::of("wopsip@weight=anisotropic"),
        Choice::of("wopsip:facet-means@weight=anisotropic"),
        Choice::with_eta("wopsip", 0),
        Choice::of(&format!("sipg@sigma={SIGMA}")),
    ];
    for choice in plan.compared_and(&further) {
        plan.add(choice, "", move |c, sink| sweep(c, n, ratios, sink));
    }
}

fn sweep(choice: &Choice, n: usize, ratios: &[usize], sink: Sink<'_>) -> Result<(), Error> {
    let options = choice.options();
    let is_by_edge = choice.is_over_penalised() && options.weight != Some(WeightRule::Anisotropic);
    let has_sigma = options.sigma == Some(SIGMA);
    let mut at_one = None;
    for &ratio in ratios {
        let scene = sines::<2>();
        let mesh = stretched(n, ratio)?;
        let claim = |criterion| {
            let of = RowBuilder::new(criterion, choice).on(&scene.name).level(n);
            of.at("aspect ratio", ratio as f64)
        };
        sink(
            claim(&DEFINITE)
                // the threshold of sigma/h_F is about twice the aspect ratio
                .known_to_fail(has_sigma && 2.0 * ratio as f64 > SIGMA)
                .quantity("has a Cholesky factor")
                .measured(definite(&scene, &mesh, choice)?),
        );
        let scene = scene.clone().domain(mesh);
        let ours = row(&scene, choice, 0)?;
        let share = over("cr", &scene, &ours, |r| r.error.energy)?;
        at_one = at_one.or(share.filter(|_| ratio == 1));
        let jumps = of(&ours, jumps).filter(|_| ours.error.energy != ours.error.h1);
        let jumps = jumps.map_or(String::new(), |j| format!(", jump seminorm {j:.2e}"));
        sink(
            claim(&ERROR)
                // close to the threshold of sigma/h_F the matrix is definite and the solution not accurate
                .known_to_fail(has_sigma && ratio > 1 || is_by_edge && ratio > 4)
                .quantity("energy error over that of cr, over the same at ratio 1")
                .underlying("error in the broken energy norm", of(&ours, |r| r.error.broken_energy))
                .detail(format!("{}{jumps}", figures(&ours)))
                .measured(quotient(share, at_one)),
        );
    }
    Ok(())
}
