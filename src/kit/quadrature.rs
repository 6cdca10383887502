//! The law of a family of quadrature rules.

use super::element::within;
use super::error::{KitError, Law};
use super::report::QuadratureReport;
use crate::error::Error;
use crate::quadrature::{Quadrature, Rule};

/// Largest deviation from the mean of a monomial, relative to the mean.
const TOLERANCE: f64 = 1e-12;

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
    let Rule { points, weights } = family
        .rule(dimension, degree)
        .and_then(|rule| Rule::from_points(dimension, rule.points, rule.weights))
        .map_err(|why| KitError::NotAssembled { law: Law::Quadrature, why: Error::from(why) })?;
    let mut error: f64 = 0.0;
    // monomials in all barycentric coordinates, of the degree itself, span the polynomials up to it
    for powers in powers(dimension + 1, degree) {
        let value = |x: &[f64; 4]| -> f64 {
            x.iter().zip(&powers).map(|(x, &p)| x.powi(p as i32)).product()
        };
        let found: f64 = points.iter().zip(&weights).map(|(x, w)| w * value(x)).sum();
        let expected = mean(dimension, &powers);
        let difference = (found / expected - 1.0).abs();
        if !within(difference, TOLERANCE) {
            let family = family.name().to_owned();
            return Err(KitError::RuleNotExact {
                family,
                dimension,
                degree,
                powers,
                found,
                expected,
            });
        }
        error = error.max(difference);
    }
    let smallest_weight = weights.iter().copied().fold(f64::INFINITY, f64::min);
    Ok(QuadratureReport { points: points.len(), smallest_weight, error })
}

/// The powers of monomials of a degree in some variables.
fn powers(variables: usize, degree: usize) -> Vec<Vec<usize>> {
    if variables == 1 {
        return vec![vec![degree]];
    }
    let with_first = |first: usize| {
        powers(variables - 1, degree - first)
            .into_iter()
            .map(move |rest| [vec![first], rest].concat())
    };
    (0..=degree).flat_map(with_first).collect()
}

/// The mean of a monomial over the simplex: `d! p_0! ... p_d! / (d + p_0 + ... + p_d)!`.
fn mean(dimension: usize, powers: &[usize]) -> f64 {
    let mut factor = dimension;
    let mut mean = 1.0;
    for k in powers.iter().flat_map(|&power| 1..=power) {
        factor += 1;
        mean *= k as f64 / factor as f64;
    }
    mean
}
