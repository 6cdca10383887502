//! The error of a linear function in a cell where it is smooth, without a rule.
//!
//! The exact solution `u` is replaced by the cubic that has its values and gradients at the vertices, its value at the
//! barycentre and, in space, its gradient there. Cells share vertices, so that each cell asks for `u` about once.
//! With `p_ij = p_ji`, `r_ij = -r_ji` and barycentric coordinates `l_i` the difference of any linear function and the
//! cubic is
//!
//! ```text
//! sum_i e_i l_i + sum_(i<j) l_i l_j (p_ij + (l_i - l_j) r_ij) + sum_k c_k (product of all l_i but l_k)
//! ```
//!
//! with `e_i` its values at the vertices: in the plane `l_3` counts as one and `k` is 3. Only the `e_i` depend on the
//! linear function. The gradient is `sum_i g_i l_i + sum_(i<j) d_ij l_i l_j` with its values `g_i` at the vertices.
//! Squares are integrated by the mean of `l^a` over a cell, `d! a! / (d + |a|)!`. They are exact for cubics, so that
//! what they leave is a small part of `s^2`, `s` the diameter over the length over which derivatives of `u` change.

use crate::real::Point;

/// The difference of a linear function and the cubic, but for the linear function.
pub(super) struct Cubic<const D: usize> {
    /// By vertex the sums of `p_ij` and of `r_ij` at it.
    p_at: [f64; 4],
    r_at: [f64; 4],
    /// The sum of all `p_ij`.
    p: f64,
    c: [f64; 4],
    /// The mean of the square of what is not linear.
    square: f64,
    /// By vertex the sum of `d_ij` at it, and the sum of all.
    d_at: [Point<D>; 4],
    d: Point<D>,
    /// The mean of the square of the gradient less its linear interpolant.
    gradient_square: f64,
    /// The mean of the square of the gradient less its projection to linear functions.
    rest: f64,
}

/// The mean over a cell of the product of `n` barycentric coordinates, all different: `d! / (d + n)!`.
const fn mean_of_product(dimension: usize, n: usize) -> f64 {
    let (mut product, mut k) = (1.0, 1);
    while k <= n {
        product /= (dimension + k) as f64;
        k += 1;
    }
    product
}

impl<const D: usize> Cubic<D> {
    const TWO: f64 = mean_of_product(D, 2);
    const THREE: f64 = mean_of_product(D, 3);
    const FOUR: f64 = mean_of_product(D, 4);
    const FIVE: f64 = mean_of_product(D, 5);
    const SIX: f64 = mean_of_product(D, 6);

    /// The cubic with these values and gradients at these corners, and with a value and a gradient at the barycentre; that
    /// gradient counts in space. The gradients of barycentric coordinates are zero beyond those of the cell.
    pub fn new(
        corners: &[Point<D>; 4],
        coordinates: &[Point<D>; 4],
        (values, gradients): (&[f64; 4], &[Point<D>; 4]),
        (value, gradient): (f64, Point<D>),
    ) -> Self {
        let n = (D + 1) as f64;
        let (mut p_at, mut r_at, mut r) = ([0.0; 4], [0.0; 4], [[0.0; 4]; 4]);
        let (mut p, mut p_squares, mut r_squares) = (0.0, 0.0, 0.0);
        for i in 0..=D {
            for j in i + 1..=D {
                let (edge, rise) = (corners[j] - corners[i], values[j] - values[i]);
                let [from, to] = [rise - gradients[i].dot(&edge), gradients[j].dot(&edge) - rise];
                let (of_p, of_r) = (0.5 * (from + to), 0.5 * (from - to));
                (p_at[i], p_at[j], p) = (p_at[i] + of_p, p_at[j] + of_p, p + of_p);
                (r_at[i], r_at[j]) = (r_at[i] + of_r, r_at[j] - of_r);
                (r[i][j], r[j][i]) = (of_r, -of_r);
                p_squares += of_p * of_p;
                r_squares += of_r * of_r;
            }
        }
        let mean = values[..=D].iter().sum::<f64>() / n;
        let c_sum = n * (n * n * (mean - value) - p);
        let mut c = [0.0; 4];
        if D == 3 {
            let middle = (corners[0] + corners[1] + corners[2] + corners[3]) * 0.25;
            for i in 0..4 {
                let slope = gradient.dot(&(corners[i] - middle));
                c[i] = 16.0 * (slope - values[i]) + 4.0 * p_at[i] + r_at[i];
            }
            let change = (c_sum - c.iter().sum::<f64>()) * 0.25;
            c.iter_mut().for_each(|c| *c += change);
        } else {
            c[3] = c_sum;
        }
        let mut of_p = p * p + p_squares;
        let (mut of_both, mut of_r, mut of_c) = (0.0, r_squares, c_sum * c_sum);
        for k in 0..4 {
            of_p += p_at[k] * p_at[k];
            of_both += p_at[k] * r_at[k] + c[k] * (2.0 * p - p_at[k]);
            of_r += r_at[k] * r_at[k];
            of_c += c[k] * (c[k] - r_at[k]);
        }
        let of_cubics = 8.0 * of_r + 4.0 * of_c;
        let square = Self::FOUR * of_p + 4.0 * Self::FIVE * of_both + Self::SIX * of_cubics;
        let mut cubic = Self {
            p_at,
            r_at,
            p,
            c,
            square,
            d_at: [Point::zeros(); 4],
            d: Point::zeros(),
            gradient_square: 0.0,
            rest: 0.0,
        };
        cubic.set_gradient(&r, coordinates);
        cubic
    }

