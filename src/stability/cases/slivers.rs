//! Tetrahedra without volume to speak of.

use crate::stability::meshes::{clamped, slivers};
use crate::stability::table::*;

const ERROR: Criterion = Criterion::new(
    "error-on-slivers",
    &[ExpectedRange::at_most(1.5)],
    "Poisson in the cube with a layer of tetrahedra of relative height t from 1 to 1e-6: the energy error over that of Crouzeix-Raviart elements on the same mesh is at most 1.5 times its value at t = 1. The weight 1/h_F^3 is shown beside.",
);
const DEFINITE: Criterion = Criterion::new(
    "definite-on-slivers",
    &[ExpectedRange::at_least(1.0)],
    "The matrix of a symmetric scheme is positive definite on the same meshes: 1 if it is.",
);
const OBSTACLE: Criterion = Criterion::new(
    "obstacle-on-slivers",
    &[ExpectedRange::at_most(1e-9)],
    "An obstacle problem on the same meshes is solved with the complementarity conditions to 1e-9. No sliver keeps the matrix an M-matrix.",
);
const GIVEN: Criterion = Criterion::new(
    "given-meshes",
    &[ExpectedRange::at_least(1.0)],
    "The same on meshes of tetrahedra that the caller gives: the matrix is positive definite, 1 if it is.",
);
pub(crate) const CASE: Case =
    Case { name: "slivers", criteria: &[ERROR, DEFINITE, OBSTACLE, GIVEN], sweeps };

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let n = study.effort.pick(4, 6);
    let heights = study.effort.pick(&[1.0, 1e-3][..], &[1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6]);
    let on_slivers = |scene: fn() -> Scene<3>| {
        let place = |&height: &f64| {
            Ok(Place::on_mesh(scene().domain(slivers(1.0, n, height)?), Some(n)).at(height))
        };
        heights.iter().map(place).collect::<Result<Vec<_>, Error>>()
    };
    let given = |(name, mesh): &(String, _)| {
        let mut scene = sines::<3>().domain(clamped(mesh)?);
        scene.name.clone_from(name);
        Ok(Place::on_mesh(scene, None))
    };
    // on the meshes of the caller the height is none
    let has_sigma = |at: &At<'_>| at.scheme().options().sigma.is_some() && at.value() != Some(1.0);
    let asked = move |at: &At<'_>| Asked::limit_unless(has_sigma(at));
    let further = "wopsip@weight=anisotropic \
        wopsip:facet-means@weight=anisotropic sipg@sigma=10";
    let sweep = |places, columns| Sweep {
        compares: true,
        schemes: schemes(further),
        parameter: "relative height",
        places,
        columns,
        ..Sweep::default()
    };
    let share = |at: At<'_>| at.over("cr", ENERGY);
    let error =
        Column::new(&ERROR, "energy error over that of cr, over the same at height 1", move |at| {
            Some(share(*at)? / share(at.first())?)
        });
    let definite = |of| Column::new(of, "has a Cholesky factor", |at| at.definite()).asked(asked);
    let obstacle =
        Column::new(&OBSTACLE, "largest violation of the conditions", |at| at.violation());
    let given = study.meshes.iter().map(given).collect::<Result<_, Error>>()?;
    Ok(vec![
        Sweep {
            beside: schemes("cr"),
            ..sweep(on_slivers(sines)?, vec![definite(&DEFINITE), error.asked(asked)])
        },
        sweep(on_slivers(scenes::polynomial)?, vec![obstacle.asked(asked)]),
        sweep(given, vec![definite(&GIVEN)]),
    ])
}
