//! The law of a family of quadrature rules.

use super::error::{Fault, KitError, KitErrorKind, Law};
use super::report::LawReport;
use crate::quadrature::{Quadrature, Rule};

/// Tests [`Law::Quadrature`] for a family of rules in a dimension.
///
/// # Errors
/// [`KitErrorKind::RuleNotExact`]; [`KitErrorKind::NotAssembled`] if the family has no such rule, or it is
/// none.
pub fn check_quadrature(
    family: &dyn Quadrature,
    dimension: usize,
    degree: usize,
) -> Result<LawReport, KitError> {
    Law::Quadrature.named(check(family, dimension, degree))
}

fn check(family: &dyn Quadrature, dimension: usize, degree: usize) -> Result<LawReport, Fault> {
    let rule = family
        .rule(dimension, degree)
        .and_then(|rule| Rule::from_points(dimension, rule.points, rule.weights))?;
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
            return Err(Fault::new(KitErrorKind::RuleNotExact, message));
        }
        error = error.max(moment.deviation());
    }
    let smallest_weight = rule.weights.iter().copied().fold(f64::INFINITY, f64::min);
    let points = rule.points.len();
    let sentence =
        format!("{points} points, smallest weight {smallest_weight:.1e}, error {error:.1e}");
    let figures =
        [("points", points as f64), ("smallest weight", smallest_weight), ("error", error)];
    Ok(LawReport::new(Law::Quadrature, sentence, &figures))
}
