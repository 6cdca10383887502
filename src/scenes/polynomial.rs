//! Powers of `r^2 - r0^2` and `r0^2 - r^2` over a plane obstacle, with and without force on contact.

use super::dual_number::DualNumber;
use super::free_boundary;
use super::scene::{Scene, over_plane};
use crate::mesh::BoxDomain;
use crate::problem::{Datum, Exact, Problem};
use crate::real::Point;
use crate::scheme::Regularity;

/// Radius of the free boundary.
const R0: f64 = 0.7;

/// The "constant obstacle" of Nochetto, Siebert and Veeser, *Numer. Math.* 95 (2003), in `D`
/// dimensions: `(-1, 1)^D`, `psi = 0`, contact in the ball `r <= r0 = 0.7`.
///
/// The solution is `u = s^2`, `s = max(r^2 - r0^2, 0)`. *Off contact*:
/// `-Laplace u = -8 r^2 - 4D s`, the load there. *On contact*: the load is
/// `f = -8 r0^2 (1 - r^2 + r0^2)` and the multiplier is `-f > 0`, since `r <= r0`. `f` is
/// continuous across `r = r0`, where both are `-8 r0^2`. The second derivatives jump: `C^{1,1}`,
/// `H^s` for `s < 5/2`.
pub fn polynomial<const D: usize>() -> Scene<D> {
    let force = |s: f64| 8.0 * R0 * R0 * (1.0 - s + R0 * R0);
    let source = move |x: &Point<D>| {
        let s = x.norm_squared();
        if s > R0 * R0 { -power::<D>(x, 2).laplacian } else { -force(s) }
    };
    let exact = Exact::new(|x| power(x, 2).value, |x| power(x, 2).gradient)
        .with_multiplier(move |x: &Point<D>| {
            let s = x.norm_squared();
            if s > R0 * R0 { 0.0 } else { force(s) }
        })
        .with_contact(|x| R0 - x.norm(), free_boundary::sphere(R0, 2.0));
    let problem = over_plane().piecewise_source(source, from_sphere).solved_by(exact);
    Scene::new(format!("polynomial-{D}d"), BoxDomain::centred(1.0), problem)
        .summary("a polynomial over a plane obstacle, continuous load, contact in a ball")
        .regularity(Regularity::new(2.5))
}

/// A hill in the ball `r < r0 = 0.7` on a plane obstacle, in `D` dimensions: `(-1, 1)^D`, `psi = 0`, contact
/// outside of the ball. All data are polynomials, so that bounds on errors are guaranteed.
///
/// The solution is `u = s^2`, `s = max(r0^2 - r^2, 0)`, zero on the boundary; the load is
/// `f = 4D (r0^2 - r^2) - 8 r^2` everywhere. *Off contact*: `-Laplace u = 4D s - 8 r^2 = f`. *On contact*: the
/// multiplier is `-f >= 8 r0^2`, since `r >= r0`. The second derivatives jump: `C^{1,1}`, `H^s` for `s < 5/2`.
pub fn hill<const D: usize>() -> Scene<D> {
    let load = |x: &Point<D>| -4.0 * D as f64 * from_sphere(x) - 8.0 * x.norm_squared();
    let solution = |x: &Point<D>| DualNumber::from_sphere(x, R0 * R0, -1.0).positive_power(2);
    let exact = Exact::new(move |x| solution(x).value, move |x| solution(x).gradient)
        .with_multiplier(move |x| if from_sphere(x) >= 0.0 { -load(x) } else { 0.0 })
        .with_contact(|x| x.norm() - R0, free_boundary::sphere(R0, 2.0));
    let problem = Problem { dirichlet: Datum::Constant(0.0).into(), ..over_plane() };
    let problem = problem.source(load).solved_by(exact).polynomial_data(2);
    Scene::new(format!("hill-{D}d"), BoxDomain::centred(1.0), problem)
        .summary("a hill on a plane obstacle, contact outside a ball; polynomial data")
        .regularity(Regularity::new(2.5))
}

/// `degenerate2-2d`, `degenerate3-2d` and `degenerate4-2d`: contact without force in the disc
/// `r <= r0 = 0.7`, left with order `k`.
///
/// On `(-1, 1)^2` with `psi = 0` the solution is `u = s^k`, `s = max(r^2 - r0^2, 0)`, and the load
/// is `f = -Laplace u = -4 k (k - 1) r^2 s^(k-2) - 4 k s^(k-1)`, zero for `r <= r0`. So the
/// multiplier vanishes everywhere and the data do not determine the contact set. `u` lies in `H^s` for
/// `s < k + 1/2`.
pub fn degenerate(k: i32) -> Scene<2> {
    let problem =
        over_plane().piecewise_source(move |x| -power(x, k).laplacian, from_sphere).solved_by(
            Exact::new(move |x| power(x, k).value, move |x| power(x, k).gradient)
                .with_multiplier(|_| 0.0),
        );
    Scene::new(format!("degenerate{k}-2d"), BoxDomain::centred(1.0), problem)
        .summary("contact with a plane obstacle in a disc, without any force")
        .regularity(Regularity::new(f64::from(k) + 0.5).not_strictly_complementary())
}

/// `r^2 - r0^2`.
fn from_sphere<const D: usize>(x: &Point<D>) -> f64 {
    x.norm_squared() - R0 * R0
}

/// `max(r^2 - r0^2, 0)^k`.
fn power<const D: usize>(x: &Point<D>, k: i32) -> DualNumber<D> {
    DualNumber::from_sphere(x, R0 * R0, 1.0).positive_power(k)
}
