//! Schemes on the unstructured meshes of the test data, beside box meshes of like size: every one in the plane, one of
//! each kind in space.
//!
//! `tests/data/unstructured.py` makes the meshes.

use crate::runs::small_mesh;
use crate::support::checks::Checks;
use crate::support::rows::label;
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::{Row, check_fit};

const IN_SPACE: [&str; 9] =
    ["p1", "p2", "cr", "sipg", "nipg", "wopsip", "ldg", "sipg-p2", "wopsip-p2"];

fn names(dimension: usize) -> Vec<&'static str> {
    match dimension {
        3 => IN_SPACE.to_vec(),
        _ => SCHEMES.iter().map(|(name, _)| *name).collect(),
    }
}

/// The rows of the schemes by name.
fn rows<const D: usize>(study: Study<'static, D>) -> Vec<Row> {
    let schemes = names(D).into_iter().map(|name| scheme_by_name(name, &SchemeOptions::default()));
    schemes.fold(study, |study, scheme| study.boxed_scheme(scheme.unwrap())).run().unwrap().rows
}

/// Each scheme converges, with errors at most this factor from those on the mesh of the scene's own
/// domain with about as many cells.
fn like_a_box<const D: usize>(name: &str, scene: fn() -> Scene<D>, level: usize, factor: f64) {
    let mesh = small_mesh::<D>(name);
    assert_eq!(
        check_fit(&scene().domain(mesh.clone())).unwrap(),
        None,
        "the exact solution does not hold"
    );
    let mut checks = Checks::default();
    let found = rows(Study::new(scene().domain(mesh)).levels([0]));
    let boxes = rows(Study::new(scene()).levels([level]));
    assert_eq!(found.len(), names(D).len());
    for (row, like) in found.iter().zip(&boxes) {
        let cells = row.cells as f64 / like.cells as f64;
        checks
            .that((0.6..1.6).contains(&cells), || format!("{} cells of {}", row.cells, like.cells));
        checks.certified(row, 1e-9);
        for (norm, error, expected) in
            [("H1", row.error.h1, like.error.h1), ("L2", row.error.l2, like.error.l2)]
        {
            let [error, expected] = [error, expected].map(|e| e.unwrap_or(f64::NAN));
            let ratio = error / expected;
            checks.that(ratio < factor && ratio > 1.0 / factor, || {
                format!("{}: {norm} {error:.3e}, of the box {expected:.3e}", label(row))
            });
        }
    }
    checks.finish();
}

#[test]
fn obstacles_in_the_plane() {
    like_a_box("unstructured_square.msh", || scenes::radial::<2>(1.0), 13, 2.0);
}

#[test]
fn contact_in_the_plane() {
    like_a_box("unstructured_half_square.msh", scenes::signorini_2d, 8, 2.0);
    like_a_box("unstructured_half_square.msh", scenes::signorini_harmonic::<2>, 8, 3.0);
}

#[test]
fn obstacles_in_space() {
    like_a_box("unstructured_cube.msh", || scenes::radial::<3>(1.0), 4, 2.0);
}

#[test]
fn contact_in_space() {
    like_a_box("unstructured_half_cube.msh", scenes::signorini_harmonic::<3>, 3, 2.0);
}
