//! Contact with a paraboloid in space: a scalar version of the point contact of Hertz.

use std::f64::consts::PI;

use super::free_boundary;
use super::scene::Scene;
use crate::mesh::BoxDomain;
use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// Radius of the contact disc.
const A: f64 = 0.5;

/// Signorini problem without load on `(-1, 1)^2 x (0, 1)` with the gap `g = a^2 - rho^2/2`,
/// `rho^2 = x^2 + y^2`; contact in the disc `rho <= a = 1/2`.
///
/// `u` is the potential of the charge `sqrt(a^2 - rho^2)` on the disc, times `2/pi^2`. Let
/// `K = rho^2 + z^2 - a^2`, `t >= 0` the oblate spheroidal coordinate with
/// `t^4 - K t^2 - a^2 z^2 = 0`, `s = a z/t` and `A = atan(a/t)`. Then
///
/// ```text
/// u = (a^2/pi) (2 A - (rho^2/a^2) (A - a t/(a^2 + t^2))) - (2/pi) z (s - z A),
/// grad u = -(2/pi) (A - a t/(a^2 + t^2)) (x, y, 0) - (4/pi) (s - z A) (0, 0, 1).
/// ```
///
/// *Equation*: a potential is harmonic off its charge, `f = 0`. *Contact* `z = 0`, `rho <= a`:
/// `t = 0`, `A = pi/2`, `s = sqrt(a^2 - rho^2)`, so `u = g` and `sigma = -du/dz = (4/pi) s >= 0`,
/// the pressure of Hertz. *Open part*: `s = 0`, so `sigma = 0`, and
/// `d(u - g)/d rho = rho (1 - (2/pi) (A - ...)) > 0` as `A - a t/(a^2 + t^2) < pi/2`. *Regularity*:
/// around the circle `rho = a` a singularity of type `r^{3/2}`: `H^s` for `s < 5/2`. See K. L.
/// Johnson, *Contact Mechanics*, Cambridge 1985, chapter 3.
pub fn hertz_3d() -> Scene<3> {
    let value = |x: &Point<3>| {
        let Spheroidal { z, s, angle, bulge, .. } = Spheroidal::at(x);
        let rho_squared = x[0] * x[0] + x[1] * x[1];
        (2.0 * A * A * angle - rho_squared * bulge) / PI - 2.0 / PI * z * (s - z * angle)
    };
    let gradient = |x: &Point<3>| {
        let Spheroidal { z, s, angle, bulge } = Spheroidal::at(x);
        let across = -2.0 / PI * bulge;
        Point::<3>::new(across * x[0], across * x[1], -4.0 / PI * (s - z * angle))
    };
    let inside = |x: &Point<3>| A * A - x[0] * x[0] - x[1] * x[1];
    let exact = Exact::new(value, gradient)
        .with_multiplier(move |x| 4.0 / PI * inside(x).max(0.0).sqrt())
        .with_contact(inside, free_boundary::circle(A, 2.0));
    let problem = Problem::new()
        .signorini(|x| A * A - (x[0] * x[0] + x[1] * x[1]) / 2.0)
        .obstacles_of_degree(2)
        .solved_by(exact);
    Scene::new("hertz-3d", BoxDomain::above_contact(), problem)
        .summary("Signorini without load in space, parabolic gap, contact in a disc")
        .regularity(Regularity::new(2.5))
}

/// Quantities of the solution at a point.
struct Spheroidal {
    /// The height, zero for points that rounding puts below the contact side.
    z: f64,
    /// `a z/t`, which stays finite on contact.
    s: f64,
    /// `atan(a/t)`.
    angle: f64,
    /// `atan(a/t) - a t/(a^2 + t^2)`.
    bulge: f64,
}

impl Spheroidal {
    /// `t^2` and `-s^2` are the roots of `T^2 - K T - a^2 z^2`, so that of `t` and `s` the larger
    /// is formed without cancellation and the other follows from `s t = a z`.
    fn at(x: &Point<3>) -> Self {
        let z = if x[2] <= 0.0 { 0.0 } else { x[2] };
        let k = x[0] * x[0] + x[1] * x[1] + z * z - A * A;
        let larger = ((k.abs() + k.hypot(2.0 * A * z)) / 2.0).sqrt();
        let smaller = if larger == 0.0 { 0.0 } else { A * z / larger };
        let (t, s) = if k >= 0.0 { (larger, smaller) } else { (smaller, larger) };
        let angle = A.atan2(t);
        Self { z, s, angle, bulge: angle - A * t / (A * A + t * t) }
    }
}
