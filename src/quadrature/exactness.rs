//! For which polynomials rules are exact.

use super::rule::Rule;

/// Largest deviation of a rule that is exact from the mean of a monomial, relative to the mean.
const TOLERANCE: f64 = 1e-12;

/// A monomial in barycentric coordinates, and its mean over the simplex.
pub(crate) struct Moment {
    #[cfg_attr(not(feature = "kit"), allow(dead_code))]
    pub powers: Vec<usize>,
    /// The mean by the rule.
    pub found: f64,
    /// The mean.
    pub expected: f64,
}

impl Moment {
    /// The relative deviation.
    pub fn deviation(&self) -> f64 {
        (self.found / self.expected - 1.0).abs()
    }
    /// Whether both means are equal but for rounding.
    pub fn is_exact(&self) -> bool {
        self.deviation() <= TOLERANCE
    }
}

impl Rule {
    /// The means of all monomials in all barycentric coordinates of a degree: they span the polynomials up to that
    /// degree.
    pub(crate) fn moments(&self, dimension: usize, degree: usize) -> impl Iterator<Item = Moment> {
        monomials(dimension + 1, degree).into_iter().map(move |powers| {
            let value = |x: &[f64; 4]| -> f64 {
                x.iter().zip(&powers).map(|(x, &p)| x.powi(p as i32)).product()
            };
            let found = self.points.iter().zip(&self.weights).map(|(x, w)| w * value(x)).sum();
            let expected = mean(dimension, &powers);
            Moment { powers, found, expected }
        })
    }
}

/// The powers of monomials of a degree in some variables.
pub(super) fn monomials(variables: usize, degree: usize) -> Vec<Vec<usize>> {
    if variables == 1 {
        return vec![vec![degree]];
    }
    let with_first = |first: usize| {
        monomials(variables - 1, degree - first)
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
