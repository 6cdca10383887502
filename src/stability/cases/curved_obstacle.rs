//! Curved obstacles, on which an over-penalty with bounds at vertices lifts off in a pattern.

use crate::real::Precision;
use crate::stability::table::*;

const SILENT: Criterion = Criterion::new(
    "no-silent-failure",
    &[ExpectedRange::at_most(0.0)],
    "No solver returns an iterate as converged that does not satisfy the complementarity conditions to 1e-9: the number of such returns is 0, with the active set method, whatever follows it, and with the interior point method.",
);
const CERTIFICATE: Criterion = Criterion::new(
    "certificate",
    &[ExpectedRange::at_most(1e-9)],
    "The complementarity conditions hold to 1e-9 in relative, dimensionless terms.",
);
const CONTACT_SET: Criterion = Criterion::new(
    "contact-set",
    &[ExpectedRange::at_most(1.0)],
    "The contact set, of vertices where some unknown touches, differs from the exact one by an area that, divided by that of a strip of width 2h along the free boundary, is at most 1.",
);
const MULTIPLIER: Criterion = Criterion::new(
    "multiplier-order",
    &[ExpectedRange::at_least(0.9)],
    "The multiplier, gathered over the patches of vertices, converges in L1 with order at least 0.9, fitted over levels 16, 32 and 64, where it is bounded.",
);
const ITERATIONS: Criterion = Criterion::new(
    "iterations",
    &[ExpectedRange::at_most(25.0)],
    "Started from conforming elements, the active set method and what follows where it stagnates solve at most 25 linear systems.",
);
pub(crate) const CASE: Case = Case {
    name: "curved-obstacle",
    criteria: &[SILENT, CERTIFICATE, CONTACT_SET, MULTIPLIER, ITERATIONS],
    sweeps,
};

/// An obstacle touched in a disc around the origin, its radius, and what is asked of the order of the multiplier.
type Touched = (&'static str, f64, Asked);

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let levels = study.effort.pick(&[8, 16, 32][..], &[8, 16, 32, 64]);
    let fitted = [16, 32, 64];
    // the multiplier of the cone is not bounded
    let problems: [Touched; 2] =
        [("ball-2d", 0.697_965_148_223_373_6, Asked::Limit(0)), ("cone-2d", 0.5, Asked::Report)];
    let of = |(scene, radius, asked): Touched| {
        let sweep = || Sweep {
            compares: true,
            schemes: ["wopsip", "wopsip:facet-means"].map(|name| with_eta(name, &[0, 2])).concat(),
            ..Sweep::default()
        };
        let quantity = "order of the multiplier in L1, fitted";
        let orders = Sweep {
            places: Place::levels(scene, &fitted),
            columns: vec![Column::fitted(
                &MULTIPLIER,
                quantity,
                |row| row.contact.multiplier_l1,
                move |_| asked,
            )],
            ..sweep()
        };
        let single = Sweep {
            parameter: "h",
            places: Place::levels(scene, levels)
                .into_iter()
                .map(|place| place.at_size().with_interior_point(false))
                .collect(),
            columns: vec![
                Column::new(&CERTIFICATE, "largest violation of the conditions", |at| {
                    at.violation()
                }),
                Column::new(
                    &CONTACT_SET,
                    "area of the difference over that of the strip",
                    move |at| {
                        let strip = 4.0 * at.value()? * std::f64::consts::PI * radius;
                        at.of(|row| row.contact.contact_area_error).map(|area| area / strip)
                    },
                ),
                Column::new(&ITERATIONS, "linear systems of all methods", |at| at.outer(0)),
                Column::new(&SILENT, "wrong iterates returned as converged", silent),
            ],
            ..sweep()
        };
        [single, orders]
    };
    Ok(problems.into_iter().flat_map(of).collect())
}

/// The number of solvers that returned a wrong iterate as converged.
fn silent(at: &At<'_>) -> Option<f64> {
    let limit = Precision::Double.certificate_limit();
    let is_right = |largest: f64| largest <= limit;
    let wrong = at.rows().iter().filter(|r| r.converged() && !is_right(r.certificate.largest()));
    Some(wrong.count() as f64)
}
