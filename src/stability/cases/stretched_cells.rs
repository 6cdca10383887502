//! Stretched cells.

use crate::facet::WeightRule;
use crate::stability::meshes::stretched;
use crate::stability::table::*;

const ERROR: Criterion = Criterion::new(
    "error-on-stretched-cells",
    &[ExpectedRange::at_most(1.5)],
    "Poisson on an N by N a mesh, aspect ratios a to 256: the energy error over that of Crouzeix-Raviart elements is at most 1.5 times its value at a = 1. The weight 1/h_F^3 is known to fail.",
);
const DEFINITE: Criterion = Criterion::new(
    "definite-on-stretched-cells",
    &[ExpectedRange::at_least(1.0)],
    "The matrix of a symmetric scheme is positive definite for every aspect ratio: 1 if it is. A penalty 10/h_F is known to fail from the ratio five on.",
);
pub(crate) const CASE: Case =
    Case { name: "stretched-cells", criteria: &[ERROR, DEFINITE], sweeps };

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let n = study.effort.pick(8, 16);
    let ratios = study.effort.pick(&[1, 16, 64][..], &[1, 4, 16, 64, 256]);
    let place = |&ratio: &usize| {
        let scene = sines::<2>().domain(stretched(n, ratio)?);
        Ok(Place::on_mesh(scene, Some(n)).at(ratio as f64))
    };
    let further = "wopsip@weight=anisotropic \
        wopsip:facet-means@weight=anisotropic wopsip@eta=1 sipg@sigma=10";
    let is_indefinite = |at: &At<'_>| {
        // the threshold of sigma/h_F is about twice the aspect ratio
        at.scheme().options().sigma < at.value().map(|ratio| 2.0 * ratio) && has_sigma(at)
    };
    let is_off = |at: &At<'_>| {
        let is_by_edge = at.scheme().name().starts_with("wopsip")
            && at.scheme().options().weight != Some(WeightRule::Anisotropic);
        // close to the threshold of sigma/h_F the matrix is definite and the solution not accurate
        has_sigma(at) && at.value() > Some(1.0) || is_by_edge && at.value() > Some(4.0)
    };
    Ok(vec![Sweep {
        compares: true,
        schemes: schemes(further),
        beside: schemes("cr"),
        parameter: "aspect ratio",
        places: ratios.iter().map(place).collect::<Result<_, Error>>()?,
        columns: vec![
            Column::new(&DEFINITE, "has a Cholesky factor", |at| at.definite())
                .asked(move |at| Asked::limit_unless(is_indefinite(at))),
            Column::new(&ERROR, "energy error over that of cr, over the same at ratio 1", |at| {
                Some(at.over("cr", ENERGY)? / at.first().over("cr", ENERGY)?)
            })
            .asked(move |at| Asked::limit_unless(is_off(at))),
        ],
    }])
}

/// Whether the penalty is a factor over the facet's diameter, shown beside the proven one.
fn has_sigma(at: &At<'_>) -> bool {
    at.scheme().options().sigma.is_some()
}
