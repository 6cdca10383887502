//! Scenes on meshes of Gmsh and their refinements: small ones of the test data, and those of a folder
//! that the variable `UNILATERAL_MESHES` names.

use crate::runs::{mesh_of_folder, small_mesh};
use crate::support::checks::Checks;
use crate::support::rows::label;
use crate::support::scheme_lists::all_schemes;
use crate::support::scheme_lists::entry;
use crate::support::schemes::Entry;
use unilateral::mesh::{BoundaryFacet, Mesh, TaggedFacet};
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::{Row, check_fit};

/// The rows of schemes on a mesh and its refinements.
fn rows_on<const D: usize>(
    mesh: Mesh<D>,
    scene: Scene<D>,
    schemes: Vec<Entry<D>>,
    refinements: impl IntoIterator<Item = usize>,
) -> Vec<Row> {
    let study = Study::<D>::new(scene.domain(mesh)).levels(refinements);
    let add =
        |study: Study<'static, D>, entry: Entry<D>| study.boxed_scheme_on(entry.scheme, entry.set);
    schemes.into_iter().fold(study, add).run().unwrap().rows
}

/// Orders of the errors of two meshes, in the second of which edges are `1 / 2^halvings` of those in
/// the first, and certificates. One quotient on unstructured meshes is no more than about an order,
/// so that the bands are wide. WOPSIP in space is not asymptotic: until cells are small against the
/// root of its factor the error of its missing consistency, of second order in H1 too, is the
/// larger part.
fn check_pair(checks: &mut Checks, coarse: &Row, fine: &Row, halvings: usize) {
    [coarse, fine].iter().for_each(|row| checks.certified(row, 1e-9));
    let early = fine.dimension == 3 && fine.scheme == "wopsip";
    let highest = if early { 1.6 } else { 1.1 };
    for (name, coarse, fine_error, band) in [
        ("H1", coarse.error.h1, fine.error.h1, [0.9, highest]),
        ("L2", coarse.error.l2, fine.error.l2, [1.75, 2.25]),
    ] {
        let [coarse, fine_error] = [coarse, fine_error].map(|e| e.unwrap_or(f64::NAN));
        let order = (coarse / fine_error).log2() / halvings as f64;
        checks.that(band[0] <= order && order <= band[1], || {
            format!("{}: {name} {coarse:.3e}, {fine_error:.3e}, order {order:.3}", label(fine))
        });
    }
}

/// Runs every scheme on two refinements of a mesh in the plane.
fn on(mesh: Mesh<2>, scene: Scene<2>, levels: [usize; 2]) {
    assert_eq!(
        check_fit(&scene.clone().domain(mesh.clone())).unwrap(),
        None,
        "the exact solution does not hold"
    );
    let mut checks = Checks::default();
    for pair in rows_on(mesh, scene, all_schemes(), levels).chunks(2) {
        check_pair(&mut checks, &pair[0], &pair[1], levels[1] - levels[0]);
        let halved = (pair[0].mesh_size / pair[1].mesh_size).log2();
        checks.close("halvings", halved, (levels[1] - levels[0]) as f64, 1e-12);
    }
    checks.finish();
}

/// Runs schemes on a mesh in space and its refinement.
fn on_refined(mesh: &Mesh<3>, build: fn() -> Scene<3>, schemes: fn() -> Vec<Entry<3>>) {
    assert_eq!(
        check_fit(&build().domain(mesh.clone())).unwrap(),
        None,
        "the exact solution does not hold"
    );
    let mut checks = Checks::default();
    let coarse = rows_on(mesh.clone(), build(), schemes(), [0]);
    let fine = rows_on(mesh.refine().unwrap().0, build(), schemes(), [0]);
    for (coarse, fine) in coarse.iter().zip(&fine) {
        check_pair(&mut checks, coarse, fine, 1);
    }
    checks.finish();
}

/// The schemes with few unknowns.
fn conforming_and_not() -> Vec<Entry<3>> {
    vec![entry(ConformingP1, Nodes), entry(NonconformingP1, Nodes)]
}

/// Certificates of every scheme on a mesh as it is.
fn certified(mesh: Mesh<3>, scene: Scene<3>) {
    let mut checks = Checks::default();
    rows_on(mesh, scene, all_schemes(), [0]).iter().for_each(|row| checks.certified(row, 1e-9));
    checks.finish();
}

/// The mesh with its last two axes exchanged.
fn turned(mesh: &Mesh<3>) -> Mesh<3> {
    let vertices = mesh.vertices().iter().map(|x| Point::<3>::new(x[0], x[2], x[1])).collect();
    let facet = |f: &BoundaryFacet| {
        let v: Vec<u32> = mesh.facet_vertices(f.cell as usize, f.local as usize).collect();
        TaggedFacet { vertices: [v[0], v[1], v[2]], condition: f.condition }
    };
    let boundary: Vec<TaggedFacet<3>> = mesh.boundary().iter().map(facet).collect();
    Mesh::new(vertices, mesh.cells().to_vec(), &boundary).unwrap()
}

