//! Graded meshes: cells of very different sizes beside each other.

use crate::error::Error;
use crate::scenes;
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::meshes::graded;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, figures};
use crate::stability::runs::{over, row};

const ERROR: Criterion = Criterion::new(
    "error-on-graded-meshes",
    &[ExpectedRange::at_most(2.0)],
    "Signorini on meshes graded to the end of contact, shortest over longest side of cells to 1e-6 and 1e-12: a finite solution, with a broken H1 error at most {} times that of Crouzeix-Raviart elements on the same mesh.",
);
pub(crate) const CASE: Case = Case { name: "graded-meshes", criteria: &[ERROR], plan };

fn plan(plan: &mut Plan<'_>) {
    let n = plan.pick_of(8, 16, 32);
    let further = [
        Choice::of("wopsip@weight=anisotropic"),
        Choice::of("wopsip:facet-means@weight=anisotropic"),
        Choice::with_eta("wopsip", 0),
    ];
    for choice in plan.compared_and(&further) {
        for power in [1, 2, 4, 8] {
            plan.add(choice, &format!("power {power}"), move |c, sink| compare(c, n, power, sink));
        }
    }
}

fn compare(choice: &Choice, n: usize, power: i32, sink: Sink<'_>) -> Result<(), Error> {
    let scene = scenes::signorini_harmonic::<2>();
    let claim = RowBuilder::new(&ERROR, choice)
        // the factor over the cube of an edge that vanishes
        .known_to_fail(choice.options().eta == Some(1.0) && power >= 4)
        .on(&scene.name)
        .level(n)
        .at("power", f64::from(power))
        .quantity("H1 error over that of cr");
    let mesh = match graded(n, power) {
        Ok(mesh) => mesh,
        Err(why) => {
            sink(claim.detail(why.to_string()).measured(None));
            return Ok(());
        }
    };
    let shortest = mesh.shortest_edge();
    let scene = scene.domain(mesh);
    let ours = row(&scene, choice, 0)?;
    let ratio = over("cr", &scene, &ours, |r| r.error.h1)?;
    sink(claim.detail(format!("shortest edge {shortest:.1e}, {}", figures(&ours))).measured(ratio));
    Ok(())
}
