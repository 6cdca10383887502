//! The law of a family of quadrature rules.

use super::error::{KitError, Law};
use super::report::QuadratureReport;
use crate::error::Error;
use crate::quadrature::{Quadrature, Rule};

/// Tests the rule of a family in a dimension: it is exact for polynomials of the degree asked for.
///
/// # Errors
/// [`KitError::RuleNotExact`]; [`KitError::NotAssembled`] if the family has no such rule, or it is
/// none.
pub fn check_quadrature(
    family: &dyn Quadrature,
    dimension: usize,
    degree: usize,
) -> Result<QuadratureReport, KitError> {
    let rule = family
        .rule(dimension, degree)
        .and_then(|rule| Rule::from_points(dimension, rule.points, rule.weights))
        .map_err(|why| KitError::NotAssembled { law: Law::Quadrature, why: Error::from(why) })?;
    let mut error: f64 = 0.0;
    for moment in rule.moments(dimension, degree) {
        if !moment.is_exact() {
            return Err(KitError::RuleNotExact {
                family: family.name().to_owned(),
                dimension,
                degree,
                powers: moment.powers,
                found: moment.found,
                expected: moment.expected,
            });
        }
        error = error.max(moment.deviation());
    }
    let smallest_weight = rule.weights.iter().copied().fold(f64::INFINITY, f64::min);
    Ok(QuadratureReport { points: rule.points.len(), smallest_weight, error })
}
