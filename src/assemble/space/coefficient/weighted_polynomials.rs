//! Polynomials on a cell, in a product that a coefficient weighs at the points of a rule.
//!
//! With `M` the matrix of the products `int_K alpha p q / |K|`, a functional `t` of the polynomials has the norm
//! `t^T M^-1 t`: the largest value of `t(p)^2` over `p^T M p`. The lift of a jump is such a functional, its energy that
//! norm; so is each moment of a flux through a facet, which the norm bounds by the energy in the cell.

use nalgebra::SMatrix;

use crate::assemble::trace::MAX_FLUX_MOMENTS;
use crate::quadrature::{OrthonormalPolynomials, Rule, facet_to_cell};

/// Most polynomials on a cell: those of degree three in space.
pub(crate) const MOST: usize = 20;

/// A functional of polynomials on a cell: its values at the orthonormal polynomials, then zeros.
pub(crate) type Functional = [f64; MOST];

/// By moment on facet `local`, up to a degree, its means with the orthonormal polynomials of the cell of that degree.
pub(crate) fn facet_moments(dimension: usize, degree: usize, local: usize) -> Vec<Functional> {
    let on_facet = OrthonormalPolynomials::new(dimension - 1, degree);
    let in_cell = OrthonormalPolynomials::new(dimension, degree);
    let rule = Rule::new(dimension - 1, 2 * degree);
    let mean = |m: usize, q: usize| {
        let term = |(point, w): (&[f64; 4], f64)| {
            w * on_facet.value(m, point) * in_cell.value(q, &facet_to_cell(point, local))
        };
        rule.iter().map(term).sum()
    };
    let moment = |m| std::array::from_fn(|q| if q < in_cell.len() { mean(m, q) } else { 0.0 });
    (0..on_facet.len()).map(moment).collect()
}

/// The orthonormal polynomials of a cell at the points of a rule.
pub(crate) struct WeightedPolynomials {
    /// How many there are up to each degree.
    counts: Vec<usize>,
    /// By point, the polynomials times the root of the weight.
    at_points: Vec<Functional>,
    /// By facet and moment on it of a degree below that of the polynomials, its means with them.
    moments: Vec<Vec<Functional>>,
}

impl WeightedPolynomials {
    /// Polynomials up to a degree above zero; the first twenty of them, which for elements of degree four in space are not
    /// all.
    pub fn new(dimension: usize, degree: usize, rule: &Rule) -> Self {
        let polynomials = OrthonormalPolynomials::new(dimension, degree);
        let n = polynomials.len().min(MOST);
        let count = |degree: usize| (0..n).filter(|&k| polynomials.degree(k) <= degree).count();
        let at = |(point, weight): (&[f64; 4], f64)| {
            let value = |k: usize| weight.sqrt() * polynomials.value(k, point);
            std::array::from_fn(|k| if k < n { value(k) } else { 0.0 })
        };
        Self {
            counts: (0..=degree).map(count).collect(),
            at_points: rule.iter().map(at).collect(),
            moments: (0..=dimension).map(|l| facet_moments(dimension, degree - 1, l)).collect(),
        }
    }
    /// The largest value of
    ///
    /// ```text
    /// sum_k phi_k(p)^2 / c_k  over  |alpha^1/2 p|^2
    /// ```
    ///
    /// among polynomials `p` of a degree below the largest, with `phi_k` the moments on facet `local` of a weight times
    /// `p`, of which `weighted` has the products with the moments of `p`, and `c_k` the energy of the lift of moment `k`:
    /// one where coefficient and weight are.
    pub fn largest_flux(
        &self,
        local: usize,
        values: &[f64],
        weighted: &dyn Fn(usize, usize) -> f64,
    ) -> f64 {
        let moments = &self.moments[local];
        let factor = self.factor(self.counts.len() - 2, values);
        let mut lifts = [[0.0; MOST]; MAX_FLUX_MOMENTS];
        for (k, lift) in lifts.iter_mut().enumerate().take(moments.len()) {
            let mut flux = [0.0; MOST];
            for (l, moment) in moments.iter().enumerate() {
                let share = weighted(k, l);
                flux.iter_mut().zip(moment).for_each(|(sum, m)| *sum += share * m);
            }
            let root = product(&moments[k], &moments[k]).sqrt();
            *lift = factor.solve(&flux).map(|x| x / root);
        }
        let of = |k: usize, l: usize| product(&lifts[k], &lifts[l]);
        let products = SMatrix::<f64, MAX_FLUX_MOMENTS, MAX_FLUX_MOMENTS>::from_fn(of);
        match products.trace() {
            trace if trace.is_finite() => products.symmetric_eigenvalues().max(),
            trace => trace,
        }
    }
    /// The factor of the products of all polynomials of a degree, weighted by values at the points of the rule.
    pub fn factor(&self, degree: usize, values: &[f64]) -> Factor {
        let n = self.counts[degree];
        let mut rows = [[0.0; MOST]; MOST];
        for (at, alpha) in self.at_points.iter().zip(values) {
            for (i, row) in rows.iter_mut().enumerate().take(n) {
                for (entry, other) in row.iter_mut().zip(at).take(i + 1) {
                    *entry += alpha * at[i] * other;
                }
            }
        }
        for i in 0..n {
            let (above, row) = rows.split_at_mut(i);
            let row = &mut row[0];
            // where the values differ by more than its reciprocal, rounding would leave no pivot
            let least = f64::EPSILON * row[i];
            for j in 0..i {
                row[j] = (row[j] - product(&row[..j], &above[j][..j])) / above[j][j];
            }
            row[i] = (row[i] - product(&row[..i], &row[..i])).max(least).sqrt();
        }
        Factor { n, rows }
    }
}

/// The Cholesky factor of weighted products of polynomials.
pub(crate) struct Factor {
    n: usize,
    rows: [Functional; MOST],
}

impl Factor {
    /// The numbers of a functional whose sum of squares is its norm.
    pub fn solve(&self, of: &Functional) -> Functional {
        let mut out = [0.0; MOST];
        for i in 0..self.n {
            let row = &self.rows[i];
            out[i] = (of[i] - product(&row[..i], &out[..i])) / row[i];
        }
        out
    }
}

/// The product of two rows of numbers.
pub(crate) fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
