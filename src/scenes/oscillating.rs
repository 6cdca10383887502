//! A string under a ceiling, shaken by a load of high frequency.

use std::f64::consts::PI;

use super::scene::Scene;
use crate::mesh::BoxDomain;
use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// Wave number of the load.
const K: f64 = 10.0 * PI;
/// Left end of the first contact interval, which ends at [`FIRST`].
const X0: f64 = 0.038_276_475_303_830_01;
const FIRST: f64 = 0.05;
/// Left end of the second contact interval, which ends at [`X3`].
const LAST: f64 = 0.85;
const X3: f64 = 0.853_422_907_268_890_2;
/// Slopes that are added to `2 sin(kx)` beside the ends of the string.
const A0: f64 = -22.621_665_140_543_395;
const A3: f64 = 6.743_534_077_192_142;

/// A string on `(0, 1)` below the ceiling `u <= 1` under the load `f = 2 k^2 sin(kx)`, `k = 10 pi`.
///
/// ```text
/// u = 2 sin(kx) + a0 x        on (0, x0)
///     1                       on [x0, 0.05]
///     2 sin(kx) - 1           on (0.05, 0.85)
///     1                       on [0.85, x3]
///     2 sin(kx) + a3 (x - 1)  on (x3, 1)
/// ```
///
/// *Off contact*: `-u'' = f`. *Contact* is left where `sin(kx) = 1`, with slope zero; `x0`, `a0`
/// and `x3`, `a3` are fixed by `u = 1`, `u' = 0` at `x0` and `x3`. The multiplier is `-f < 0` on
/// the two contact intervals. *Below the ceiling*: `2 sin(kx) - 1 <= 1`. Between the intervals `u`
/// touches the ceiling at the isolated points `0.05 + m/5` without force; these do not count as
/// contact. There rounding errors may make an active set method cycle. `C^{1,1}`, `H^s` for
/// `s < 5/2`.
pub fn oscillating_1d() -> Scene<1> {
    let load = |x: f64| 2.0 * K * K * (K * x).sin();
    let linear = |x: f64| match x {
        x if x < X0 => Some((A0 * x, A0)),
        x if x > X3 => Some((A3 * (x - 1.0), A3)),
        x if x > FIRST && x < LAST => Some((-1.0, 0.0)),
        _ => None,
    };
    let value =
        move |x: &Point<1>| linear(x[0]).map_or(1.0, |(added, _)| 2.0 * (K * x[0]).sin() + added);
    let gradient = move |x: &Point<1>| {
        let slope = linear(x[0]).map_or(0.0, |(_, slope)| 2.0 * K * (K * x[0]).cos() + slope);
        Point::<1>::new(slope)
    };
    let inside = |x: f64| ((x - X0).min(FIRST - x)).max((x - LAST).min(X3 - x));
    let exact = Exact::new(value, gradient)
        .with_multiplier(move |x| if inside(x[0]) >= 0.0 { -load(x[0]) } else { 0.0 })
        .with_contact(move |x| inside(x[0]), [X0, FIRST, LAST, X3].map(|x| [x].into()).into());
    let problem = Problem::new()
        .source(move |x| load(x[0]))
        .obstacle_above(|_| 1.0)
        .obstacles_of_degree(0)
        .solved_by(exact);
    Scene::new(
        "oscillating-1d",
        BoxDomain::dirichlet(Point::repeat(0.0), Point::repeat(1.0)),
        problem,
    )
    .summary("a string below a ceiling, load of high frequency, touches without force")
    .regularity(Regularity::new(2.5))
}
