//! Signorini conditions with solutions of any smoothness: gap and pressure vanish to high order where
//! contact changes.

use super::dual_number::{DualNumber, positive_power};
use super::free_boundary;
use super::scene::{Scene, zero_gap};
use crate::mesh::BoxDomain;
use crate::problem::{Datum, Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// `signorini-smooth2-2d`, `-smooth3-2d`, `-smooth4-2d`: gap and pressure both vanish with order
/// `k` where contact changes, at the origin.
///
/// The solution is that of `wedge` with `b = 0`, which lies in `H^s` for `s < k + 1/2`.
pub fn signorini_smooth(k: i32) -> Scene<2> {
    let exact = wedge(k, 0.0).with_contact(|x| -x[0], vec![Point::zeros()]);
    let problem = zero_gap()
        .piecewise_source(move |x| -wedge_solution(x, k, 0.0).laplacian, |x| x[0])
        .solved_by(exact);
    Scene::new(format!("signorini-smooth{k}-2d"), BoxDomain::above_contact(), problem)
        .summary("Signorini, gap and pressure vanish with the order in the name")
        .regularity(Regularity::new(f64::from(k) + 0.5))
}

/// `signorini-smooth2-2d` with a region on each side of the plane `x = 0`, where the load changes. Its data are
/// polynomials in each region, so that bounds on errors are guaranteed.
pub fn signorini_halves_2d() -> Scene<2> {
    let exact = wedge(2, 0.0).with_contact(|x| -x[0], vec![Point::zeros()]);
    let square = |x: &Point<2>| DualNumber::along(0, [x[0] * x[0], 2.0 * x[0], 2.0]);
    let pressed = move |x: &Point<2>| {
        (DualNumber::bubble(x) * square(x) * DualNumber::along(1, [x[1], 1.0, 0.0])).laplacian
    };
    let open = move |x: &Point<2>| -(DualNumber::bubble(x) * square(x)).laplacian;
    let problem = Problem { dirichlet: Datum::Constant(0.0).into(), ..zero_gap() }
        .source_in("pressed", Datum::polynomial(5, pressed))
        .source_in("open", Datum::polynomial(4, open))
        .solved_by(exact);
    let halves = BoxDomain::above_contact().in_halves(["pressed", "open"]);
    Scene::new("signorini-halves-2d", halves, problem)
        .summary("Signorini, left with order 2 between two regions; polynomial data")
        .regularity(Regularity::new(2.5))
}

/// Contact without pressure on a segment: on `|x| <= 1/4` both gap and pressure vanish.
///
/// The solution is that of `wedge` with `b = 1/4` and `k = 2`; the data do not determine the
/// contact set.
pub fn signorini_biactive_2d() -> Scene<2> {
    let problem = zero_gap()
        .piecewise_source(|x| -wedge_solution(x, 2, 0.25).laplacian, |x| x[0].abs() - 0.25)
        .solved_by(wedge(2, 0.25));
    Scene::new("signorini-biactive-2d", BoxDomain::above_contact(), problem)
        .summary("Signorini, gap and pressure both vanish on a segment")
        .regularity(Regularity::new(2.5).not_strictly_complementary())
}

/// `u = q (P - y N)` on `(-1, 1) x (0, 1)` with `q = (1 - x^2)(1 - y^2)`, `P = max(x - b, 0)^k` and
/// `N = max(-x - b, 0)^k`, and its pressure.
///
/// *Dirichlet sides*: `q = 0`. *Contact side*: `u = (1 - x^2) P >= 0` and, as `dq/dy = 0` there,
/// `sigma = -du/dy = (1 - x^2) N >= 0`; one of `P` and `N` vanishes.
fn wedge(k: i32, b: f64) -> Exact<2> {
    Exact::new(move |x| wedge_solution(x, k, b).value, move |x| wedge_solution(x, k, b).gradient)
        .with_multiplier(move |x| (1.0 - x[0] * x[0]) * positive_power(-x[0] - b, k)[0])
}

fn wedge_solution(x: &Point<2>, k: i32, b: f64) -> DualNumber<2> {
    let [value, first, second] = positive_power(-x[0] - b, k);
    let open = DualNumber::along(0, positive_power(x[0] - b, k));
    let pressed = DualNumber::along(0, [value, -first, second]);
    DualNumber::bubble(x) * (open - DualNumber::along(1, [x[1], 1.0, 0.0]) * pressed)
}

/// `signorini-disc2-3d` and `-disc3-3d`: contact in a disc in space, left with order `k`.
///
/// On `(-1, 1)^2 x (0, 1)`, zero gap, the solution is `u = max(p, 0)^k - z max(-p, 0)^k` with
/// `p = x^2 + y^2 - 1/4`; the load is `-Laplace u`. *Contact side*: `u = max(p, 0)^k` and
/// `sigma = max(-p, 0)^k`. `u` lies in `H^s` for `s < k + 1/2`.
pub fn signorini_disc(k: i32) -> Scene<3> {
    let solution = move |x: &Point<3>| {
        let height = DualNumber::along(2, [x[2], 1.0, 0.0]);
        disc_power(x, 1.0, k) - height * disc_power(x, -1.0, k)
    };
    let exact = Exact::new(move |x| solution(x).value, move |x| solution(x).gradient)
        .with_multiplier(move |x| disc_power(x, -1.0, k).value)
        .with_contact(|x| -from_circle(x), free_boundary::circle(0.5, 2.0));
    let problem =
        zero_gap().piecewise_source(move |x| -solution(x).laplacian, from_circle).solved_by(exact);
    Scene::new(format!("signorini-disc{k}-3d"), BoxDomain::above_contact(), problem)
        .summary("Signorini in space, contact in a disc, left with the order in the name")
        .regularity(Regularity::new(f64::from(k) + 0.5))
}

/// `x^2 + y^2 - 1/4`.
fn from_circle(x: &Point<3>) -> f64 {
    x[0] * x[0] + x[1] * x[1] - 0.25
}

/// `max(sign p, 0)^k`.
fn disc_power(x: &Point<3>, sign: f64, k: i32) -> DualNumber<3> {
    let gradient = Point::<3>::new(x[0], x[1], 0.0) * (2.0 * sign);
    let p = DualNumber { value: sign * from_circle(x), gradient, laplacian: 4.0 * sign };
    p.positive_power(k)
}
