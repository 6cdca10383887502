//! A numerical test of a scene's derivation, for every author of a scene.
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
mod interfaces;
mod interior;
mod samples;
mod stated;
mod violation;

pub use violation::{Condition, Violation};

use super::scene::Scene;
use evaluator::Evaluator;

/// Tests that data and exact solution of a scene fit together, at `samples` quasi-random points of
/// its domain and as many of each side. The points are the same in every run.
///
/// In this order: all data are finite (also at the corners, at the origin and on a lattice that
/// meshes share); bounds are in order; and, where an exact solution is stated,
///
/// * its gradient is that of its value, by fourth-order central differences;
/// * value and flux have no jumps along the segments between successive points, except kinks that
///   an obstacle holds with a force of the right sign;
/// * it respects the obstacles, its multiplier `-div(alpha grad u) + c u - f` vanishes where none
///   is touched and has the sign of the one that is;
/// * it takes the boundary data, and fulfils the Signorini conditions on contact sides;
/// * multiplier and contact set are those of the solution, where they are stated.
///
/// Differences use steps from a thousandth of the shortest side downwards until three successive
/// ones agree; a point where none do lies on an interface or a singularity and is passed over. If
/// more than a quarter of the points are, that is [`Condition::Resolution`].
///
/// Tolerances are relative to the largest values met, `1e-6` for the multiplier and the gradient
/// and `1e-8` for the rest. Not seen are errors confined to regions that hold no sample.
///
/// # Errors
///
/// The first [`Violation`] found.
pub fn check_scene<const D: usize>(scene: &Scene<D>, samples: usize) -> Result<(), Violation> {
    let samples = samples.max(2);
    let inside = samples::inside(&scene.domain, samples);
    data::check(scene, &inside, samples)?;
    let Some(exact) = &scene.problem.exact else { return Ok(()) };
    let evaluator = Evaluator::new(scene, exact, &inside);
    interior::check_gradient(&evaluator, &inside)?;
    interfaces::check(&evaluator, &inside)?;
    interior::check_obstacles(&evaluator, &inside)?;
    interior::check_multiplier(&evaluator, &inside)?;
    boundary::check(&evaluator, samples)?;
    stated::check_free_boundary(&evaluator, &inside)
}
