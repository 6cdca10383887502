//! Errors of quadrature rules.

/// Why there is no rule.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QuadratureError {
    /// A family has no rule of a degree.
    #[error(
        "quadrature family {family} has no rule of degree {degree} in dimension {dimension}: ask for degree {largest} at most, or choose another family"
    )]
    NoRule {
        /// Name of the family.
        family: String,
        /// Dimension of the simplex.
        dimension: usize,
        /// The degree asked for.
        degree: usize,
        /// The largest degree of a rule that the family has in this dimension.
        largest: usize,
    },
    /// There is no simplex of a dimension.
    #[error("there are no rules in dimension {dimension}: simplices have the dimensions 0 to 3")]
    Dimension {
        /// The dimension asked for.
        dimension: usize,
    },
    /// The numbers of points and weights differ, or there are none.
    #[error("{points} points have {weights} weights: a rule has one weight for each point")]
    Lengths {
        /// Number of points.
        points: usize,
        /// Number of weights.
        weights: usize,
    },
    /// A number of a rule is not finite, barycentric coordinates of a point do not sum to one, or
    /// entries beyond the dimension are not zero.
    #[error(
        "point {point} with weight {weight} and coordinates {coordinates:?} is none of a rule in dimension {dimension}: barycentric coordinates are finite and sum to one, entries beyond the dimension are zero, weights are finite"
    )]
    Point {
        /// Number of the point.
        point: usize,
        /// Its coordinates.
        coordinates: [f64; 4],
        /// Its weight.
        weight: f64,
        /// Dimension of the simplex.
        dimension: usize,
    },
    /// The weights do not sum to one.
    #[error("the weights of a rule sum to {sum}: divide them by their sum")]
    Weights {
        /// Their sum.
        sum: f64,
    },
}
