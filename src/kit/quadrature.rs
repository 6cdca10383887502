//! The law of a family of quadrature rules.

use super::error::{KitError, KitErrorKind, Law};
use super::report::QuadratureReport;
use crate::quadrature::{Quadrature, Rule};

/// Tests the rule of a family in a dimension: it is exact for polynomials of the degree asked for.
///
/// # Errors
/// [`KitErrorKind::RuleNotExact`]; [`KitErrorKind::NotAssembled`] if the family has no such rule, or it is
/// none.
pub fn check_quadrature(
    family: &dyn Quadrature,
    dimension: usize,
    degree: usize,
) -> Result<QuadratureReport, KitError> {
    let rule = family
        .rule(dimension, degree)
        .and_then(|rule| Rule::from_points(dimension, rule.points, rule.weights))
        .map_err(|why| KitError::not_assembled(Law::Quadrature, why))?;
    let mut error: f64 = 0.0;
    for moment in rule.moments(dimension, degree) {
        if !moment.is_exact() {
            let message = format!(
                "the rule of family {} for degree {degree} in dimension {dimension} gives {:.16e} for the mean of the monomial with powers {:?} of barycentric coordinates, which is {:.16e}",
                family.name(),
                moment.found,
                moment.powers,
                moment.expected,
            );
            return Err(KitError::new(Law::Quadrature, KitErrorKind::RuleNotExact, message));
        }
        error = error.max(moment.deviation());
    }
    let smallest_weight = rule.weights.iter().copied().fold(f64::INFINITY, f64::min);
    Ok(QuadratureReport { points: rule.points.len(), smallest_weight, error })
}
