//! Convergence to a smooth solution.

use super::error::{KitError, Law};
use super::report::OrdersReport;
use super::tested::{Tested, solve_and_judge};
use super::{meshes, problems};
use crate::real::Real;
use crate::study::observed_order;

/// How far orders of two small meshes may stay below those of theory.
const SLACK: f64 = 0.25;

/// Subdivisions of the coarse and of the fine box.
const fn levels(dimension: usize) -> [usize; 2] {
    match dimension {
        1 => [8, 16],
        2 => [4, 8],
        _ => [2, 4],
    }
}

pub(super) fn check<T: Real, const D: usize>(
    scheme: &dyn Tested<T, D>,
) -> Result<OrdersReport, KitError> {
    let law = Law::Orders;
    let problem = problems::smooth::<D>();
    let domain = meshes::clamped();
    let [coarse_level, fine_level] = levels(D);
    let errors = |level: usize| {
        let sample = meshes::regular::<T, D>(law, &domain, level)?;
        let errors = solve_and_judge(law, scheme, &problem, &sample)?.errors;
        Ok::<_, KitError>([errors.l2, errors.h1].map(|e| e.unwrap_or(f64::NAN)))
    };
    let (coarse, fine) = (errors(coarse_level)?, errors(fine_level)?);
    let degree = scheme.degree() as f64;
    let promised = scheme.promised();
    let l2_by_duality = (scheme.is_consistent() && scheme.is_symmetric()).then_some(degree + 1.0);
    let l2_expected = promised.l2.into_iter().chain(l2_by_duality).reduce(f64::max);
    let h1_expected = promised.h1.map_or(degree, |h1| h1.max(degree));
    let ratio = [coarse_level, fine_level].map(|n| 1.0 / n as f64);
    let order = |k: usize, norm: &'static str, expected: Option<f64>| {
        let (coarse, fine) = (coarse[k], fine[k]);
        let measured = observed_order(coarse, fine, ratio[0], ratio[1]).unwrap_or(f64::NAN);
        match expected {
            Some(expected) if !(measured >= expected - SLACK) => {
                Err(KitError::OrderMissed { norm, measured, expected, coarse, fine })
            }
            _ => Ok(measured),
        }
    };
    let h1 = order(1, "H1", Some(h1_expected))?;
    let l2 = order(0, "L2", l2_expected)?;
    Ok(OrdersReport { l2, l2_expected, h1, h1_expected })
}
