//! The catalogue: every scene solves its inequality, and the check that says so can say no.

use unilateral::in_its_dimension;
use unilateral::problem::Exact;
use unilateral::real::Point;
use unilateral::scenes::check::Violation;
use unilateral::scenes::{AnyScene, Scene, check_scene};

mod catalogue;
mod closed_forms;
mod energies;
mod meshes;
mod refusals;
mod values;

const SAMPLES: usize = 1000;

fn check_any(scene: &AnyScene) -> Result<(), Violation> {
    in_its_dimension!(scene, |scene| check_scene(scene, SAMPLES))
}

fn exact<const D: usize>(scene: &Scene<D>) -> &Exact<D> {
    scene.problem.exact.as_ref().expect("the scene states its solution")
}

fn value<const D: usize>(scene: &Scene<D>, x: [f64; D]) -> f64 {
    exact(scene).value.at(&Point::from(x))
}

fn gradient<const D: usize>(scene: &Scene<D>, x: [f64; D]) -> [f64; D] {
    (exact(scene).gradient)(&Point::from(x)).into()
}

fn source<const D: usize>(scene: &Scene<D>, x: [f64; D]) -> f64 {
    scene.problem.source.everywhere.as_ref().map_or(0.0, |f| f.at(&Point::from(x)))
}

/// Equal to the digits a table prints.
fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
}
