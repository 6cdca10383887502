//! Simplified friction: inequalities of the second kind with closed solutions.

use super::dual_number::DualNumber;
use super::scene::Scene;
use crate::mesh::{BoundaryCondition, BoxDomain};
use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// A line with friction at both ends.
fn line(lower: f64) -> BoxDomain<1> {
    BoxDomain::dirichlet(Point::from([lower]), Point::from([1.0]))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(0, 1, BoundaryCondition::Neumann)
}

/// A string on `(0, 1)` under the load `f = 2`, held by friction alone: it sticks at 0 with the threshold 2 and slips at 1
/// with the threshold 1/2.
///
/// `u = 3/2 x - x^2`: `u(0) = 0` and `-u'(0) = -3/2`, below the threshold; `u(1) = 1/2 > 0` and `u'(1) = -1/2`. The load
/// is less than the sum of the thresholds.
pub fn friction_1d() -> Scene<1> {
    let exact = Exact::new(|x| 1.5 * x[0] - x[0] * x[0], |x| Point::<1>::new(1.5 - 2.0 * x[0]));
    let problem = Problem::new()
        .constant_source(2.0)
        .friction_on("default", |x: &Point<1>| if x[0] < 0.5 { 2.0 } else { 0.5 })
        .solved_by(exact);
    Scene::new("friction-1d", line(0.0), problem)
        .summary("a string held by friction: one end sticks, one slips")
        .regularity(Regularity::smooth())
}

/// A string with reaction 1 on `(-1, 1)` that slips upwards at 1 and downwards at -1, with the threshold 1.
///
/// `u = x - 2 x^3/3`: `u(1) = 1/3 > 0` and `u'(1) = -1`; `u` is odd. `f = -u'' + u = 4 x + u`.
pub fn friction_both_1d() -> Scene<1> {
    let value = |x: &Point<1>| x[0] - 2.0 / 3.0 * x[0].powi(3);
    let exact = Exact::new(value, |x| Point::<1>::new(1.0 - 2.0 * x[0] * x[0]));
    let problem = Problem::new()
        .source(move |x| 4.0 * x[0] + value(x))
        .reaction(1.0)
        .friction_on("default", |_: &Point<1>| 1.0)
        .polynomial_data(3)
        .solved_by(exact);
    Scene::new("friction-both-1d", line(-1.0), problem)
        .summary("a string with reaction that slips in both directions")
        .regularity(Regularity::smooth())
}

/// Friction with the threshold 1 on the side `z = 0` of `(-1, 1)^(D-1) x (0, 1)`, `D` = 2 or 3, without load: it sticks where
/// the first coordinate is negative and slips elsewhere.
///
/// Let `x` be the first and `z` the last coordinate and `w = Re (x + iz)^{3/2}`. The solution `u = z + w` is harmonic. On the
/// side `-du/dz = -1 - dw/dz`: for `x > 0`, `u = x^{3/2} > 0` and `dw/dz = 0`, slip with the flux -1; for `x < 0`, `u = 0` and
/// `dw/dz = -(3/2) |x|^{1/2}`, stick with a flux between -1 and 1/2. `H^s` for `s < 5/2`.
pub fn friction<const D: usize>() -> Scene<D> {
    const { assert!(D == 2 || D == 3, "slip along a side needs two or three dimensions") };
    let power = |x: &Point<D>| DualNumber::three_halves(x, 0.0, 1.0);
    let gradient = move |x: &Point<D>| {
        let mut gradient = power(x).gradient;
        gradient[D - 1] += 1.0;
        gradient
    };
    let exact = Exact::new(move |x| x[D - 1] + power(x).value, gradient);
    let domain = BoxDomain::above_contact().side(D - 1, 0, BoundaryCondition::Neumann);
    let problem = Problem::new().friction_on("default", |_: &Point<D>| 1.0).solved_by(exact);
    Scene::new(format!("friction-{D}d"), domain, problem)
        .summary("friction without load: stick and slip on one side")
        .regularity(Regularity::new(2.5))
}
