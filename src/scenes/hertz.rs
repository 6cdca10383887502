//! Contact with a parabola: a scalar version of the line contact of Hertz.

use nalgebra::Complex;

use super::halfplane;
use super::scene::Scene;
use crate::mesh::BoxDomain;
use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// Half width of the contact segment.
const A: f64 = 0.5;

/// Signorini problem without load on `(-1, 1) x (0, 1)` with the gap `g = -x^2/2`; contact on the
/// segment `|x| <= a = 1/2`.
///
/// With `w = x + iy` and the root `s = sqrt(w - a) sqrt(w + a)`, holomorphic in the upper half
/// plane, the solution is `u = Re F` with
///
/// ```text
/// F(w) = -w^2/2 + (w s - a^2 log((w + s)/a))/2,   F' = s - w,   grad u = (Re F', -Im F').
/// ```
///
/// *Equation*: `u` is harmonic, `f = 0`. *Contact* `y = 0`, `|x| <= a`: `s = i sqrt(a^2 - x^2)` is
/// imaginary and `|w + s| = a`, so `u = -x^2/2 = g` and `sigma = -du/dy = Im F' =
/// sqrt(a^2 - x^2) >= 0`, the pressure of Hertz. *Open part* `|x| > a`: `s` is real with the sign
/// of `x`, so `sigma = Im F' = 0`, and `(u - g)' = s` along the side, so `u - g` vanishes at
/// `|x| = a` and grows from there. *Continuity*: `F` and `F'` are continuous up to `y = 0`, since
/// `s` is, and `w + s` has no zero: `(w + s)(w - s) = a^2`. *Regularity*: `s` has square-root
/// branch points at `w = -a` and `w = a`, so `u` has two singularities of type `r^{3/2}` and lies
/// in `H^s` for `s < 5/2`.
pub fn hertz_2d() -> Scene<2> {
    let value = |x: &Point<2>| {
        let w = halfplane::point(x[0], x[1]);
        let s = root(w);
        // Only the modulus of w + s enters the real part, so the logarithm needs no branch.
        (-(w * w) / 2.0 + w * s / 2.0).re - A * A / 2.0 * ((w + s).norm() / A).ln()
    };
    let gradient = |x: &Point<2>| {
        let w = halfplane::point(x[0], x[1]);
        let derivative = root(w) - w;
        Point::<2>::new(derivative.re, -derivative.im)
    };
    let exact = Exact::new(value, gradient)
        .with_multiplier(|x| (A * A - x[0] * x[0]).max(0.0).sqrt())
        .with_contact(|x| A - x[0].abs(), vec![Point::from([-A, 0.0]), Point::from([A, 0.0])]);
    let problem =
        Problem::new().signorini(|x| -x[0] * x[0] / 2.0).obstacles_of_degree(2).solved_by(exact);
    Scene::new("hertz-2d", BoxDomain::above_contact(), problem)
        .summary("Signorini without load, parabolic gap, contact on a segment")
        .regularity(Regularity::new(2.5))
}

/// `sqrt(w - a) sqrt(w + a)`, continuous on the closed upper half plane; the square root of the
/// product `w^2 - a^2` would change its sign across the imaginary axis.
fn root(w: Complex<f64>) -> Complex<f64> {
    halfplane::square_root(w - A) * halfplane::square_root(w + A)
}
