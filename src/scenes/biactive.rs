//! Contact without force on a set of positive measure.

use super::dual_number::{DualNumber, positive_power};
use super::scene::{Scene, over_plane};
use crate::mesh::BoxDomain;
use crate::problem::Exact;
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
    let problem = over_plane().piecewise_source(move |x| -power(x)[2], |x| x[0]).solved_by(
        Exact::new(move |x| power(x)[0], move |x| Point::from([power(x)[1], 0.0]))
            .with_multiplier(|_| 0.0),
    );
    Scene::new("biactive-half-2d", BoxDomain::centred(1.0), problem)
        .summary("half of the membrane touches a plane obstacle without force")
        .regularity(Regularity::new(4.5).not_strictly_complementary())
}

/// The third example of Keith and Surowiec, see [`biactive_half_2d`]: contact without force in a ring,
/// with force around it.
///
/// On `(-1, 1)^2` with `psi = 0` the solution is `u = 256 s^4`, `s = max(1/4 - r^2, 0)`. The load
/// is `-Laplace u = -256 (48 r^2 s^2 - 16 s^3)` for `r^2 < 1/4`, zero up to `r^2 = 3/4` and -1
/// beyond, where the multiplier is 1; elsewhere it vanishes. `u` lies in `H^s` for `s < 9/2`.
pub fn biactive_ring_2d() -> Scene<2> {
    let hill = |x: &Point<2>| DualNumber::from_sphere(x, 0.25, -1.0).positive_power(4);
    let outside = |x: &Point<2>| x.norm_squared() > 0.75;
    let source = move |x: &Point<2>| {
        let pressed = if outside(x) { 1.0 } else { 0.0 };
        -256.0 * hill(x).laplacian - pressed
    };
    let exact = Exact::new(move |x| 256.0 * hill(x).value, move |x| hill(x).gradient * 256.0)
        .with_multiplier(move |x| if outside(x) { 1.0 } else { 0.0 });
    let problem = over_plane()
        .piecewise_source(source, |x| (x.norm_squared() - 0.25) * (x.norm_squared() - 0.75))
        .solved_by(exact);
    Scene::new("biactive-ring-2d", BoxDomain::centred(1.0), problem)
        .summary("a hill within a ring of contact without force within contact with force")
        .regularity(Regularity::new(4.5).not_strictly_complementary())
}
