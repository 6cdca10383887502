//! A membrane over a cone.

use std::f64::consts::LN_2;

use super::free_boundary;
use super::scene::Scene;
use crate::mesh::BoxDomain;
use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// Radius of the contact ball.
const A: f64 = 0.5;

/// A membrane without load on `(-1, 1)^D`, `D` = 2 or 3, over the cone `psi = 1 - r`; contact in
/// the ball `r <= a = 1/2`.
///
/// The solution is `psi` on contact and beyond `a ln(a/r) + 1/2` (2D) or `1/(4r)` (3D). *Off
/// contact*: `u` is harmonic. *Across `r = a`*: the value is 1/2 and the slope -1 on both sides.
/// *On contact*: the multiplier is `-Laplace psi = (D - 1)/r > 0`. It is unbounded; in 2D it is not
/// even square integrable, and `u` lies in `H^s` for `s < 2` (2D), `s < 5/2` (3D). *Above the
/// obstacle*: `u` is convex along rays, so above its tangent, which is `psi`.
pub fn cone<const D: usize>() -> Scene<D> {
    const { assert!(D == 2 || D == 3, "the solution is known in two and three dimensions") };
    let value = |x: &Point<D>| match x.norm() {
        r if r <= A => 1.0 - r,
        r if D == 2 => -A * r.ln() + A * (1.0 - LN_2),
        r => A * A / r,
    };
    let gradient = |x: &Point<D>| match x.norm() {
        0.0 => Point::zeros(),
        r if r <= A => -x / r,
        r => -x * (A / r).powi(D as i32 - 1) / r,
    };
    let multiplier = |x: &Point<D>| {
        let r = x.norm();
        if r <= A { (D as f64 - 1.0) / r } else { 0.0 }
    };
    let problem = Problem::new().obstacle_below(|x: &Point<D>| 1.0 - x.norm()).solved_by(
        Exact::new(value, gradient)
            .with_multiplier(multiplier)
            .with_contact(|x| A - x.norm(), free_boundary::sphere(A, 2.0)),
    );
    Scene::new(format!("cone-{D}d"), BoxDomain::centred(1.0), problem)
        .summary("no load, the obstacle is a cone; unbounded force at its apex")
        .regularity(Regularity::new(if D == 2 { 2.0 } else { 2.5 }))
}
