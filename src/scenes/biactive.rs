//! Contact without force on a set of positive measure.

use super::dual_number::positive_power;
use super::scene::Scene;
use crate::mesh::BoxDomain;
use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// The first example of B. Keith, T. M. Surowiec, *Found. Comput. Math.* (2024), "Proximal
/// Galerkin": on `(-1, 1)^2` with `psi = 0` the solution is `u = max(x, 0)^4`, the load
/// `f = -12 max(x, 0)^2`.
///
/// `-Laplace u = f` holds everywhere, so the multiplier vanishes: the membrane touches the half
/// `x <= 0` without force, and the data do not determine the contact set. `u` lies in `H^s` for `s < 9/2`.
pub fn biactive_half_2d() -> Scene<2> {
    let power = |x: &Point<2>| positive_power(x[0], 4);
    Scene {
        name: "biactive-half-2d".into(),
        summary: "half of the membrane touches a plane obstacle without force",
        domain: BoxDomain::centred(1.0).into(),
        problem: Problem::new()
            .piecewise_source(move |x| -power(x)[2], |x| x[0])
            .obstacle_below(|_| 0.0)
            .obstacles_of_degree(0)
            .solved_by(
                Exact::new(move |x| power(x)[0], move |x| Point::from([power(x)[1], 0.0]))
                    .with_multiplier(|_| 0.0),
            ),
        regularity: Regularity::new(4.5).not_strictly_complementary(),
    }
}

/// The third example of Keith and Surowiec, see [`biactive_half_2d`]: contact without force in a ring,
/// with force around it.
///
/// On `(-1, 1)^2` with `psi = 0` the solution is `u = 256 s^4`, `s = max(1/4 - r^2, 0)`. The load
/// is `-Laplace u = -256 (48 r^2 s^2 - 16 s^3)` for `r^2 < 1/4`, zero up to `r^2 = 3/4` and -1
/// beyond, where the multiplier is 1; elsewhere it vanishes. `u` lies in `H^s` for `s < 9/2`.
pub fn biactive_ring_2d() -> Scene<2> {
    // derivatives with respect to s, where |grad s|^2 = 4 r^2 and Laplace s = -4
    let power = |x: &Point<2>| positive_power(0.25 - x.norm_squared(), 4);
    let outside = |x: &Point<2>| x.norm_squared() > 0.75;
    let source = move |x: &Point<2>| {
        let [_, first, second] = power(x);
        let pressed = if outside(x) { 1.0 } else { 0.0 };
        -256.0 * (second * 4.0 * x.norm_squared() - 4.0 * first) - pressed
    };
    let exact = Exact::new(move |x| 256.0 * power(x)[0], move |x| x * (-512.0 * power(x)[1]))
        .with_multiplier(move |x| if outside(x) { 1.0 } else { 0.0 });
    Scene {
        name: "biactive-ring-2d".into(),
        summary: "a hill within a ring of contact without force within contact with force",
        domain: BoxDomain::centred(1.0).into(),
        problem: Problem::new()
            .piecewise_source(source, |x| (x.norm_squared() - 0.25) * (x.norm_squared() - 0.75))
            .obstacle_below(|_| 0.0)
            .obstacles_of_degree(0)
            .solved_by(exact),
        regularity: Regularity::new(4.5).not_strictly_complementary(),
    }
}
