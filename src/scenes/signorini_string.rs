//! Signorini conditions at the ends of a string.

use super::scene::{Scene, zero_gap};
use crate::mesh::{BoundaryCondition, BoxDomain};
use crate::problem::Exact;
use crate::real::Point;
use crate::scheme::Regularity;

/// Coefficients of `exp(x)` and `exp(-x)` in [`signorini_reaction_1d`].
const C1: f64 = -0.077_025_104_449_637_6;
const C2: f64 = 0.165_204_152_153_577_5;

/// A string with reaction, `-u'' + u = sin x` on `(-1, 1)`, with Signorini conditions at both ends
/// and no Dirichlet data at all: the left end in contact, the right end open. Zero gap.
///
/// The solution is `u = c1 e^x + c2 e^-x + sin(x)/2`, where `-u'' + u = sin x` whatever `c1`, `c2`
/// are; they are fixed by `u(-1) = 0` and `u'(1) = 0`. Then `sigma(-1) = -u'(-1) = 0.20726` and
/// `u(1) = 0.27213`, both positive. The solution is smooth.
pub fn signorini_reaction_1d() -> Scene<1> {
    let value = |x: &Point<1>| C1 * x[0].exp() + C2 * (-x[0]).exp() + x[0].sin() / 2.0;
    let slope = |x: f64| C1 * x.exp() - C2 * (-x).exp() + x.cos() / 2.0;
    let exact = Exact::new(value, move |x| Point::<1>::new(slope(x[0])))
        .with_multiplier(move |x| if x[0] < 0.0 { -slope(x[0]) } else { 0.0 })
        .with_contact(|x| -x[0], Vec::new());
    let problem = zero_gap().source(|x| x[0].sin()).reaction(1.0).solved_by(exact);
    Scene::new(
        "signorini-reaction-1d",
        BoxDomain::centred(1.0).side(0, 0, BoundaryCondition::Contact).side(
            0,
            1,
            BoundaryCondition::Contact,
        ),
        problem,
    )
    .summary("a string with reaction, Signorini at both ends: one in contact, one open")
    .regularity(Regularity::smooth())
}

/// A string on `(0, 1)`, fixed at 0 and lifted off the support at 1 by the load `f = 1`.
///
/// `u = x - x^2/2`: `u(1) = 1/2 > 0` and `u'(1) = 0`.
pub fn signorini_open_1d() -> Scene<1> {
    let exact = Exact::new(|x| x[0] - x[0] * x[0] / 2.0, |x| Point::<1>::new(1.0 - x[0]))
        .with_multiplier(|_| 0.0)
        .with_contact(|_| -1.0, Vec::new());
    supported("signorini-open-1d", "a string lifted off its support", 1.0, exact)
}

/// A string on `(0, 1)`, fixed at 0 and pressed onto the support at 1 by the load `f = -1`.
///
/// `u = -x (1 - x)/2`: `u(1) = 0` and `sigma(1) = u'(1) = 1/2 > 0`.
pub fn signorini_closed_1d() -> Scene<1> {
    let exact = Exact::new(|x| -x[0] * (1.0 - x[0]) / 2.0, |x| Point::<1>::new(x[0] - 0.5))
        .with_multiplier(|_| 0.5)
        .with_contact(|_| 1.0, Vec::new());
    supported("signorini-closed-1d", "a string pressed onto its support", -1.0, exact)
}

/// A string on `(0, 1)`, fixed at 0, without load: `u = 0`, in contact at 1 without pressure.
pub fn signorini_grazing_1d() -> Scene<1> {
    let exact = Exact::new(|_| 0.0, |_| Point::zeros()).with_multiplier(|_| 0.0);
    supported("signorini-grazing-1d", "a string that touches without pressure", 0.0, exact)
        .regularity(Regularity::smooth().not_strictly_complementary())
}

/// A string on `(0, 1)`, fixed at 0, under a constant load, with zero gap at 1; its solution is smooth.
fn supported(name: &str, summary: &'static str, load: f64, exact: Exact<1>) -> Scene<1> {
    let problem = zero_gap().constant_source(load).solved_by(exact).polynomial_data(0);
    Scene::new(
        name,
        BoxDomain::dirichlet(Point::repeat(0.0), Point::repeat(1.0)).side(
            0,
            1,
            BoundaryCondition::Contact,
        ),
        problem,
    )
    .summary(summary)
    .regularity(Regularity::smooth())
}
