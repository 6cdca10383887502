//! Graded meshes: cells of very different sizes beside each other.

use crate::error::Error;
use crate::scenes;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::meshes::graded;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{RowBuilder, figures, of, quotient};
use crate::stability::runs::row_on;

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let n = plan.pick_of(8, 16, 32);
    let further = [
        Choice::new("wopsip", Penalty::ByHeights),
        Choice::new("wopsip:facet-means", Penalty::ByHeights),
        Choice::new("wopsip", Penalty::Eta(1.0)),
    ];
    for choice in plan.compared_and(&further) {
        for power in [1, 2, 4, 8] {
            plan.add("graded-meshes", choice, &format!("power {power}"), move |c, sink| {
                compare(c, n, power, sink)
            });
        }
    }
}

fn compare(choice: &Choice, n: usize, power: i32, sink: Sink<'_>) -> Result<(), Error> {
    let claim = RowBuilder::new("error-on-graded-meshes", choice)
        .on("signorini-harmonic-2d")
        .level(n)
        .at("power", f64::from(power))
        .quantity("H1 error over that of cr")
        .at_most(2.0)
        // the factor over the cube of an edge that vanishes
        .known_to_fail(
            choice.is_over_penalised() && choice.penalty == Penalty::Eta(1.0) && power >= 4,
        );
    let mesh = match graded(n, power) {
        Ok(mesh) => mesh,
        Err(why) => {
            sink(claim.detail(why.to_string()).measured(None));
            return Ok(());
        }
    };
    let shortest = mesh.shortest_edge();
    let scene = scenes::signorini_harmonic::<2>;
    let ours = row_on(scene(), mesh.clone(), choice)?;
    let means = row_on(scene(), mesh, &Choice::default("cr"))?;
    let ratio = quotient(of(&ours, |r| r.error.h1), of(&means, |r| r.error.h1));
    sink(claim.detail(format!("shortest edge {shortest:.1e}, {}", figures(&ours))).measured(ratio));
    Ok(())
}
