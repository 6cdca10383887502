//! A membrane pulled onto a plane.

use super::free_boundary;
use super::scene::{Scene, over_plane};
use crate::mesh::{BoundaryCondition, BoxDomain};
use crate::problem::{BoundaryFlux, Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// A constant load presses the membrane onto the plane `psi = 0`; contact is the ball `|x| <= L`.
/// The domain is `L (-3/2, 3/2)^D`, `D` = 1, 2 or 3, the load `f = -2/L^2`, `L` is `scale`.
///
/// With `r = |x|/L` the solution is `u = w(r)` for `r > 1` and zero for `r <= 1`, where
///
/// ```text
/// w'(r) = (2/D) (r - r^(1-D)),   w(1) = 0.
/// ```
///
/// *Off contact*: `r^(1-D) (r^(D-1) w')' = 2`, so `-Laplace u = -2/L^2 = f`; `w' > 0` for `r > 1`,
/// so `u > 0`. *On contact*: `u = 0` and the multiplier is `-f = 2/L^2 > 0`. *Across `r = 1`*:
/// `w(1) = w'(1) = 0`, so value and gradient are continuous while the second normal derivative
/// jumps: `u` lies in `C^{1,1}` and in `H^s` for `s < 5/2`.
///
/// `u` depends on `x/L` alone, so relative errors must not depend on `L`. `scale` must be positive
/// and finite; [`Entry::make`](crate::scenes::Entry::make) checks that, this function does not.
pub fn radial<const D: usize>(scale: f64) -> Scene<D> {
    const { assert!(D >= 1 && D <= 3, "radial scenes exist in one, two and three dimensions") };
    let per_scale = scale.recip();
    let value = move |x: &Point<D>| profile::<D>((x * per_scale).norm());
    let gradient = move |x: &Point<D>| {
        let x = x * per_scale;
        let r = x.norm();
        // Zero in contact, so the direction x/r is never formed at the origin.
        if r <= 1.0 { Point::zeros() } else { x * (slope::<D>(r) / (r * scale)) }
    };
    let load = 2.0 / (scale * scale);
    let exact = Exact::new(value, gradient)
        .with_multiplier(move |x| if x.norm() <= scale { load } else { 0.0 })
        .with_contact(
            move |x| 1.0 - (x * per_scale).norm(),
            free_boundary::sphere(scale, 3.0 * scale),
        );
    let problem = over_plane().constant_source(-load).solved_by(exact);
    Scene::new(format!("radial-{D}d"), BoxDomain::centred(1.5 * scale), problem)
        .summary("constant load on a plane obstacle, contact in a ball; scale sets its radius")
        .regularity(Regularity::new(2.5))
}

/// A quarter of `radial-2d`: `(0, 3/2)^2` with no flux through the sides on the axes of symmetry.
pub fn radial_quarter_2d() -> Scene<2> {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.5))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(1, 0, BoundaryCondition::Neumann);
    let mut scene = radial::<2>(1.0);
    if let Some(contact) = scene.problem.exact.as_mut().and_then(|exact| exact.contact.as_mut()) {
        contact.free_boundary.retain(|x| x.min() >= 0.0);
    }
    let problem = Problem { neumann: BoundaryFlux::Constant(0.0).into(), ..scene.problem };
    Scene::new("radial-quarter-2d", domain, problem)
        .summary("a quarter of radial-2d, with Neumann sides on the axes of symmetry")
        .regularity(scene.regularity)
}

/// `w(r)`, in forms that keep the double zero at `r = 1` free of cancellation.
fn profile<const D: usize>(r: f64) -> f64 {
    let t = r - 1.0;
    match D {
        _ if t <= 0.0 => 0.0,
        1 => t * t,
        2 => t * t / 2.0 + excess_over_logarithm(t),
        _ => t * t * (r + 2.0) / (3.0 * r),
    }
}

/// `w'(r)` for `r > 1`, with the factor `r - 1` drawn out.
fn slope<const D: usize>(r: f64) -> f64 {
    let t = r - 1.0;
    match D {
        1 => 2.0 * t,
        2 => t * (r + 1.0) / r,
        _ => 2.0 * t * (r * r + r + 1.0) / (3.0 * r * r),
    }
}

/// `t - ln(1 + t)` for `t >= 0`, without the cancellation of its leading terms.
///
/// With `s = t/(2 + t)`, `ln(1 + t) = 2 (s + s^3/3 + s^5/5 + ...)` and `t - 2s = ts`.
fn excess_over_logarithm(t: f64) -> f64 {
    if t > 0.5 {
        return t - t.ln_1p();
    }
    let s = t / (2.0 + t);
    // s <= 1/5, so the first term left out is below 1e-17 of the sum; two terms at a time
    let (square, fourth) = (s * s, (s * s) * (s * s));
    let two_terms = |k: i32| 1.0 / f64::from(4 * k + 3) + square * (1.0 / f64::from(4 * k + 5));
    let tail = (0..6).rev().fold(0.0, |sum, k| sum * fourth + two_terms(k));
    s * (t - 2.0 * square * tail)
}
