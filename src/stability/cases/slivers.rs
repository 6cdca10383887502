//! Tetrahedra without volume to speak of.

use crate::error::Error;
use crate::scenes;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::meshes::{clamped, slivers};
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{RowBuilder, figures, of, quotient};
use crate::stability::runs::{definite, row_on, sines};

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let n = plan.pick_of(2, 4, 6);
    let heights: &[f64] = plan.pick(&[1.0, 1e-3], &[1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6]);
    let further = [
        Choice::new("wopsip", Penalty::ByHeights),
        Choice::new("wopsip:facet-means", Penalty::ByHeights),
        Choice::new("sipg", Penalty::Sigma(10.0)),
    ];
    let given = plan.given;
    for choice in plan.compared_and(&further) {
        plan.add("slivers", choice, "", move |c, sink| sweep(c, n, heights, sink));
        plan.add("slivers", choice, "meshes given", move |c, sink| {
            for (name, mesh) in given {
                let mesh = clamped(mesh.vertices().to_vec(), mesh.cells().to_vec())?;
                let claim =
                    RowBuilder::new("given-meshes", c).on(name).quantity("has a Cholesky factor");
                let error = row_on(sines(), mesh.clone(), c)?;
                let is_weak = c.penalty == Penalty::Sigma(10.0);
                let claim = claim.detail(figures(&error)).at_least(1.0).known_to_fail(is_weak);
                sink(claim.measured(definite(&sines::<3>().problem, &mesh, c)?));
            }
            if given.is_empty() {
                sink(
                    RowBuilder::new("given-meshes", c).not_applicable("not run: no mesh was given"),
                );
            }
            Ok(())
        });
    }
}

fn sweep(choice: &Choice, n: usize, heights: &[f64], sink: Sink<'_>) -> Result<(), Error> {
    let is_weak = |height: f64| choice.penalty == Penalty::Sigma(10.0) && height < 0.5;
    let mut at_one = None;
    for &height in heights {
        let mesh = slivers(1.0, n, height)?;
        let claim = |name, problem: &str| {
            RowBuilder::new(name, choice).on(problem).level(n).at("relative height", height)
        };
        sink(
            claim("definite-on-slivers", "sines-3d")
                .quantity("has a Cholesky factor")
                .at_least(1.0)
                .known_to_fail(is_weak(height))
                .measured(definite(&sines::<3>().problem, &mesh, choice)?),
        );
        let ours = row_on(sines::<3>(), mesh.clone(), choice)?;
        let means = row_on(sines::<3>(), mesh.clone(), &Choice::default("cr"))?;
        let share = quotient(of(&ours, |r| r.error.energy), of(&means, |r| r.error.energy));
        at_one = at_one.or(share);
        sink(
            claim("error-on-slivers", "sines-3d")
                .quantity("energy error over that of cr, over the same at height 1")
                .at_most(1.5)
                .underlying("error in the broken energy norm", of(&ours, |r| r.error.broken_energy))
                .known_to_fail(is_weak(height))
                .detail(figures(&ours))
                .measured(quotient(share, at_one)),
        );
        let found = row_on(scenes::polynomial::<3>(), mesh, choice)?;
        sink(
            claim("obstacle-on-slivers", &found.scene)
                .quantity("largest violation of the conditions")
                .at_most(1e-9)
                .known_to_fail(is_weak(height))
                .detail(figures(&found))
                .measured(of(&found, |r| Some(r.certificate.largest()))),
        );
    }
    Ok(())
}
