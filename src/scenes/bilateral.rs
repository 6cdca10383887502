//! A string between floor and ceiling.

use std::f64::consts::{FRAC_PI_4, PI, SQRT_2};

use super::scene::Scene;
use crate::mesh::BoxDomain;
use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// Distance of floor and ceiling from the middle.
const M: f64 = SQRT_2 / 2.0 * (1.0 - FRAC_PI_4);

/// A string on `(-1, 1)` with `-m <= u <= m`, `m = (1 - pi/4)/sqrt(2)`, under the load
/// `f = pi^2 sin(pi x)`; contact with the ceiling on `[1/4, 3/4]`, with the floor on the mirror
/// image.
///
/// The solution is odd. For `x >= 0`, with the distance `t = min(x, 1 - x)`, it is
/// `u = sin(pi t) - (pi/sqrt(2)) t` for `t < 1/4` and `m` otherwise. *Off contact*:
/// `-u'' = pi^2 sin(pi t) = f`. *On contact*: the multiplier is `-f`, negative at the ceiling and
/// positive at the floor. *At `t = 1/4`*: `u = m`, `u' = 0`. *Between the bounds*: `u` rises up to
/// `t = 1/4`, for its slope `pi cos(pi t) - pi/sqrt(2)` is positive. `C^{1,1}`, `H^s` for
/// `s < 5/2`.
pub fn bilateral_1d() -> Scene<1> {
    let load = |x: f64| PI * PI * (PI * x).sin();
    let distance = |x: f64| x.abs().min(1.0 - x.abs());
    let value = move |x: &Point<1>| {
        let t = distance(x[0]);
        let u = if t < 0.25 { (PI * t).sin() - PI * SQRT_2 / 2.0 * t } else { M };
        u * x[0].signum()
    };
    let gradient = move |x: &Point<1>| {
        let t = distance(x[0]);
        let slope = if t < 0.25 { PI * (PI * t).cos() - PI * SQRT_2 / 2.0 } else { 0.0 };
        Point::<1>::new(if x[0].abs() < 0.5 { slope } else { -slope })
    };
    let inside = move |x: f64| distance(x) - 0.25;
    let exact = Exact::new(value, gradient)
        .with_multiplier(move |x| if inside(x[0]) >= 0.0 { -load(x[0]) } else { 0.0 })
        .with_contact(move |x| inside(x[0]), [-0.75, -0.25, 0.25, 0.75].map(|x| [x].into()).into());
    let problem = Problem::new()
        .source(move |x| load(x[0]))
        .obstacle_below(|_| -M)
        .obstacle_above(|_| M)
        .obstacles_of_degree(0)
        .solved_by(exact);
    Scene::new("bilateral-1d", BoxDomain::centred(1.0), problem)
        .summary("a string between floor and ceiling, in contact with both")
        .regularity(Regularity::new(2.5))
}
