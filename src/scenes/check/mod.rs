//! A numerical test of the derivation of a scene's solution, for authors of scenes.
//!
//! ```
//! use unilateral::scenes::{check_scene, radial};
//!
//! check_scene(&radial::<2>(1.0), 200).unwrap();
//! ```

mod boundary;
mod data;
mod differences;
mod evaluator;
mod interior;
mod on_mesh;
mod samples;
mod stated;
mod violation;

pub(crate) use on_mesh::check_exact_on;
pub use violation::Violation;

use super::scene::Scene;
use crate::mesh::Domain;
use crate::real::Point;
use evaluator::Evaluator;

/// Tests data and exact solution of a scene against each other, at `samples` quasi-random points of its
/// domain and of each side. The points are the same in every run.
///
/// In this order: all data are finite (also at the corners, at the origin and on a lattice that
/// meshes share); bounds are in order; and, where an exact solution is stated,
///
/// * its gradient is that of its value, by fourth-order central differences;
/// * the solution satisfies the obstacles; the multiplier `-div(alpha grad u) + c u - f` vanishes off
///   contact and on contact has the sign of the active obstacle;
/// * the solution satisfies the boundary data, and the Signorini conditions on contact sides;
/// * stated multiplier and contact set are those of the solution.
///
/// The step of differences is reduced, from a thousandth of the shortest side, until three successive
/// differences agree. A point where they never agree lies on an interface or at a singularity and is
/// skipped. No more than a quarter of the points may be.
///
/// On a domain that is a mesh the conditions on the solution are tested at barycentres of cells and of facets of the
/// boundary.
///
/// Tolerances are relative to the largest values met, `1e-6` for the multiplier and the gradient
/// and `1e-8` for the rest. Errors confined to regions without sample points are not detected, nor are jumps and kinks
/// of the solution between them.
///
/// # Errors
///
/// The first [`Violation`] found.
pub fn check_scene<const D: usize>(scene: &Scene<D>, samples: usize) -> Result<(), Violation> {
    if let Domain::Mesh(mesh) = &scene.domain {
        return check_exact_on(&scene.name, &scene.problem, mesh);
    }
    let samples = samples.max(2);
    let inside = samples::inside(&scene.domain, samples);
    scene.check_data(&inside, samples)?;
    let Some(exact) = &scene.problem.exact else { return Ok(()) };
    let domain = &scene.domain;
    let data = (&scene.problem, exact);
    let evaluator = Evaluator::new(&scene.name, data, domain.length(), &inside);
    let depth = |x: &Point<D>| domain.depth(x);
    evaluator.check_gradient(&inside, &depth)?;
    evaluator.check_obstacles(&inside)?;
    evaluator.check_multiplier(&inside, &depth)?;
    evaluator.check_boundary(domain, samples)?;
    evaluator.check_free_boundary(&inside)
}
