//! Tetrahedra without volume to speak of.

use crate::error::Error;
use crate::mesh::Mesh;
use crate::scenes;
use crate::scenes::sines;
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::meshes::{clamped, slivers};
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, figures, of, quotient};
use crate::stability::runs::{definite, over, row};

const ERROR: Criterion = Criterion::new(
    "error-on-slivers",
    &[ExpectedRange::at_most(1.5)],
    "Poisson in the cube with a layer of tetrahedra of relative height t from 1 to 1e-6: the energy error over that of Crouzeix-Raviart elements on the same mesh is at most {} times its value at t = 1. The weight 1/h_F^3 is shown beside.",
);
const DEFINITE: Criterion = Criterion::new(
    "definite-on-slivers",
    &[ExpectedRange::at_least(1.0)],
    "The matrix of a symmetric scheme is positive definite on the same meshes: {} if it is.",
);
const OBSTACLE: Criterion = Criterion::new(
    "obstacle-on-slivers",
    &[ExpectedRange::at_most(1e-9)],
    "An obstacle problem on the same meshes is solved with the complementarity conditions to {}. No sliver keeps the matrix an M-matrix.",
);
const GIVEN: Criterion = Criterion::new(
    "given-meshes",
    &[ExpectedRange::at_least(1.0)],
    "The same on meshes of tetrahedra that the caller gives: the matrix is positive definite, {} if it is.",
);
pub(crate) const CASE: Case =
    Case { name: "slivers", criteria: &[ERROR, DEFINITE, OBSTACLE, GIVEN], plan };

/// The penalty `sigma/h_F` shown beside the proven one.
const SIGMA: f64 = 10.0;

fn plan(plan: &mut Plan<'_>) {
    let n = plan.pick_of(2, 4, 6);
    let heights: &[f64] = plan.pick(&[1.0, 1e-3], &[1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6]);
    let further = [
        Choice::of("wopsip@weight=anisotropic"),
        Choice::of("wopsip:facet-means@weight=anisotropic"),
        Choice::of(&format!("sipg@sigma={SIGMA}")),
    ];
    let given = plan.given;
    for choice in plan.compared_and(&further) {
        plan.add(choice, "", move |c, sink| sweep(c, n, heights, sink));
        plan.add(choice, "meshes given", move |c, sink| on_given(c, given, sink));
    }
}

fn on_given(choice: &Choice, given: &[(String, Mesh<3>)], sink: Sink<'_>) -> Result<(), Error> {
    let claim = RowBuilder::new(&GIVEN, choice);
    let scene = sines::<3>();
    for (name, mesh) in given {
        let mesh = clamped(mesh.vertices().to_vec(), mesh.cells().to_vec())?;
        let found = row(&scene.clone().domain(mesh.clone()), choice, 0)?;
        sink(
            claim
                .clone()
                .known_to_fail(choice.options().sigma == Some(SIGMA))
                .on(name)
                .quantity("has a Cholesky factor")
                .detail(figures(&found))
                .measured(definite(&scene, &mesh, choice)?),
        );
    }
    if given.is_empty() {
        sink(claim.not_applicable("not run: no mesh was given"));
    }
    Ok(())
}

fn sweep(choice: &Choice, n: usize, heights: &[f64], sink: Sink<'_>) -> Result<(), Error> {
    let mut at_one = None;
    for &height in heights {
        let mesh = slivers(1.0, n, height)?;
        let claim = |criterion| {
            RowBuilder::new(criterion, choice)
                .known_to_fail(choice.options().sigma == Some(SIGMA) && height < 0.5)
                .level(n)
                .at("relative height", height)
        };
        let scene = sines::<3>();
        let claim_of = |criterion| claim(criterion).on(&scene.name);
        sink(
            claim_of(&DEFINITE)
                .quantity("has a Cholesky factor")
                .measured(definite(&scene, &mesh, choice)?),
        );
        let on_mesh = scene.clone().domain(mesh.clone());
        let ours = row(&on_mesh, choice, 0)?;
        let share = over("cr", &on_mesh, &ours, |r| r.error.energy)?;
        at_one = at_one.or(share.filter(|_| height == 1.0));
        sink(
            claim_of(&ERROR)
                .quantity("energy error over that of cr, over the same at height 1")
                .underlying("error in the broken energy norm", of(&ours, |r| r.error.broken_energy))
                .detail(figures(&ours))
                .measured(quotient(share, at_one)),
        );
        let found = row(&scenes::polynomial::<3>().domain(mesh), choice, 0)?;
        sink(
            claim(&OBSTACLE)
                .on(&found.scene)
                .quantity("largest violation of the conditions")
                .detail(figures(&found))
                .measured(of(&found, |r| Some(r.certificate.largest()))),
        );
    }
    Ok(())
}
