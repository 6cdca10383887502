//! Errors of quadrature rules.

/// Why there is no rule: a family has none of a degree, or numbers are those of none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct QuadratureError(pub(super) String);

impl QuadratureError {
    /// The error of a family without a rule of a degree in a dimension, whose rules go up to the degree `largest`.
    pub fn no_rule(family: &str, dimension: usize, degree: usize, largest: usize) -> Self {
        Self(format!(
            "quadrature family {family} has no rule of degree {degree} in dimension {dimension}: ask for degree {largest} at most, or choose another family"
        ))
    }
}
