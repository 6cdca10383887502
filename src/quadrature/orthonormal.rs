//! Orthonormal polynomials on simplices.

use super::exactness::monomials;
use super::rule::Rule;

/// Polynomials on the simplex of some dimension, sorted by degree and orthonormal in the inner product
/// `(p, q)` = mean of `p q`. The first polynomial is the constant one.
#[derive(Clone, Debug)]
pub(crate) struct OrthonormalPolynomials {
    /// Powers of the first barycentric coordinates, by degree.
    powers: Vec<[i32; 3]>,
    /// Row by row, the coefficients of the powers.
    coefficients: Vec<Vec<f64>>,
}

impl OrthonormalPolynomials {
    /// All polynomials up to this degree, by the Gram-Schmidt process.
    ///
    /// # Panics
    /// If there is no [`Rule`] of twice the degree.
    pub fn new(dimension: usize, degree: usize) -> Self {
        let powers = powers(dimension, degree);
        let rule = Rule::new(dimension, 2 * degree);
        let mean = |a: &[f64], b: &[f64]| -> f64 {
            let value = |row: &[f64], point| -> f64 {
                powers.iter().zip(row).map(|(p, c)| c * power(point, p)).sum()
            };
            rule.iter().map(|(point, w)| w * value(a, point) * value(b, point)).sum()
        };
        let mut coefficients: Vec<Vec<f64>> = Vec::new();
        for k in 0..powers.len() {
            let mut row = vec![0.0; powers.len()];
            row[k] = 1.0;
            // twice, so that rounding of the first pass does not stay
            for _ in 0..2 {
                for other in &coefficients {
                    let component = mean(&row, other);
                    row.iter_mut().zip(other).for_each(|(r, o)| *r -= component * o);
                }
            }
            let norm = mean(&row, &row).sqrt();
            coefficients.push(row.into_iter().map(|r| r / norm).collect());
        }
        Self { powers, coefficients }
    }
    /// Number of polynomials.
    pub fn len(&self) -> usize {
        self.powers.len()
    }
    /// The degree of polynomial `k`.
    pub fn degree(&self, k: usize) -> usize {
        self.powers[k].iter().sum::<i32>() as usize
    }
    /// Polynomial `k` at a point in barycentric coordinates.
    pub fn value(&self, k: usize, point: &[f64; 4]) -> f64 {
        self.powers.iter().zip(&self.coefficients[k]).map(|(p, c)| c * power(point, p)).sum()
    }
}

fn power(point: &[f64; 4], powers: &[i32; 3]) -> f64 {
    powers.iter().zip(point).map(|(&p, &x)| x.powi(p)).product()
}

/// The powers of `dimension` variables up to a degree, sorted by degree.
fn powers(dimension: usize, degree: usize) -> Vec<[i32; 3]> {
    let first =
        |all: Vec<usize>| std::array::from_fn(|k| if k < dimension { all[k] as i32 } else { 0 });
    let mut all: Vec<[i32; 3]> = monomials(dimension + 1, degree).into_iter().map(first).collect();
    all.sort_by_key(|p| (p.iter().sum::<i32>(), std::cmp::Reverse(*p)));
    all
}
