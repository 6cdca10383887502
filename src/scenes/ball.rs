//! A membrane over a ball.

use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scenes::{BoxDomain, Regularity, Scene, free_boundary};

/// Radius of the contact disc: the root in `(0, 1)` of `a^2 ln(2/a) = 1 - a^2`.
const A: f64 = 0.697_965_148_223_373_6;
/// The obstacle is the sphere up to this radius and its tangent cone beyond.
const SKIRT: f64 = 0.9;

/// An unloaded membrane on `(-2, 2)^2` over the unit ball, after Bueler, *PETSc for Partial
/// Differential Equations*, SIAM 2021, chapter 12.
///
/// The obstacle is `psi = sqrt(1 - r^2)` for `r <= 9/10` and its tangent cone beyond, so that it
/// is finite and `C^1` on the whole square. The solution is `u = psi` for `r <= a` and
/// `u = A ln(2/r)` for `r > a`.
///
/// *Off contact*: `ln r` is harmonic and there is no load. *Across `r = a`*: the slopes agree,
/// `-A/a = -a/sqrt(1 - a^2)`, if `A = a^2/sqrt(1 - a^2)`; then the values agree,
/// `A ln(2/a) = sqrt(1 - a^2)`, if `a^2 ln(2/a) = 1 - a^2`, which determines `a = 0.69797`.
/// *On contact*: the multiplier is `-Laplace psi = (2 - r^2)/(1 - r^2)^{3/2} > 0`. *Above the
/// obstacle*: `u - psi` and its derivative vanish at `r = a`, and `r (u - psi)' = -A - r psi'`
/// increases, since `-r psi'` does, on sphere and cone alike; so `u > psi` for `r > a`.
///
/// The second normal derivative jumps across `r = a`: `u` lies in `C^{1,1}` and in `H^s` for
/// `s < 5/2`. With a curved obstacle and no load, discrete contact rests on the obstacle's
/// curvature alone.
pub fn ball_2d() -> Scene<2> {
    let amplitude = A * A / (1.0 - A * A).sqrt();
    let value = move |x: &Point<f64, 2>| {
        let r = x.norm();
        if r <= A { sphere_with_skirt(r) } else { amplitude * (2.0 / r).ln() }
    };
    let gradient = move |x: &Point<f64, 2>| {
        let s = x.norm_squared();
        if s <= A * A { -x / (1.0 - s).sqrt() } else { x * (-amplitude / s) }
    };
    let multiplier = |x: &Point<f64, 2>| {
        let s = x.norm_squared();
        if s <= A * A { (2.0 - s) / (1.0 - s).powf(1.5) } else { 0.0 }
    };
    let exact = Exact::new(value, gradient)
        .with_multiplier(multiplier)
        .with_contact(|x| A - x.norm(), free_boundary::sphere(A, 4.0));
    Scene {
        name: "ball-2d".into(),
        summary: "no load, the obstacle is a ball; contact in a disc",
        domain: BoxDomain::dirichlet(Point::repeat(-2.0), Point::repeat(2.0)),
        problem: Problem::new()
            .obstacle_below(|x: &Point<f64, 2>| sphere_with_skirt(x.norm()))
            .solved_by(exact),
        regularity: Regularity { sobolev: 2.5, strictly_complementary: true },
    }
}

/// `sqrt(1 - r^2)`, continued by its tangent at [`SKIRT`].
fn sphere_with_skirt(r: f64) -> f64 {
    if r <= SKIRT {
        return (1.0 - r * r).sqrt();
    }
    let height = (1.0 - SKIRT * SKIRT).sqrt();
    height - (SKIRT / height) * (r - SKIRT)
}
