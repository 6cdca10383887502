//! Errors of quadrature rules.

/// Why there is no rule: the kind, and the sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum QuadratureError {
    /// A family has no rule of a degree.
    #[error("{0}")]
    NoRule(String),
    /// There is no simplex of a dimension.
    #[error("{0}")]
    Dimension(String),
    /// The numbers of points and weights differ, or there are none.
    #[error("{0}")]
    Lengths(String),
    /// A number of a rule is not finite, barycentric coordinates of a point do not sum to one, or
    /// entries beyond the dimension are not zero.
    #[error("{0}")]
    Point(String),
    /// The weights do not sum to one.
    #[error("{0}")]
    Weights(String),
}

impl QuadratureError {
    /// The error of a family without a rule of a degree in a dimension, whose rules go up to the degree `largest`.
    pub fn no_rule(family: &str, dimension: usize, degree: usize, largest: usize) -> Self {
        Self::NoRule(format!(
            "quadrature family {family} has no rule of degree {degree} in dimension {dimension}: ask for degree {largest} at most, or choose another family"
        ))
    }
}
