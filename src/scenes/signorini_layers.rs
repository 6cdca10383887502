//! Signorini conditions on a layer of another material.

use super::dual_number::positive_power;
use super::scene::{Scene, zero_gap};
use crate::mesh::BoxDomain;
use crate::problem::Exact;
use crate::real::Point;
use crate::scheme::Regularity;

/// Signorini problem on `(-1, 1) x (0, 1)` with zero gap and the coefficient `alpha` = `contrast`
/// for `y < 1/2` and one above: an interface that meshes of even level resolve. A penalty that
/// does not depend on `alpha` fails on this scene.
///
/// With `m(y) = y/contrast` up to the interface and `m(1/2) + y - 1/2` above the solution is
/// `u = P - m N`, `P = max(x, 0)^3`, `N = max(-x, 0)^3`. As `(alpha m')' = 0`, the load is
/// `f = -alpha (P'' - m N'')`. *Contact side*: `m = 0`, so `u = P >= 0` and
/// `sigma = -alpha du/dy = N >= 0`. *Across the interface*: `m` and `alpha m'` are continuous. The
/// slope jumps for `contrast != 1`: `u` lies in `H^s` for `s < 3/2` only, on either side for
/// `s < 7/2`.
pub fn signorini_layers_2d(contrast: f64) -> Scene<2> {
    let alpha = move |x: &Point<2>| if x[1] < 0.5 { contrast } else { 1.0 };
    let depth = move |y: f64| if y < 0.5 { y / contrast } else { 0.5 / contrast + (y - 0.5) };
    let value =
        move |x: &Point<2>| positive_power(x[0], 3)[0] - depth(x[1]) * positive_power(-x[0], 3)[0];
    let gradient = move |x: &Point<2>| {
        let ([_, open, _], [closed, steep, _]) =
            (positive_power(x[0], 3), positive_power(-x[0], 3));
        Point::<2>::new(open + depth(x[1]) * steep, -closed / alpha(x))
    };
    let source = move |x: &Point<2>| {
        -alpha(x) * (positive_power(x[0], 3)[2] - depth(x[1]) * positive_power(-x[0], 3)[2])
    };
    let exact = Exact::new(value, gradient)
        .with_multiplier(|x| positive_power(-x[0], 3)[0])
        .with_contact(|x| -x[0], vec![Point::zeros()]);
    let problem = zero_gap()
        .coefficient(alpha)
        .piecewise_source(source, |x| x[0] * (x[1] - 0.5))
        .solved_by(exact);
    Scene::new("signorini-layers-2d", BoxDomain::above_contact(), problem)
        .summary("Signorini under two layers; contrast is the ratio of coefficients")
        .regularity(Regularity::new(1.5))
}
