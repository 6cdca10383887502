//! Scenes on unstructured meshes: small ones of the test data, and those of the folder beside the
//! project, where it exists.

mod support;

use support::accuracy::{Checks, all_schemes, label, rows_on, shared_mesh, small_mesh};
use unilateral::mesh::Mesh;
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::check_fit;

/// Runs every scheme on a mesh and one refinement. `h1` and `l2` are bands of the orders; one
/// refinement is a single quotient on an unstructured mesh, so that they are wide.
fn on<const D: usize>(mesh: Mesh<f64, D>, scene: Scene<D>, h1: [f64; 2], l2: [f64; 2]) {
    assert!(check_fit(&scene, &mesh).unwrap(), "the exact solution does not hold");
    let mut checks = Checks::default();
    for row in &rows_on(mesh, scene, all_schemes(), [0, 1]) {
        checks.certified(row, 1e-9);
        if row.level == 0 {
            continue;
        }
        for (name, order, band) in [("H1", row.order.h1, h1), ("L2", row.order.l2, l2)] {
            let order = order.unwrap_or(f64::NAN);
            let holds = band[0] <= order && order <= band[1];
            checks.that(holds, || format!("{}: {name} of order {order:.3}", label(row)));
        }
    }
    checks.finish();
}

const H1: [f64; 2] = [0.9, 1.1];
const L2: [f64; 2] = [1.8, 2.2];

#[test]
fn radial_obstacle_on_a_disc() {
    let Some(mesh) = shared_mesh("disc.msh") else { return };
    on(mesh, scenes::radial::<2>(1.0), H1, L2);
}

#[test]
fn radial_obstacle_on_an_l_shape() {
    let Some(mesh) = shared_mesh("lshape.msh") else { return };
    on(mesh, scenes::radial::<2>(1.0), H1, L2);
}

#[test]
fn signorini_on_a_graded_mesh() {
    let Some(mesh) = shared_mesh("half_square_graded.msh") else { return };
    on(mesh.clone(), scenes::signorini_harmonic::<2>(), H1, L2);
    on(mesh.clone(), scenes::signorini_2d(), H1, L2);
    on(mesh, scenes::hertz_2d(), H1, L2);
}

#[test]
fn hertz_contact_on_a_plate_with_holes() {
    let Some(mesh) = shared_mesh("plate_with_holes.msh") else { return };
    on(mesh, scenes::hertz_2d(), H1, L2);
}

#[test]
fn radial_obstacle_on_a_ball() {
    let Some(mesh) = shared_mesh("ball.msh") else { return };
    on(mesh, scenes::radial::<3>(1.0), H1, L2);
}

#[test]
fn signorini_on_a_block_with_neumann_sides() {
    let Some(mesh) = shared_mesh("block.msh") else { return };
    on(mesh, scenes::signorini_harmonic::<3>(), H1, L2);
}

/// The small meshes, refined until orders show.
#[test]
fn signorini_on_small_meshes() {
    fn refined<const D: usize>(name: &str, times: usize) -> Mesh<f64, D> {
        (0..times).fold(small_mesh(name), |mesh: Mesh<f64, D>, _| mesh.refine().unwrap().0)
    }
    on(refined("plate.msh", 3), scenes::hertz_2d(), H1, L2);
    on(refined("plate.msh", 3), scenes::signorini_2d(), H1, L2);
    on(refined("cube.msh", 2), scenes::signorini_harmonic::<3>(), H1, L2);
}
