//! Signorini conditions with homogeneous Dirichlet data: the singularity `r^{3/2}` under a
//! polynomial.

use std::f64::consts::SQRT_2;

use super::dual_number::DualNumber;
use super::free_boundary;
use super::scene::{Scene, zero_gap};
use crate::mesh::BoxDomain;
use crate::problem::Exact;
use crate::real::Point;
use crate::scheme::Regularity;

/// Signorini problem with zero Dirichlet data and zero gap on `(-1, 1) x (0, 1)`; contact changes
/// at the origin, a vertex of every mesh with an even number of cells along the contact side.
///
/// This is the problem class of Zeng, Chen and Wang, *Comput. Math. Appl.* 69 (2015); the solution
/// is derived at `transition_at`.
pub fn signorini_2d() -> Scene<2> {
    transition_at(0.0, "signorini-2d", "Signorini, zero Dirichlet data, contact changes at x = 0")
}

/// [`signorini_2d`] with the change of contact at `x = 0.3`, which is a vertex of few meshes.
pub fn signorini_shifted_2d() -> Scene<2> {
    let summary = "Signorini, zero Dirichlet data, contact changes at x = 0.3";
    transition_at(0.3, "signorini-shifted-2d", summary)
}

/// [`signorini_2d`] with the change of contact at `x = sqrt(2)/10`, which is a vertex of no mesh.
pub fn signorini_irrational_2d() -> Scene<2> {
    let summary = "Signorini, zero Dirichlet data, contact changes at x = sqrt(2)/10";
    transition_at(SQRT_2 / 10.0, "signorini-irrational-2d", summary)
}

/// [`signorini_2d`] in space, on `(-1, 1)^2 x (0, 1)`; contact changes along the line `x = 1/5`.
pub fn signorini_line_3d() -> Scene<3> {
    let summary = "Signorini in space, zero Dirichlet data, contact changes along x = 0.2";
    transition_at(0.2, "signorini-line-3d", summary)
}

/// The Signorini problem whose contact changes where the first coordinate is `c`, `-1 < c < 1`.
///
/// Let `x` be the first and `y` the last coordinate. With the harmonic
/// `w = Re (x - c + iy)^{3/2}` and `q = prod_k (1 - x_k^2)` the solution is `u = q w`, with load
/// `f = -Laplace u = -(w Laplace q + 2 grad q . grad w)`, bounded.
///
/// *Dirichlet sides*: `q = 0`. *Contact side*: there `dq/dy = 0` and `q >= 0`, so `u = q w` and
/// `sigma = -du/dy = -q dw/dy`. For `x > c`: `w = (x - c)^{3/2} > 0` and `dw/dy = 0`, the open
/// part. For `x < c`: `w = 0` and `-dw/dy = (3/2)(c - x)^{1/2} > 0`, contact. So `u >= 0`,
/// `sigma >= 0` and `u sigma = 0`. *Regularity*: `r^{3/2}` lies in `H^s` for `s < 5/2`, the best
/// that a change of contact generically admits.
fn transition_at<const D: usize>(c: f64, name: &str, summary: &'static str) -> Scene<D> {
    let solution = move |x: &Point<D>| DualNumber::bubble(x) * DualNumber::three_halves(x, c, 1.0);
    let exact = Exact::new(move |x| solution(x).value, move |x| solution(x).gradient)
        .with_multiplier(move |x| 1.5 * DualNumber::bubble(x).value * (c - x[0]).max(0.0).sqrt())
        .with_contact(move |x| c - x[0], free_boundary::transition_at(c));
    let problem = zero_gap().source(move |x| -solution(x).laplacian).solved_by(exact);
    Scene::new(name, BoxDomain::above_contact(), problem)
        .summary(summary)
        .regularity(Regularity::new(2.5))
}

/// Ends of the contact segment of [`signorini_two_2d`].
const LEFT: f64 = -0.4;
const RIGHT: f64 = 0.5;

/// Half of the width of the step between the two halves of [`signorini_two_2d`], at whose ends the load
/// has kinks.
const STEP: f64 = 0.2;

/// Two changes of contact: a segment `[-2/5, 1/2]` in contact, zero Dirichlet data, zero gap.
///
/// With `uR = Re (x - 1/2 + iy)^{3/2}`, open to the right of 1/2, `uL = Re (-2/5 - x + iy)^{3/2}`,
/// open to the left of -2/5, and a polynomial step `s(x)` that rises from 0 to 1 between -1/5 and
/// 1/5, the solution is `u = (1 - x^2)(1 - y^2)((1 - s) uL + s uR)`; the load is `-Laplace u`.
///
/// *Contact side*: where `s` is neither 0 nor 1 both `uL` and `uR` vanish, so `u = 0` and `sigma` is a
/// convex combination of their pressures; elsewhere the argument of [`signorini_2d`] applies.
/// `H^s` for `s < 5/2`.
pub fn signorini_two_2d() -> Scene<2> {
    let solution = |x: &Point<2>| {
        let left = DualNumber::three_halves(x, LEFT, -1.0);
        let right = DualNumber::three_halves(x, RIGHT, 1.0);
        DualNumber::bubble(x) * (left + DualNumber::along(0, step(x[0])) * (right - left))
    };
    let pressure = |x: &Point<2>| {
        let [s, _, _] = step(x[0]);
        let (left, right) = ((x[0] - LEFT).max(0.0).sqrt(), (RIGHT - x[0]).max(0.0).sqrt());
        1.5 * (1.0 - x[0] * x[0]) * ((1.0 - s) * left + s * right)
    };
    let exact = Exact::new(move |x| solution(x).value, move |x| solution(x).gradient)
        .with_multiplier(pressure)
        .with_contact(
            |x| (x[0] - LEFT).min(RIGHT - x[0]),
            vec![Point::from([LEFT, 0.0]), Point::from([RIGHT, 0.0])],
        );
    let problem = zero_gap()
        .piecewise_source(move |x| -solution(x).laplacian, |x| x[0].abs() - STEP)
        .solved_by(exact);
    Scene::new("signorini-two-2d", BoxDomain::above_contact(), problem)
        .summary("Signorini, zero Dirichlet data, contact on a segment: two singularities")
        .regularity(Regularity::new(2.5))
}

/// `10 t^3 - 15 t^4 + 6 t^5` for `t` from 0 to 1 as `x` goes from -1/5 to 1/5, and its first two
/// derivatives.
fn step(x: f64) -> [f64; 3] {
    let t = ((x + STEP) / 0.4).clamp(0.0, 1.0);
    let s = 1.0 - t;
    let value = t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
    [value, 30.0 * t * t * s * s / 0.4, 60.0 * t * s * (1.0 - 2.0 * t) / 0.16]
}
