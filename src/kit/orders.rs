//! Convergence to a smooth solution.

use super::discrete::{Tested, is_symmetric, promised, solve_and_judge};
use super::error::{KitError, KitErrorKind, Law};
use super::report::OrdersReport;
use super::{meshes, problems};
use crate::measure::observed_order;

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

pub(super) fn check<const D: usize>(scheme: &Tested<'_, D>) -> Result<OrdersReport, KitError> {
    let law = Law::Orders;
    let problem = problems::smooth::<D>();
    let domain = meshes::clamped();
    let errors = |level: usize| {
        let sample = meshes::regular::<D>(law, &domain, level)?;
        let errors = solve_and_judge(law, scheme, &problem, &sample)?.errors;
        Ok::<_, KitError>([errors.l2, errors.h1].map(|e| e.unwrap_or(f64::NAN)))
    };
    let [coarse_level, fine_level] = levels(D, scheme.degree());
    let (coarse, fine) = (errors(coarse_level)?, errors(fine_level)?);
    let pair = |k: usize| ErrorPair {
        errors: [coarse[k], fine[k]],
        sizes: [coarse_level, fine_level].map(|n| 1.0 / n as f64),
    };
    let degree = scheme.degree() as f64;
    let promised = promised(scheme.scheme);
    let by_duality =
        (scheme.is_consistent() && is_symmetric(scheme.scheme)).then_some(degree + 1.0);
    let l2_expected = promised.l2.into_iter().chain(by_duality).reduce(f64::max);
    let h1_expected = promised.h1.map_or(degree, |h1| h1.max(degree));
    let rounding = UNITS * f64::EPSILON * problem.dirichlet_at(&domain.upper);
    Ok(OrdersReport {
        h1: pair(1).order("H1", Some(h1_expected), rounding * fine_level as f64)?,
        h1_expected,
        l2: pair(0).order("L2", l2_expected, rounding)?,
        l2_expected,
    })
}

/// Errors on two meshes, the coarse one first.
struct ErrorPair {
    errors: [f64; 2],
    sizes: [f64; 2],
}

impl ErrorPair {
    /// The order measured, if it is what is expected but for slack and rounding.
    fn order(&self, norm: &str, expected: Option<f64>, rounding: f64) -> Result<f64, KitError> {
        let ([coarse, fine], [coarse_size, fine_size]) = (self.errors, self.sizes);
        let measured = observed_order(coarse, fine, coarse_size, fine_size).unwrap_or(f64::NAN);
        let Some(expected) = expected else { return Ok(measured) };
        let due = coarse * (fine_size / coarse_size).powf(expected - SLACK);
        if fine <= due + rounding {
            Ok(measured)
        } else {
            let message = format!(
                "the {norm} error falls from {coarse:.3e} to {fine:.3e}, an order of {measured:.2} where {expected} is due"
            );
            Err(KitError::new(Law::Orders, KitErrorKind::OrderMissed, message))
        }
    }
}
