//! Obstacles with a sharp edge: the multiplier is a force on a line or surface.

use super::scene::Scene;
use crate::mesh::BoxDomain;
use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// A membrane without load on `(-1, 1)^D` over the ridge `psi = 1/2 - |x_1|`; contact on the plane
/// `x_1 = 0` alone.
///
/// The solution is `u = (1 - |x_1|)/2`. *Off contact*: `u` is linear, and `u - psi = |x_1|/2 > 0`.
/// *On contact*: `du/dx_1` falls by one, so the multiplier is the measure of density one on
/// `x_1 = 0` and no function. `u` lies in `H^s` for `s < 3/2`. On meshes in which that plane
/// consists of facets, conforming linear elements are exact.
pub fn ridge<const D: usize>() -> Scene<D> {
    let problem = Problem::new().obstacle_below(|x: &Point<D>| 0.5 - x[0].abs()).exact(
        |x| (1.0 - x[0].abs()) / 2.0,
        |x| Point::from_fn(|k, _| if k == 0 { -x[0].signum() / 2.0 } else { 0.0 }),
    );
    Scene::new(format!("ridge-{D}d"), BoxDomain::centred(1.0), problem)
        .summary("no load, the obstacle is a ridge; a force on a line or plane")
        .regularity(Regularity::new(1.5))
}

/// A membrane under the load `f = -1` on `(-1, 1)^2` that lies on the pyramid
/// `psi = 1 - max(|x|, |y|)` everywhere.
///
/// `u = psi` takes the Dirichlet data zero. The multiplier is `-f = 1` plus the measure of density
/// `sqrt(2)` on both diagonals, by which the normal derivative falls across them; both are
/// positive. `u` lies in `H^s` for `s < 3/2`. On meshes of which one diagonal is not a line the
/// error of conforming linear elements is that of interpolation. The level of the load vanishes on both diagonals, where
/// the gradient jumps.
pub fn pyramid_full_2d() -> Scene<2> {
    let height = |x: &Point<2>| 1.0 - x[0].abs().max(x[1].abs());
    let gradient = |x: &Point<2>| {
        let axis = usize::from(x[1].abs() > x[0].abs());
        Point::from_fn(|k, _| if k == axis { -x[k].signum() } else { 0.0 })
    };
    let problem = Problem::new()
        .piecewise_source(|_| -1.0, |x| x[0].abs() - x[1].abs())
        .obstacle_below(height)
        .solved_by(Exact::new(height, gradient).with_contact(|_| 1.0, Vec::new()));
    Scene::new("pyramid-full-2d", BoxDomain::centred(1.0), problem)
        .summary("contact everywhere with a pyramid; a force on its edges")
        .regularity(Regularity::new(1.5))
}
