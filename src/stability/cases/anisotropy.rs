//! Stretched cells.

use crate::error::Error;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::meshes::stretched;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{RowBuilder, figures, jump, of, quotient};
use crate::stability::runs::{definite, row_on, sines};

/// The penalty `sigma/h_F` shown beside the proven one.
const SIGMA: f64 = 10.0;

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let n = plan.pick(8, 16);
    let ratios: &[usize] = plan.pick_of(&[1, 16], &[1, 16, 64], &[1, 4, 16, 64, 256]);
    let further = [
        Choice::new("wopsip", Penalty::ByHeights),
        Choice::new("wopsip:facet-means", Penalty::ByHeights),
        Choice::new("wopsip", Penalty::Eta(1.0)),
        Choice::new("sipg", Penalty::Sigma(SIGMA)),
    ];
    for choice in plan.compared_and(&further) {
        plan.add("stretched-cells", choice, "", move |c, sink| sweep(c, n, ratios, sink));
    }
}

fn sweep(choice: &Choice, n: usize, ratios: &[usize], sink: Sink<'_>) -> Result<(), Error> {
    let is_by_edge = choice.is_over_penalised() && choice.penalty != Penalty::ByHeights;
    let mut at_one = None;
    for &ratio in ratios {
        let mesh = stretched(n, ratio)?;
        let claim = |name| {
            RowBuilder::new(name, choice).on("sines-2d").level(n).at("aspect ratio", ratio as f64)
        };
        // the threshold of sigma/h_F is about twice the aspect ratio
        let is_weak = choice.penalty == Penalty::Sigma(SIGMA) && 2.0 * ratio as f64 > SIGMA;
        // close to the threshold it is definite and not accurate
        let is_scarce = choice.penalty == Penalty::Sigma(SIGMA) && ratio > 1;
        sink(
            claim("definite-on-stretched-cells")
                .quantity("has a Cholesky factor")
                .at_least(1.0)
                .known_to_fail(is_weak)
                .measured(definite(&sines().problem, &mesh, choice)?),
        );
        let ours = row_on(sines(), mesh.clone(), choice)?;
        let means = row_on(sines(), mesh, &Choice::default("cr"))?;
        let share = quotient(of(&ours, |r| r.error.energy), of(&means, |r| r.error.energy));
        at_one = at_one.or(share);
        let jumps = of(&ours, jump).filter(|_| ours.error.energy != ours.error.h1);
        let jumps = jumps.map_or(String::new(), |j| format!(", jump part {j:.2e}"));
        sink(
            claim("error-on-stretched-cells")
                .quantity("energy error over that of cr, over the same at ratio 1")
                .at_most(1.5)
                .underlying("error in the broken energy norm", of(&ours, |r| r.error.broken_energy))
                .known_to_fail(is_scarce || is_by_edge && ratio > 4)
                .detail(format!("{}{jumps}", figures(&ours)))
                .measured(quotient(share, at_one)),
        );
    }
    Ok(())
}