    /// Sets the sums of the `d_ij`, and the squares of the gradient.
    fn set_gradient(&mut self, r: &[[f64; 4]; 4], coordinates: &[Point<D>; 4]) {
        let mut squares = 0.0;
        for i in 0..=D {
            for j in i + 1..=D {
                // the two other numbers, and for each the one that is left
                let [k, l] = OTHERS[i][j];
                let mut d = (coordinates[i] - coordinates[j]) * (3.0 * r[i][j]);
                d += coordinates[k] * (self.c[l] - r[i][k] - r[j][k]);
                d += coordinates[l] * (self.c[k] - r[i][l] - r[j][l]);
                self.d_at[i] += d;
                self.d_at[j] += d;
                self.d += d;
                squares += d.norm_squared();
            }
        }
        let of_sum = self.d.norm_squared();
        let of_vertices: f64 = self.d_at.iter().map(|d| d.norm_squared()).sum();
        self.gradient_square = Self::FOUR * (of_sum + of_vertices + squares);
        // the moments with barycentric coordinates are THREE (d + d_at)
        let moments: f64 = self.d_at[..=D].iter().map(|d| (self.d + d).norm_squared()).sum::<f64>();
        let of_moments = Self::THREE * Self::THREE * moments / Self::TWO;
        self.rest = self.gradient_square - of_moments + Self::TWO * of_sum / (D + 2) as f64;
    }

    /// The means of the squares of the difference and of its gradient, by its values and gradients at the vertices, and
    /// the share of the gradient that is not linear; zero without a gradient.
    pub fn squares(&self, values: &[f64; 4], gradients: &[Point<D>; 4]) -> ([f64; 2], f64) {
        let sum: f64 = values.iter().sum();
        let (mut linear, mut with_p, mut with_cubic) = (sum * sum, sum * self.p, 0.0);
        for k in 0..4 {
            linear += values[k] * values[k];
            with_p += values[k] * self.p_at[k];
            with_cubic += 2.0 * values[k] * self.r_at[k] + self.c[k] * (2.0 * sum - values[k]);
        }
        let value = Self::TWO * linear
            + 2.0 * (Self::THREE * with_p + Self::FOUR * with_cubic)
            + self.square;
        let sum: Point<D> = gradients[..=D].iter().sum();
        let (mut linear, mut with_d) = (sum.norm_squared(), sum.dot(&self.d));
        for (gradient, d) in gradients.iter().zip(&self.d_at).take(D + 1) {
            linear += gradient.norm_squared();
            with_d += gradient.dot(d);
        }
        let gradient = Self::TWO * linear + 2.0 * Self::THREE * with_d + self.gradient_square;
        // both are positive but for rounding; where the solution is not finite they are no numbers
        let positive = |square: f64| if square < 0.0 { 0.0 } else { square };
        let share = if gradient > 0.0 { self.rest / gradient } else { 0.0 };
        ([positive(value), positive(gradient)], share)
    }
}

