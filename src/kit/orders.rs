//! Convergence to a smooth solution.

use super::discrete::{Tested, solve_and_judge};
use super::error::{Fault, KitErrorKind, Law};
use super::report::LawReport;
use super::{meshes, problems};
use crate::measure::observed_order;
use crate::mesh::Mesh;
use crate::scheme::{Regularity, Setting};

/// Largest deficit of an order observed on two small meshes.
const SLACK: f64 = 0.25;

/// Rounding errors allowed in the fine error, in rounding units times the largest value of the
/// solution: in single precision they exceed the discretisation error of quadratics.
const UNITS: f64 = 128.0;

/// Subdivisions of the coarse and of the fine box: few where there are many unknowns.
const fn levels(dimension: usize, degree: usize) -> [usize; 2] {
    match (dimension, degree) {
        (1, _) => [8, 16],
        (2, _) => [4, 8],
        (_, 1) => [2, 4],
        _ => [2, 3],
    }
}

pub(super) fn check<const D: usize>(scheme: &Tested<'_, D>) -> Result<LawReport, Fault> {
    let problem = problems::smooth::<D>();
    let domain = meshes::clamped();
    let errors = |level: usize| {
        let sample = meshes::regular::<D>(&domain, level)?;
        let (errors, _) = solve_and_judge(scheme, &problem, &sample)?;
        Ok::<_, Fault>([errors.l2, errors.h1].map(|e| e.unwrap_or(f64::NAN)))
    };
    let [coarse_level, fine_level] = levels(D, scheme.degree());
    let (coarse, fine) = (errors(coarse_level)?, errors(fine_level)?);
    let sizes = [coarse_level, fine_level].map(|n| 1.0 / n as f64);
    let degree = scheme.degree() as f64;
    // for a smooth solution without inequalities
    let setting = Setting { regular_dual: true, ..Setting::new(D, Regularity::smooth()) };
    let promised = scheme.expected_orders(&setting);
    let cell = Mesh::kuhn_box(&domain, [1; D]);
    let is_symmetric = || cell.is_ok_and(|mesh| scheme.form(&mesh).is_symmetric());
    let by_duality = (scheme.is_consistent() && is_symmetric()).then_some(degree + 1.0);
    let l2_expected = promised.l2.into_iter().chain(by_duality).reduce(f64::max);
    let h1_expected = promised.h1.map_or(degree, |h1| h1.max(degree));
    let rounding = UNITS * f64::EPSILON * problem.dirichlet_at(&domain.upper);
    let h1 = order(
        ("H1", Some(h1_expected)),
        ([coarse[1], fine[1]], sizes),
        rounding * fine_level as f64,
    )?;
    let l2 = order(("L2", l2_expected), ([coarse[0], fine[0]], sizes), rounding)?;
    let mut figures = vec![("L2", l2), ("H1", h1), ("H1 due", h1_expected)];
    figures.extend(l2_expected.map(|due| ("L2 due", due)));
    Ok(LawReport::new(Law::Orders, format!("L2 {l2:.2}, H1 {h1:.2}"), &figures))
}

/// The order measured by the errors on two meshes of these sizes, the coarse one first, if it is what is expected but
/// for slack and rounding.
fn order(
    (norm, expected): (&str, Option<f64>),
    ([coarse, fine], [coarse_size, fine_size]): ([f64; 2], [f64; 2]),
    rounding: f64,
) -> Result<f64, Fault> {
    let measured = observed_order(coarse, fine, coarse_size, fine_size).unwrap_or(f64::NAN);
    let Some(expected) = expected else { return Ok(measured) };
    let due = coarse * (fine_size / coarse_size).powf(expected - SLACK);
    if fine <= due + rounding {
        Ok(measured)
    } else {
        let message = format!(
            "the {norm} error falls from {coarse:.3e} to {fine:.3e}, an order of {measured:.2} where {expected} is due"
        );
        Err(Fault::new(KitErrorKind::OrderMissed, message))
    }
}
