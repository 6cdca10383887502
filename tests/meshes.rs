//! Scenes on unstructured meshes: small ones of the test data, and those of the folder beside the
//! project, where it exists.

mod support;

use support::accuracy::{Checks, all_schemes, label, rows_on, shared_mesh, small_mesh};
use unilateral::mesh::{BoundaryFacet, Mesh, TaggedFacet};
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::check_fit;

/// Runs every scheme on two refinements of a mesh. Orders count halvings of all edges, not mesh
/// sizes: the largest diameter need not be halved where tetrahedra are cut. One quotient on an
/// unstructured mesh is no more than about an order, so that the bands are wide.
fn on<const D: usize>(mesh: Mesh<f64, D>, scene: Scene<D>, levels: [usize; 2]) {
    assert!(check_fit(&scene, &mesh).unwrap(), "the exact solution does not hold");
    let mut checks = Checks::default();
    for pair in rows_on(mesh, scene, all_schemes(), levels).chunks(2) {
        pair.iter().for_each(|row| checks.certified(row, 1e-9));
        let [coarse, fine] = [&pair[0].error, &pair[1].error];
        for (name, coarse, fine, band) in
            [("H1", coarse.h1, fine.h1, [0.9, 1.1]), ("L2", coarse.l2, fine.l2, [1.75, 2.25])]
        {
            let [coarse, fine] = [coarse, fine].map(|e| e.unwrap_or(f64::NAN));
            let order = (coarse / fine).log2() / (levels[1] - levels[0]) as f64;
            checks.that(band[0] <= order && order <= band[1], || {
                format!("{}: {name} {coarse:.3e}, {fine:.3e}, order {order:.3}", label(&pair[1]))
            });
        }
    }
    checks.finish();
}

/// The mesh with its last two axes exchanged.
fn turned(mesh: &Mesh<f64, 3>) -> Mesh<f64, 3> {
    let vertices = mesh.vertices().iter().map(|x| Point::<f64, 3>::new(x[0], x[2], x[1])).collect();
    let facet = |f: &BoundaryFacet| {
        let v: Vec<u32> = mesh.facet_vertices(f.cell as usize, f.local as usize).collect();
        TaggedFacet { vertices: [v[0], v[1], v[2]], part: f.part }
    };
    let boundary: Vec<TaggedFacet<3>> = mesh.boundary().iter().map(facet).collect();
    Mesh::new(vertices, mesh.cells().to_vec(), &boundary).unwrap()
}

#[test]
fn radial_obstacle_on_a_disc() {
    let Some(mesh) = shared_mesh("disc.msh") else { return };
    on(mesh, scenes::radial::<2>(1.0), [0, 1]);
}

#[test]
fn radial_obstacle_on_an_l_shape() {
    let Some(mesh) = shared_mesh("lshape.msh") else { return };
    on(mesh, scenes::radial::<2>(1.0), [0, 1]);
}

#[test]
fn signorini_on_a_graded_mesh() {
    let Some(mesh) = shared_mesh("half_square_graded.msh") else { return };
    on(mesh.clone(), scenes::signorini_harmonic::<2>(), [0, 1]);
    on(mesh.clone(), scenes::signorini_2d(), [0, 1]);
    // contact changes inside facets, so that L2 errors oscillate from one level to the next
    on(mesh, scenes::hertz_2d(), [0, 2]);
}

#[test]
fn hertz_contact_on_a_plate_with_holes() {
    let Some(mesh) = shared_mesh("plate_with_holes.msh") else { return };
    on(mesh, scenes::hertz_2d(), [1, 2]);
}

#[test]
fn radial_obstacle_on_a_ball() {
    let Some(mesh) = shared_mesh("ball.msh") else { return };
    on(mesh, scenes::radial::<3>(1.0), [0, 1]);
}

#[test]
fn signorini_on_a_block_with_neumann_sides() {
    let Some(mesh) = shared_mesh("block.msh") else { return };
    // contact of the file is at y = 0, of the scene at z = 0
    assert!(!check_fit(&scenes::signorini_harmonic::<3>(), &mesh).unwrap());
    on(turned(&mesh), scenes::signorini_harmonic::<3>(), [0, 1]);
}

/// The small meshes, refined until orders show.
#[test]
fn signorini_on_small_meshes() {
    fn refined<const D: usize>(name: &str, times: usize) -> Mesh<f64, D> {
        (0..times).fold(small_mesh(name), |mesh: Mesh<f64, D>, _| mesh.refine().unwrap().0)
    }
    on(refined("plate.msh", 3), scenes::signorini_harmonic::<2>(), [0, 1]);
    on(refined("plate.msh", 3), scenes::signorini_2d(), [0, 1]);
    on(refined("cube.msh", 2), scenes::signorini_harmonic::<3>(), [0, 1]);
}
