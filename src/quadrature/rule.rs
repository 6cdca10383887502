//! Quadrature rules on simplices.

use super::error::QuadratureError;
use super::gauss::gauss_jacobi;

/// A quadrature rule on the simplex of some dimension.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rule {
    /// Barycentric coordinates of the points; `dimension + 1` of the four are used.
    pub points: Vec<[f64; 4]>,
    /// Weights that sum to one; positive in the rules of this library.
    pub weights: Vec<f64>,
}

impl Rule {
    /// A rule that is exact for polynomials of this degree.
    ///
    /// Degrees 0 and 1: the barycentre. Degree 2: `dimension + 1` points on the medians
    /// (P. C. Hammer, A. H. Stroud, MTAC 10 (1956), 137-139; the two-point Gauss rule in one
    /// dimension). Above: the conical product of Gauss-Jacobi rules, `ceil((degree + 1) / 2)`
    /// points in each direction (A. H. Stroud, Approximate Calculation of Multiple Integrals,
    /// 1971, section 2.5).
    ///
    /// # Panics
    /// If the dimension is above three or the degree above [`Rule::LARGEST_DEGREE`], for which
    /// [`ConicalProduct`](super::ConicalProduct) returns an error.
    pub fn new(dimension: usize, degree: usize) -> Self {
        Self::of_family("conical", dimension, degree).unwrap_or_else(|error| panic!("{error}"))
    }
    /// The largest degree of a rule, with fifty points in each direction: 125000 in space.
    pub const LARGEST_DEGREE: usize = 99;
    /// The rule of [`Rule::new`], as one of the family with this name.
    pub(super) fn of_family(
        family: &str,
        dimension: usize,
        degree: usize,
    ) -> Result<Self, QuadratureError> {
        let largest = Self::LARGEST_DEGREE;
        check_dimension(dimension)?;
        match (dimension, degree) {
            (0, _) | (_, 0 | 1) => Ok(Self::barycentre(dimension)),
            (_, 2) => Ok(Self::medians(dimension)),
            _ if degree <= largest => Ok(Self::conical(dimension, degree / 2 + 1)),
            _ => Err(QuadratureError::no_rule(family, dimension, degree, largest)),
        }
    }

    /// A rule of one's own on the simplex of this dimension.
    ///
    /// # Errors
    /// [`QuadratureError`] for a dimension above three, for numbers of points and weights that differ or are zero, for
    /// barycentric coordinates that do not sum to one or are not zero beyond the dimension, for a weight that is not
    /// finite, and for weights that do not sum to one.
    pub fn from_points(
        dimension: usize,
        points: Vec<[f64; 4]>,
        weights: Vec<f64>,
    ) -> Result<Self, QuadratureError> {
        check_dimension(dimension)?;
        let near_one = |sum: f64| (sum - 1.0).abs() < 1e-12;
        if points.len() != weights.len() || points.is_empty() {
            return Err(QuadratureError(format!(
                "{} points have {} weights: a rule has one weight for each point",
                points.len(),
                weights.len()
            )));
        }
        for (point, (&coordinates, &weight)) in points.iter().zip(&weights).enumerate() {
            let outside = coordinates.iter().skip(dimension + 1).any(|&x| x != 0.0);
            if outside || !near_one(coordinates.iter().sum()) || !weight.is_finite() {
                return Err(QuadratureError(format!(
                    "point {point} with weight {weight} and coordinates {coordinates:?} is none of a rule in dimension {dimension}: barycentric coordinates are finite and sum to one, entries beyond the dimension are zero, weights are finite"
                )));
            }
        }
        let sum: f64 = weights.iter().sum();
        if !near_one(sum) {
            let message = format!("the weights of a rule sum to {sum}: divide them by their sum");
            return Err(QuadratureError(message));
        }
        Ok(Self { points, weights })
    }

    fn barycentre(dimension: usize) -> Self {
        let mut point = [0.0; 4];
        point[..=dimension].fill(1.0 / (dimension + 1) as f64);
        Self { points: vec![point], weights: vec![1.0] }
    }

    /// The points `a e_i + b (1, ..., 1)` with `a = 1 / sqrt(dimension + 2)`.
    fn medians(dimension: usize) -> Self {
        let n = dimension + 1;
        let a = 1.0 / ((dimension + 2) as f64).sqrt();
        let b = (1.0 - a) / n as f64;
        let point = |i: usize| {
            let mut point = [0.0; 4];
            point[..n].fill(b);
            point[i] += a;
            point
        };
        Self { points: (0..n).map(point).collect(), weights: vec![1.0 / n as f64; n] }
    }

    /// The conical product: collapsed coordinates, with a Gauss-Jacobi rule in each of them.
    fn conical(dimension: usize, points_per_direction: usize) -> Self {
        let mut rule = Self { points: vec![[1.0, 0.0, 0.0, 0.0]], weights: vec![1.0] };
        for d in 1..=dimension {
            // the simplex of dimension d is a cone over the one of dimension d - 1
            let (nodes, weights) = gauss_jacobi(points_per_direction, d - 1);
            let mut cone = Self { points: Vec::new(), weights: Vec::new() };
            for (point, weight) in rule.points.iter().zip(&rule.weights) {
                for (t, w) in nodes.iter().zip(&weights) {
                    let mut p = point.map(|b| b * (1.0 - t));
                    p[d] = *t;
                    cone.points.push(p);
                    cone.weights.push(weight * w);
                }
            }
            rule = cone;
        }
        rule
    }

    /// Points with their weights.
    pub fn iter(&self) -> impl Iterator<Item = (&[f64; 4], f64)> {
        self.points.iter().zip(self.weights.iter().copied())
    }
}

/// Refuses a dimension that no simplex has.
pub(super) fn check_dimension(dimension: usize) -> Result<(), QuadratureError> {
    match dimension {
        0..=3 => Ok(()),
        _ => Err(QuadratureError(format!(
            "there are no rules in dimension {dimension}: simplices have the dimensions 0 to 3"
        ))),
    }
}

/// The barycentric coordinates of vertex `k` of a simplex.
pub(crate) fn vertex_point(k: usize) -> [f64; 4] {
    let mut point = [0.0; 4];
    point[k] = 1.0;
    point
}

/// The barycentric coordinates in a cell of a point of the facet opposite vertex `local`, from its
/// barycentric coordinates in the facet.
#[inline(always)]
pub(crate) fn facet_to_cell(facet_point: &[f64; 4], local: usize) -> [f64; 4] {
    std::array::from_fn(|k| match k.cmp(&local) {
        std::cmp::Ordering::Less => facet_point[k],
        std::cmp::Ordering::Equal => 0.0,
        std::cmp::Ordering::Greater => facet_point[k - 1],
    })
}
