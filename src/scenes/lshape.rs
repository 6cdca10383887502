//! A re-entrant corner together with contact.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use super::scene::{Scene, over_plane};
use crate::mesh::Domain;
use crate::problem::Exact;
use crate::real::Point;
use crate::scheme::Regularity;

/// The L-shaped membrane of S. Bartels, C. Carstensen, *Numer. Math.* 99 (2004): `(-2, 2)^2`
/// without `[0, 2] x [-2, 0]`, `psi = 0`, zero Dirichlet data.
///
/// With polar coordinates around the corner, `0 < phi < 3 pi/2`, the solution is
/// `u = r^{2/3} g(r) sin(2 phi/3)`, where the cut-off `g` is 1 for `r < 1/4`, 0 for `r > 3/4` and
/// `1 - 10 t^3 + 15 t^4 - 6 t^5`, `t = 2 (r - 1/4)`, between: twice continuously differentiable.
/// Since `r^{2/3} sin(2 phi/3)` is harmonic,
///
/// ```text
/// -Laplace u = -(r^{2/3} (g'' + g'/r) + (4/3) r^{-1/3} g') sin(2 phi/3).
/// ```
///
/// The load is this function, less 1 for `r > 5/4`. The multiplier is 1 for `r > 5/4` and vanishes elsewhere, so the
/// ring `3/4 < r < 5/4` is in contact without force. At the corner `u` behaves like `r^{2/3}`: it lies in `H^s` for
/// `s < 5/3`.
pub fn lshape_2d() -> Scene<2> {
    let pressed = |x: &Point<2>| if x.norm() > 1.25 { 1.0 } else { 0.0 };
    let value = |x: &Point<2>| {
        let (r, phi) = polar(x);
        r.powf(2.0 / 3.0) * cut_off(r)[0] * (2.0 * phi / 3.0).sin()
    };
    let gradient = |x: &Point<2>| {
        let (r, phi) = polar(x);
        if r == 0.0 {
            return Point::zeros();
        }
        let [g, slope, _] = cut_off(r);
        let root = r.powf(-1.0 / 3.0);
        let radial = (2.0 / 3.0 * root * g + r * root * slope) * (2.0 * phi / 3.0).sin();
        let angular = 2.0 / 3.0 * root * g * (2.0 * phi / 3.0).cos();
        (x * radial + Point::<2>::new(-x[1], x[0]) * angular) / r
    };
    let source = move |x: &Point<2>| {
        let (r, phi) = polar(x);
        let [_, slope, curvature] = cut_off(r);
        let smooth = if slope == 0.0 {
            0.0
        } else {
            r.powf(2.0 / 3.0) * curvature + 7.0 / 3.0 * r.powf(-1.0 / 3.0) * slope
        };
        -smooth * (2.0 * phi / 3.0).sin() - pressed(x)
    };
    let problem = over_plane()
        .piecewise_source(source, |x| {
            [0.25, 0.75, 1.25].iter().map(|circle| x.norm() - circle).product()
        })
        .solved_by(Exact::new(value, gradient).with_multiplier(pressed));
    Scene::new("lshape-2d", Domain::LShape { half: 2.0 }, problem)
        .summary("L-shaped membrane over a plane: a corner singularity, contact outside a disc")
        .regularity(Regularity::new(5.0 / 3.0).not_strictly_complementary())
}

/// Distance from the corner and angle from the positive `x` axis. `atan2` is applied to the angle from
/// the bisector of the domain: its branch cut bisects the removed quadrant and does not lie on the
/// boundary, where rounding errors would cross it.
fn polar(x: &Point<2>) -> (f64, f64) {
    let middle = FRAC_PI_2 + FRAC_PI_4;
    let (sin, cos) = middle.sin_cos();
    let from_middle = (cos * x[1] - sin * x[0]).atan2(cos * x[0] + sin * x[1]);
    (x.norm(), middle + from_middle)
}

/// The cut-off and its first two derivatives.
fn cut_off(r: f64) -> [f64; 3] {
    let t = 2.0 * (r - 0.25);
    if t <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    if t >= 1.0 {
        return [0.0; 3];
    }
    let s = 1.0 - t;
    // this form has no cancellation near t = 1
    let value = s * s * s * (1.0 + 3.0 * t + 6.0 * t * t);
    [value, -60.0 * t * t * s * s, -240.0 * t * s * (1.0 - 2.0 * t)]
}
