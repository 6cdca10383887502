//! Widely used scenes without a solution in closed form, with reference values of the energy.

use std::f64::consts::{FRAC_PI_2, PI};

use super::scene::{Scene, zero_gap};
use crate::mesh::{BoundaryCondition, BoxDomain};
use crate::problem::Problem;
use crate::real::Point;
use crate::scheme::Regularity;

/// The spiral of C. Graeser, R. Kornhuber, *J. Comput. Math.* 27 (2009), section 7.1.1: an unloaded
/// membrane on `(-1, 1)^2`, zero on the boundary, over
/// `psi = sin(2 pi/r + pi/2 - theta) + r (r + 1)/(r - 2) - 3 r + 3.6`, 3.6 at the centre.
///
/// The obstacle oscillates infinitely often towards the centre; the solution is known to have finite
/// energy.
pub fn spiral_2d() -> Scene<2> {
    let obstacle = |x: &Point<2>| {
        let r = x.norm();
        if r < 1e-8 {
            return 3.6;
        }
        let phase = 2.0 * PI / r + FRAC_PI_2 - x[1].atan2(x[0]);
        phase.sin() + r * (r + 1.0) / (r - 2.0) - 3.0 * r + 3.6
    };
    let problem = Problem::new().obstacle_below(obstacle).reference_energy(34.48, 0.02);
    Scene::new("spiral-2d", BoxDomain::centred(1.0), problem)
        .summary("no load, a spiral obstacle; no closed solution")
        .regularity(Regularity::new(1.0))
}

/// A Signorini problem of F. Ben Belgacem, Y. Renard, *Math. Comp.* 72 (2003), with the sign of `u`
/// turned: `(0, 1)^2`, `f = 2 pi sin(2 pi x)`, contact with zero gap on `y = 0`, `u = 0` on
/// `y = 1`, no flux on the other sides.
///
/// Where contact changes the solution has the generic singularity: `H^s` for `s < 5/2`.
pub fn signorini_sine_2d() -> Scene<2> {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(0, 1, BoundaryCondition::Neumann)
        .side(1, 0, BoundaryCondition::Contact);
    let problem = zero_gap()
        .source(|x| 2.0 * PI * (2.0 * PI * x[0]).sin())
        .reference_energy(-0.461_754, 1e-6);
    Scene::new("signorini-sine-2d", domain, problem)
        .summary("Signorini with a load that pulls and pushes; no closed solution")
        .regularity(Regularity::new(2.5))
}

/// Torsion of a square bar that yields: on `(0, 1)^2` the stress function `u` is zero on the
/// boundary and bounded by the distance to it; `f` = `load` is twice the angle of twist.
///
/// `u` lies in every `W^{2,p}`, `p < infinity`, after H. Brezis, G. Stampacchia, *Bull. Soc. Math.
/// France* 96 (1968). Energies are known for the loads 5, 10 and 20.
pub fn torsion_2d(load: f64) -> Scene<2> {
    let distance = |x: &Point<2>| x[0].min(1.0 - x[0]).min(x[1].min(1.0 - x[1]));
    let problem = Problem::new().constant_source(load).obstacle_above(distance);
    let problem = known_at(
        load,
        problem,
        &[(5.0, -0.418_495, 1e-6), (10.0, -1.204_642, 1e-6), (20.0, -2.851_16, 1e-5)],
    );
    Scene::new("torsion-2d", BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)), problem)
        .summary("elastic-plastic torsion of a square bar; load is f; no closed solution")
        .regularity(Regularity::new(2.0))
}

/// A membrane under the load `f` = `load` on `(-1, 1)^2`, zero on the boundary, over the pyramid
/// `psi = 1/2 - max(|x|, |y|)`.
///
/// For `load = 0` contact is on the diagonals alone. The edges of the pyramid act with forces on
/// lines: `H^s` for `s < 3/2`. Energies are known for the loads -4 and 0.
pub fn pyramid_2d(load: f64) -> Scene<2> {
    let problem = Problem::new()
        .constant_source(load)
        .obstacle_below(|x: &Point<2>| 0.5 - x[0].abs().max(x[1].abs()));
    let problem = known_at(load, problem, &[(-4.0, 0.645_43, 1e-5), (0.0, 0.262_696, 1e-6)]);
    Scene::new("pyramid-2d", BoxDomain::centred(1.0), problem)
        .summary("a membrane over a pyramid; load is f; no closed solution")
        .regularity(Regularity::new(1.5))
}

/// The problem with its energy, if the load is one of those listed with energy and uncertainty.
fn known_at(load: f64, problem: Problem<2>, energies: &[(f64, f64, f64)]) -> Problem<2> {
    match energies.iter().find(|known| known.0 == load) {
        Some(&(_, value, uncertainty)) => problem.reference_energy(value, uncertainty),
        None => problem,
    }
}
