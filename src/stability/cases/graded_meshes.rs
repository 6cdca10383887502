//! Graded meshes: cells of very different sizes beside each other.

use crate::stability::meshes::graded;
use crate::stability::table::*;

const ERROR: Criterion = Criterion::new(
    "error-on-graded-meshes",
    &[ExpectedRange::at_most(2.0)],
    "Signorini on meshes graded to the end of contact, shortest over longest side of cells to 1e-6 and 1e-12: a finite solution, with a broken H1 error at most 2 times that of Crouzeix-Raviart elements on the same mesh.",
);
pub(crate) const CASE: Case = Case { name: "graded-meshes", criteria: &[ERROR], sweeps };

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let n = study.effort.pick(16, 32);
    let place = |power: i32| {
        let scene = scenes::signorini_harmonic::<2>().domain(graded(n, power)?);
        Ok(Place::on_mesh(scene, Some(n)).at(f64::from(power)))
    };
    let further = "wopsip@weight=anisotropic \
        wopsip:facet-means@weight=anisotropic wopsip@eta=1";
    // the factor over the cube of an edge that vanishes
    let is_off = |at: &At<'_>| at.scheme().options().eta.is_some() && at.value() >= Some(4.0);
    Ok(vec![Sweep {
        compares: true,
        schemes: schemes(further),
        beside: schemes("cr"),
        parameter: "power",
        places: [1, 2, 4, 8].into_iter().map(place).collect::<Result<_, Error>>()?,
        columns: vec![
            Column::new(&ERROR, "H1 error over that of cr", |at| at.over("cr", H1))
                .asked(move |at| Asked::limit_unless(is_off(at))),
        ],
    }])
}
