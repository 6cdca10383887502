//! A constant added to obstacle and Dirichlet data.

use std::sync::Arc;

use crate::problem::Datum;
use crate::stability::table::*;

const CONSTANT: Criterion = Criterion::new(
    "constant-in-the-data",
    &[ExpectedRange::at_most(64.0)],
    "With a number c from -1e7 to 1e7 added to obstacle and Dirichlet data the solve ends the same way, and the solution less c is the same to 64 units of rounding of c.",
);
pub(crate) const CASE: Case = Case { name: "constant", criteria: &[CONSTANT], sweeps };

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let level = study.effort.pick(8, 32);
    let constants = study.effort.pick(&[300.0, -1e7][..], &[300.0, 1e5, -1e7]);
    let at = |&constant: &f64| Place::new(with_constant(constant), level).at(constant);
    let quantity = "difference less c, in units of rounding of c";
    Ok(vec![Sweep {
        compares: true,
        parameter: "c",
        places: [0.0].iter().chain(constants).map(at).collect(),
        columns: vec![
            Column::new(&CONSTANT, quantity, |at| {
                let constant = at.value()?;
                Some(at.difference(constant)? / (f64::EPSILON * constant.abs()))
            })
            .asked(|at| if at.place == 0 { Asked::NoRow } else { Asked::Limit(0) }),
        ],
        ..Sweep::default()
    }])
}

/// The scene of radius one with a constant added to its solution.
fn with_constant(constant: f64) -> Scene<2> {
    let mut scene = scenes::radial::<2>(1.0);
    scene.problem.lower.everywhere = Some(Datum::Constant(constant));
    if let Some(exact) = &mut scene.problem.exact {
        let value = exact.value.clone();
        exact.value = Datum::Function(Arc::new(move |x| constant + value.at(x)));
    }
    scene
}