/// For two numbers below four the two others.
const OTHERS: [[[usize; 2]; 4]; 4] = [
    [[0; 2], [2, 3], [1, 3], [1, 2]],
    [[2, 3], [0; 2], [0, 3], [0, 2]],
    [[1, 3], [0, 3], [0; 2], [0, 1]],
    [[1, 2], [0, 2], [0, 1], [0; 2]],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assemble::cut_simplices::in_space;
    use crate::mesh::CellGeometry;
    use crate::quadrature::{OrthonormalPolynomials, Rule};

    /// Squares and share of the difference of a linear function and a cubic, and by a rule.
    fn check<const D: usize>(corners: [[f64; 3]; 4]) {
        let corners = corners.map(|x| Point::<D>::from_fn(|k, _| x[k]));
        let geometry = CellGeometry::new(|k| corners[k]);
        let mut coordinates = [Point::zeros(); 4];
        (0..=D).for_each(|k| coordinates[k] = *geometry.gradient(k));
        let last = |x: &Point<D>| x[D - 1];
        let value = |x: &Point<D>| {
            x[0] * x[0] * last(x) - 2.0 * last(x).powi(3) + x[0] * x[1] - 0.7 * x[0] + 0.3
        };
        let gradient = |x: &Point<D>| {
            let mut gradient = Point::zeros();
            gradient[0] = 2.0 * x[0] * last(x) + x[1] - 0.7;
            gradient[1] += x[0];
            gradient[D - 1] += x[0] * x[0] - 6.0 * last(x).powi(2);
            gradient
        };
        let slope = Point::<D>::from_fn(|k, _| 0.4 - k as f64);
        let linear = |x: &Point<D>| slope.dot(x) + 0.1;
        let middle = corners[..=D].iter().sum::<Point<D>>() / (D + 1) as f64;
        let at_corners = (corners.map(|x| value(&x)), corners.map(|x| gradient(&x)));
        let cubic = Cubic::new(
            &corners,
            &coordinates,
            (&at_corners.0, &at_corners.1),
            (value(&middle), gradient(&middle)),
        );
        let (mut values, mut gradients) = ([0.0; 4], [Point::zeros(); 4]);
        for k in 0..=D {
            values[k] = linear(&corners[k]) - at_corners.0[k];
            gradients[k] = slope - at_corners.1[k];
        }
        let ([of_value, of_gradient], share) = cubic.squares(&values, &gradients);
        let polynomials = OrthonormalPolynomials::new(D, 1);
        let (mut sums, mut moments) = ([0.0; 2], vec![Point::<D>::zeros(); polynomials.len()]);
        for (point, weight) in Rule::new(D, 6).iter() {
            let x = in_space(point, &corners);
            let difference = slope - gradient(&x);
            sums[0] += weight * (linear(&x) - value(&x)).powi(2);
            sums[1] += weight * difference.norm_squared();
            for (k, moment) in moments.iter_mut().enumerate() {
                *moment += difference * (weight * polynomials.value(k, point));
            }
        }
        let projected: f64 = moments.iter().map(|m| m.norm_squared()).sum();
        assert!((of_value / sums[0] - 1.0).abs() < 1e-12, "{of_value} {}", sums[0]);
        assert!((of_gradient / sums[1] - 1.0).abs() < 1e-12, "{of_gradient} {}", sums[1]);
        let exact_share = 1.0 - projected / sums[1];
        assert!(exact_share > 1e-3 && (share - exact_share).abs() < 1e-12, "{share}");
    }

    /// As at the corner of a domain with a singular solution.
    #[test]
    fn a_gradient_that_is_no_number_leaves_no_squares() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]].map(Point::<2>::from);
        let coordinates = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]].map(Point::<2>::from);
        let mut gradients = [Point::zeros(); 4];
        gradients[0][0] = f64::NAN;
        let at_corners = (&[0.0; 4], &gradients);
        let cubic = Cubic::new(&corners, &coordinates, at_corners, (0.1, Point::zeros()));
        let (squares, _) = cubic.squares(&[0.0; 4], &gradients);
        assert!(squares.iter().all(|square| square.is_nan()), "{squares:?}");
    }

    #[test]
    fn squares_of_cubics_are_exact() {
        check::<2>([[0.1, 0.2, 0.0], [1.3, 0.1, 0.0], [0.4, 1.1, 0.0], [0.0; 3]]);
        check::<3>([[0.1, 0.2, 0.3], [1.3, 0.1, -0.2], [0.4, 1.1, 0.1], [0.2, 0.1, 1.5]]);
    }
}
