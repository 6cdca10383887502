//! Membranes of two materials.

use super::free_boundary;
use super::scene::{Scene, over_plane};
use crate::mesh::BoxDomain;
use crate::problem::{Datum, Exact};
use crate::real::Point;
use crate::scheme::Regularity;

/// A membrane on `(0, 1)^D`, pressed by `f = -1` onto `psi = 0`, with the coefficient `alpha` =
/// `contrast` for `x < 1/2` and one beyond: an interface that meshes of even level resolve. Contact
/// for `x <= 1/4`.
///
/// The solution is `v(x)/contrast` up to the interface, `v = max(x - 1/4, 0)^2/2`, and
/// `v(1/2)/contrast + v(x) - v(1/2)` beyond. *Off contact*: `-alpha u'' = -1 = f`. *On contact*:
/// the multiplier is 1. *Across the interface*: `u` is continuous and `alpha u' = v'` is. For
/// `contrast != 1` the slope jumps, so `u` lies in `H^s` for `s < 3/2` only; on either side of the
/// interface for `s < 5/2`.
pub fn contrast<const D: usize>(contrast: f64) -> Scene<D> {
    let alpha = move |x: f64| if x < 0.5 { contrast } else { 1.0 };
    let value = move |x: &Point<D>| {
        let v = |x: f64| (x - 0.25).max(0.0).powi(2) / 2.0;
        if x[0] < 0.5 { v(x[0]) / contrast } else { v(0.5) / contrast + (v(x[0]) - v(0.5)) }
    };
    let gradient = move |x: &Point<D>| {
        let slope = (x[0] - 0.25).max(0.0) / alpha(x[0]);
        Point::from_fn(|k, _| if k == 0 { slope } else { 0.0 })
    };
    let transition = |y: f64| Point::from_fn(|k, _| if k == 0 { 0.25 } else { y });
    let free_boundary = match D {
        1 => vec![transition(0.0)],
        _ => free_boundary::segment(transition(0.0), transition(1.0), 1.0),
    };
    let problem = over_plane().coefficient(move |x| alpha(x[0])).constant_source(-1.0).solved_by(
        Exact::new(value, gradient)
            .with_multiplier(|x| if x[0] <= 0.25 { 1.0 } else { 0.0 })
            .with_contact(|x| 0.25 - x[0], free_boundary),
    );
    Scene::new(
        format!("contrast-{D}d"),
        BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)),
        problem,
    )
    .summary("two materials, straight interface; contrast is the ratio of coefficients")
    .regularity(Regularity::new(1.5))
}

/// Radius of the contact disc of [`contrast_disc_2d`].
const A: f64 = 0.5;

/// A membrane on `(-3/2, 3/2)^2`, pressed by `f = -2` onto `psi = 0`, with the coefficient `alpha`
/// = `contrast` in the unit disc and one outside: an interface that no mesh of the square resolves.
/// Contact in the disc `r <= a = 1/2`.
///
/// With `v(r) = (r^2 - a^2)/2 - a^2 ln(r/a)` for `r > a`, zero below, the solution is `v/contrast`
/// in the unit disc and `v(1)/contrast + v - v(1)` outside. *Off contact*: `-Laplace v = -2`. *On
/// contact*: the multiplier is 2; `v` and `v'` vanish at `r = a`. *Across the interface*: `u` and
/// `alpha du/dr = v'` are continuous. For `contrast != 1` the slope jumps: `H^s` for `s < 3/2`.
pub fn contrast_disc_2d(contrast: f64) -> Scene<2> {
    let alpha = move |x: &Point<2>| if x.norm() < 1.0 { contrast } else { 1.0 };
    let profile = |r: f64| {
        if r <= A { 0.0 } else { (r * r - A * A) / 2.0 - A * A * (r / A).ln() }
    };
    let value = move |x: &Point<2>| match x.norm() {
        r if r < 1.0 => profile(r) / contrast,
        r => profile(1.0) / contrast + (profile(r) - profile(1.0)),
    };
    let gradient = move |x: &Point<2>| {
        let s = x.norm_squared();
        if s <= A * A { Point::zeros() } else { x * ((1.0 - A * A / s) / alpha(x)) }
    };
    let problem = over_plane()
        .coefficient_in("default", Datum::piecewise(alpha, |x| 1.0 - x.norm()))
        .constant_source(-2.0)
        .solved_by(
            Exact::new(value, gradient)
                .with_multiplier(|x| if x.norm() <= A { 2.0 } else { 0.0 })
                .with_contact(|x| A - x.norm(), free_boundary::sphere(A, 3.0)),
        );
    Scene::new("contrast-disc-2d", BoxDomain::centred(1.5), problem)
        .summary("two materials, circular interface; contrast is the ratio of coefficients")
        .regularity(Regularity::new(1.5))
}
