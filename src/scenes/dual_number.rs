//! Forward differentiation: sums and products of functions at a point, with their gradients and
//! Laplacians.

use std::ops::{Add, Mul, Sub};

use super::halfplane;
use crate::real::Point;

/// Value, gradient and Laplacian of a function at a point: a dual number of second order, of whose
/// second derivatives only the trace is kept.
///
/// `grad (f g) = g grad f + f grad g`,
/// `Laplace (f g) = g Laplace f + 2 grad f . grad g + f Laplace g`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DualNumber<const D: usize> {
    pub value: f64,
    pub gradient: Point<D>,
    pub laplacian: f64,
}

impl<const D: usize> DualNumber<D> {
    /// A function of the coordinate `axis`, from its value and its first two derivatives.
    pub fn along(axis: usize, [value, first, second]: [f64; 3]) -> Self {
        let gradient = Point::from_fn(|k, _| if k == axis { first } else { 0.0 });
        Self { value, gradient, laplacian: second }
    }
    /// `prod_k (1 - x_k^2)`, which vanishes on the boundary of `(-1, 1)^D`.
    pub fn bubble(x: &Point<D>) -> Self {
        (0..D)
            .map(|k| Self::along(k, [1.0 - x[k] * x[k], -2.0 * x[k], -2.0]))
            .fold(Self::along(0, [1.0, 0.0, 0.0]), |product, factor| product * factor)
    }
    /// `sign (r^2 - square)`, where `r` is the distance from the origin.
    pub fn from_sphere(x: &Point<D>, square: f64, sign: f64) -> Self {
        let value = sign * (x.norm_squared() - square);
        Self { value, gradient: x * (2.0 * sign), laplacian: 2.0 * sign * D as f64 }
    }
    /// `max(s, 0)^k` of the function `s`; `k >= 2`.
    pub fn positive_power(self, k: i32) -> Self {
        let [value, first, second] = positive_power(self.value, k);
        let laplacian = second * self.gradient.norm_squared() + first * self.laplacian;
        Self { value, gradient: self.gradient * first, laplacian }
    }
    /// The harmonic `Re (s (x - c) + iy)^{3/2}` for the first coordinate `x` and the last one `y`;
    /// `s` is `facing`, 1 for a function that vanishes on `y = 0`, `x < c` and -1 for its mirror
    /// image.
    ///
    /// For holomorphic `F` the gradient of `Re F` is `(Re F', -Im F')`, and `F' = (3/2) z^(1/2)` stays
    /// finite at the tip `z = 0`.
    pub fn three_halves(x: &Point<D>, c: f64, facing: f64) -> Self {
        let z = halfplane::point(facing * (x[0] - c), x[D - 1]);
        let root = halfplane::square_root(z);
        let mut gradient = Point::zeros();
        gradient[0] = facing * (1.5 * root.re);
        gradient[D - 1] = -1.5 * root.im;
        Self { value: (z * root).re, gradient, laplacian: 0.0 }
    }
}

impl<const D: usize> Add for DualNumber<D> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            gradient: self.gradient + other.gradient,
            laplacian: self.laplacian + other.laplacian,
        }
    }
}

impl<const D: usize> Sub for DualNumber<D> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + other * Self::along(0, [-1.0, 0.0, 0.0])
    }
}

impl<const D: usize> Mul for DualNumber<D> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            gradient: self.gradient * other.value + other.gradient * self.value,
            laplacian: self.laplacian * other.value
                + 2.0 * self.gradient.dot(&other.gradient)
                + other.laplacian * self.value,
        }
    }
}

/// `max(s, 0)^k` and its first two derivatives, each zero for `s <= 0`; `k >= 2`.
pub(crate) fn positive_power(s: f64, k: i32) -> [f64; 3] {
    if s <= 0.0 {
        return [0.0; 3];
    }
    let order = f64::from(k);
    [s.powi(k), order * s.powi(k - 1), order * (order - 1.0) * s.powi(k - 2)]
}