fn radial_in_space() -> Scene<3> {
    scenes::radial(1.0)
}

/// The block of the folder, with contact at its lower end.
fn block() -> Mesh<3> {
    let mesh = mesh_of_folder("block.msh");
    // contact of the file is at y = 0, of the scene at z = 0: the gap contradicts the Dirichlet data
    let error = check_fit(&scenes::signorini_harmonic::<3>().domain(mesh.clone())).unwrap_err();
    assert!(error.to_string().contains("no admissible value"), "{error}");
    turned(&mesh)
}

#[test]
fn signorini_on_small_meshes() {
    let refine = |mesh: Mesh<2>| mesh.refine().unwrap().0;
    let plate = refine(refine(small_mesh("plate.msh")));
    on(plate.clone(), scenes::signorini_harmonic(), [0, 1]);
    on(plate.clone(), scenes::signorini_2d(), [0, 1]);
    on(plate, scenes::hertz_2d(), [0, 2]);
    let cube = small_mesh::<3>("cube.msh").refine().unwrap().0;
    on_refined(&cube, scenes::signorini_harmonic::<3>, all_schemes);
}

/// Refinement must not make cells much worse than they were: the volume over the cube of the
/// diameter, at its least.
fn keeps_shape(mesh: &Mesh<3>) {
    let shape = |mesh: &Mesh<3>| {
        let of = |c| mesh.geometry(c).volume / mesh.cell_diameter(c).powi(3);
        (0..mesh.n_cells()).map(of).fold(f64::INFINITY, f64::min)
    };
    let mut checks = Checks::default();
    let fine = mesh.refine().unwrap().0;
    let twice = fine.refine().unwrap().0;
    let [before, after, last] = [mesh, &fine, &twice].map(shape);
    checks.that(after > 0.9 * before, || format!("shape from {before:.2e} to {after:.2e}"));
    checks.that(last > 0.9 * before, || format!("shape from {before:.2e} to {last:.2e}"));
    let ratio = fine.mesh_size() / mesh.mesh_size();
    checks.that(ratio < 0.6, || format!("mesh size times {ratio:.2}"));
    checks.finish();
}

#[test]
fn refinement_keeps_the_shape_of_cells() {
    for name in ["cube.msh", "unstructured_cube.msh", "unstructured_half_cube.msh"] {
        keeps_shape(&small_mesh(name));
    }
}

mod needs_meshes {
    use super::*;

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn radial_obstacle_on_a_disc() {
        let mesh = mesh_of_folder("disc.msh");
        on(mesh, scenes::radial::<2>(1.0), [0, 1]);
    }

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn radial_obstacle_on_an_l_shape() {
        let mesh = mesh_of_folder("lshape.msh");
        on(mesh, scenes::radial::<2>(1.0), [0, 1]);
    }

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn signorini_on_a_graded_mesh() {
        let mesh = mesh_of_folder("half_square_graded.msh");
        on(mesh.clone(), scenes::signorini_harmonic::<2>(), [0, 1]);
        on(mesh.clone(), scenes::signorini_2d(), [0, 1]);
        // contact changes inside facets, so that L2 errors oscillate from one level to the next
        on(mesh, scenes::hertz_2d(), [0, 2]);
    }

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn hertz_contact_on_a_plate_with_holes() {
        let mesh = mesh_of_folder("plate_with_holes.msh");
        on(mesh, scenes::hertz_2d(), [1, 2]);
    }

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn radial_obstacle_on_a_ball() {
        let mesh = mesh_of_folder("ball.msh");
        on_refined(&mesh, radial_in_space, conforming_and_not);
        certified(mesh, radial_in_space());
    }

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn signorini_on_a_block_with_neumann_sides() {
        let mesh = block();
        on_refined(&mesh, scenes::signorini_harmonic::<3>, conforming_and_not);
        certified(mesh, scenes::signorini_harmonic::<3>());
    }

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn refinement_keeps_the_shape_of_many_cells() {
        keeps_shape(&mesh_of_folder("ball.msh"));
        keeps_shape(&mesh_of_folder("block.msh"));
    }
}

mod needs_meshes_and_time {
    use super::*;

    #[test]
    #[ignore = "needs the folder of meshes and a minute"]
    fn every_scheme_on_refined_meshes_in_space() {
        let (ball, block) = (mesh_of_folder("ball.msh"), block());
        on_refined(&ball, radial_in_space, all_schemes);
        on_refined(&block, scenes::signorini_harmonic::<3>, all_schemes);
    }
}
