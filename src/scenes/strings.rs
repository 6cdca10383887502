//! Strings over parabolas, with piecewise quadratic solutions.

use super::scene::Scene;
use crate::mesh::BoxDomain;
use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// The upper end of an interval, and `[a, b, c]` of the parabola `a + b x + c x^2` on it.
type Parabola = (f64, [f64; 3]);

/// A string on `(0, 1)` under the load `f = -2` over the parabola `psi = 8x(1 - x) - 1`; contact on
/// `[1/3, 2/3]`.
///
/// The solution is `u = x(x + 2)` for `x < 1/3`, `psi` on contact, and symmetric about `x = 1/2`.
/// *Off contact*: `-u'' = -2 = f`. *On contact*: the multiplier is `16 + 2 = 18`. *At `x = 1/3`*:
/// both sides have the value `7/9` and the slope `8/3`. *Above the obstacle*:
/// `u - psi = (3x - 1)^2`. The second derivative jumps: `C^{1,1}`, `H^s` for `s < 5/2`.
pub fn parabola_1d() -> Scene<1> {
    const PARABOLAS: [Parabola; 3] = [
        (1.0 / 3.0, [0.0, 2.0, 1.0]),
        (2.0 / 3.0, [-1.0, 8.0, -8.0]),
        (f64::INFINITY, [3.0, -4.0, 1.0]),
    ];
    let problem = Problem::new()
        .constant_source(-2.0)
        .obstacle_below(|x: &Point<1>| 8.0 * x[0] * (1.0 - x[0]) - 1.0)
        .obstacles_of_degree(2);
    let inside = |x: f64| 1.0 / 6.0 - (x - 0.5).abs();
    let summary = "a string under constant load over a parabola";
    string("parabola-1d", summary, problem, &PARABOLAS, inside, &[1.0 / 3.0, 2.0 / 3.0])
}

/// A string on `(0, 1)` over `psi = x(1 - x)` that is pressed down by `f = -16` near the ends,
/// `x < 1/5` and `x > 4/5`, and lifted by `f = 8` between; contact on `[0, 1/10]` and `[9/10, 1]`,
/// up to the ends of the string.
///
/// The solution is `psi` on `[0, 0.1]`, `8x^2 - 0.8x + 0.09` on `[0.1, 0.2]`, `-4x^2 + 4x - 0.39`
/// on `[0.2, 0.8]`, and symmetric about `x = 1/2`. *Off contact*: `-u''` is -16 and 8 where `f` is.
/// *On contact*: the multiplier is `2 + 16 = 18`. *Across `x = 0.1`*: value 0.09 and slope 0.8 on
/// both sides; *across `x = 0.2`*: 0.25 and 2.4. *Above the obstacle*: `u - psi` vanishes with its
/// slope at 0.1, is convex to 0.2 and a parabola with its top at 1/2 beyond. `C^{1,1}`, `H^s` for
/// `s < 5/2`.
pub fn icelike_1d() -> Scene<1> {
    const PARABOLAS: [Parabola; 5] = [
        (0.1, [0.0, 1.0, -1.0]),
        (0.2, [0.09, -0.8, 8.0]),
        (0.8, [-0.39, 4.0, -4.0]),
        (0.9, [7.29, -15.2, 8.0]),
        (f64::INFINITY, [0.0, 1.0, -1.0]),
    ];
    let near_end = |x: &Point<1>| (x[0] - 0.5).abs() - 0.3;
    let problem = Problem::new()
        .piecewise_source(move |x| if near_end(x) > 0.0 { -16.0 } else { 8.0 }, near_end)
        .obstacle_below(|x: &Point<1>| x[0] * (1.0 - x[0]))
        .obstacles_of_degree(2);
    let summary = "a string held down near its ends and lifted between, over a parabola";
    string("icelike-1d", summary, problem, &PARABOLAS, |x| (x - 0.5).abs() - 0.4, &[0.1, 0.9])
}

/// The scene on `(0, 1)` whose solution consists of `parabolas`, with the multiplier 18 on contact.
fn string(
    name: &str,
    summary: &'static str,
    problem: Problem<1>,
    parabolas: &'static [Parabola],
    contact: impl Fn(f64) -> f64 + Copy + Send + Sync + 'static,
    transitions: &[f64],
) -> Scene<1> {
    let coefficients = move |x: f64| {
        parabolas.iter().find(|(end, _)| x <= *end).map_or([0.0; 3], |&(_, parabola)| parabola)
    };
    let value = move |x: &Point<1>| {
        let [a, b, c] = coefficients(x[0]);
        a + x[0] * (b + c * x[0])
    };
    let gradient = move |x: &Point<1>| {
        let [_, b, c] = coefficients(x[0]);
        Point::<1>::new(b + 2.0 * c * x[0])
    };
    let exact = Exact::new(value, gradient)
        .with_multiplier(move |x| if contact(x[0]) >= 0.0 { 18.0 } else { 0.0 })
        .with_contact(move |x| contact(x[0]), transitions.iter().map(|&x| [x].into()).collect());
    let problem = problem.solved_by(exact);
    Scene::new(name, BoxDomain::dirichlet(Point::repeat(0.0), Point::repeat(1.0)), problem)
        .summary(summary)
        .regularity(Regularity::new(2.5))
}
