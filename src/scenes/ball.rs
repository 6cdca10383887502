//! A membrane over a ball.

use super::free_boundary;
use super::scene::Scene;
use crate::mesh::{BoxDomain, Domain};
use crate::problem::{Datum, Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// Radius of the contact disc: the root in `(0, 1)` of `a^2 ln(2/a) = 1 - a^2`.
const A_IN_PLANE: f64 = 0.697_965_148_223_373_6;
/// Radius of the contact ball in space: the root in `(0, 1)` of `2a^2 - a^3/2 = 1`.
const A_IN_SPACE: f64 = 0.789_244_119_040_808_3;
/// Radius of contact on the unit disc: the root in `(0, 1/2)` of `a^2 ln(1/a) = 1/4 - a^2`.
const A_ON_DISC: f64 = 0.348_982_574_111_686_8;

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
/// `s < 5/2`. Without a load the multiplier is due to the curvature of the obstacle alone.
pub fn ball_2d() -> Scene<2> {
    let dome = Dome { radius: 1.0, skirt: 0.9, contact: A_IN_PLANE };
    let summary = "no load, the obstacle is a ball; contact in a disc";
    let outside = |r: f64| (2.0 / r).ln();
    over(dome, "ball-2d", summary, BoxDomain::centred(2.0).into(), Problem::new(), outside)
}

/// [`ball_2d`] in space: an unloaded body on `(-2, 2)^3` over the unit ball.
///
/// The solution is `u = A (1/r - 1/2)` for `r > a`, which is harmonic. The slopes agree for
/// `A = a^3/sqrt(1 - a^2)`, then the values do if `2a^2 - a^3/2 = 1`: `a = 0.78924`. The multiplier
/// is `(3 - 2 r^2)/(1 - r^2)^{3/2} > 0`; `u > psi` for `r > a`, as `r^2 (u - psi)'` increases.
pub fn ball_3d() -> Scene<3> {
    let dome = Dome { radius: 1.0, skirt: 0.9, contact: A_IN_SPACE };
    let summary = "no load, the obstacle is a ball; contact in a ball";
    let outside = |r: f64| 1.0 / r - 0.5;
    over(dome, "ball-3d", summary, BoxDomain::centred(2.0).into(), Problem::new(), outside)
}

/// [`ball_2d`] on the unit disc: `u = 0` on the circle, over the ball of radius 1/2 and its tangent
/// cone beyond `r = 9/20`; example 36 of the library MFEM.
///
/// The solution is `u = A ln(1/r)` for `r > a`. The slopes agree for `A = a^2/sqrt(1/4 - a^2)`, then the
/// values do if `a^2 ln(1/a) = 1/4 - a^2`: `a = 0.34898`. Meshes are polygons inside the disc, on
/// whose sides the datum is zero and the solution is not, an error of second order.
pub fn disc_2d() -> Scene<2> {
    let dome = Dome { radius: 0.5, skirt: 0.45, contact: A_ON_DISC };
    let summary = "circular membrane, no load, the obstacle is a ball; curved boundary";
    let outside = |r: f64| -r.ln();
    let problem = Problem { dirichlet: Datum::Constant(0.0).into(), ..Problem::new() };
    over(dome, "disc-2d", summary, Domain::Disc { radius: 1.0 }, problem, outside)
}

/// The obstacle of a sphere of this radius up to `r = skirt` and its tangent cone beyond, and the radius
/// of contact.
#[derive(Clone, Copy)]
struct Dome {
    radius: f64,
    skirt: f64,
    contact: f64,
}

impl Dome {
    /// `sqrt(radius^2 - r^2)`, continued by its tangent at the skirt.
    fn height(&self, r: f64) -> f64 {
        let sphere = |r: f64| ((self.radius - r) * (self.radius + r)).sqrt();
        if r <= self.skirt {
            return sphere(r);
        }
        let height = sphere(self.skirt);
        height - (self.skirt / height) * (r - self.skirt)
    }
}

/// `r^D`, as a product: the compiler rounds `powi` of a constant otherwise than `powi` of a variable.
fn power<const D: usize>(r: f64) -> f64 {
    (1..D).fold(r, |product, _| product * r)
}

/// The scene whose solution is the dome on contact and a multiple of `outside` beyond, a harmonic
/// function with the derivative `-r^(1-D)`.
fn over<const D: usize>(
    dome: Dome,
    name: &str,
    summary: &'static str,
    domain: Domain<D>,
    problem: Problem<D>,
    outside: impl Fn(f64) -> f64 + Send + Sync + 'static,
) -> Scene<D> {
    let a = dome.contact;
    let below_top = move |s: f64| dome.radius * dome.radius - s;
    let amplitude = power::<D>(a) / below_top(a * a).sqrt();
    let value = move |x: &Point<D>| {
        let r = x.norm();
        if r <= a { dome.height(r) } else { amplitude * outside(r) }
    };
    let gradient = move |x: &Point<D>| {
        let s = x.norm_squared();
        if s <= a * a { -x / below_top(s).sqrt() } else { x * (-amplitude / power::<D>(s.sqrt())) }
    };
    let multiplier = move |x: &Point<D>| {
        let s = x.norm_squared();
        let curvature = D as f64 * below_top(s) + s;
        if s <= a * a { curvature / below_top(s).powf(1.5) } else { 0.0 }
    };
    let side = 2.0 * domain.bounding_box().upper[0];
    let exact = Exact::new(value, gradient)
        .with_multiplier(multiplier)
        .with_contact(move |x| a - x.norm(), free_boundary::sphere(a, side));
    let problem =
        problem.obstacle_below(move |x: &Point<D>| dome.height(x.norm())).solved_by(exact);
    Scene::new(name, domain, problem).summary(summary).regularity(Regularity::new(2.5))
}
