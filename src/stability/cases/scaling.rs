//! Invariance under a change of units.

use crate::problem::Datum;
use crate::stability::table::*;

const DOMAIN: Criterion = Criterion::new(
    "size-of-domain",
    &[ExpectedRange::at_most(1e-10)],
    "On a domain L times as large, L from 1e-6 to 1e6, the solution is the same at corresponding points to 1e-10. A factor eta without dimension is known to fail.",
);
const COEFFICIENT: Criterion = Criterion::new(
    "size-of-coefficient",
    &[ExpectedRange::at_most(1e-10)],
    "With coefficient and load c times as large, c from 1e-8 to 1e8, the solution is the same to 1e-10.",
);
pub(crate) const CASE: Case = Case { name: "scaling", criteria: &[DOMAIN, COEFFICIENT], sweeps };

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let level = study.effort.pick(8, 32);
    let lengths = study.effort.pick(&[1e-6, 1e6][..], &[1e-6, 1e-3, 1e3, 1e6]);
    let factors = study.effort.pick(&[1e-8, 1e8][..], &[1e-8, 1e-4, 1e4, 1e8]);
    let sweep = |criterion, parameter, units: &[f64], scene: fn(f64) -> Scene<2>| {
        let at =
            |&unit: &f64| Place { shown: Some(level), ..Place::new(scene(unit), level).at(unit) };
        Sweep {
            compares: true,
            parameter,
            places: [1.0].iter().chain(units).map(at).collect(),
            columns: vec![
                Column::new(criterion, "relative difference of solutions", |at| {
                    let largest = at.first().values()?.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                    Some(at.difference(0.0)? / largest)
                })
                .asked(|at| match at.place {
                    // the units with which others are compared
                    0 => Asked::NoRow,
                    _ => Asked::limit_unless(at.scheme().options().eta.is_some()),
                }),
            ],
            ..Sweep::default()
        }
    };
    let domain = sweep(&DOMAIN, "L", lengths, scenes::radial);
    let further = schemes("wopsip@eta=1 wopsip:facet-means@eta=1");
    Ok(vec![
        Sweep { schemes: further, ..domain },
        sweep(&COEFFICIENT, "c", factors, with_coefficient),
    ])
}

/// The scene of radius one with coefficient and load times a factor.
fn with_coefficient(factor: f64) -> Scene<2> {
    let mut scene = scenes::radial::<2>(1.0);
    scene.problem.source.everywhere = Some(Datum::Constant(-2.0 * factor));
    scene.problem = scene.problem.coefficient(move |_| factor);
    scene
}
