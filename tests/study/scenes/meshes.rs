//! Meshes of the domains that are no boxes, and their levels.

use std::collections::HashSet;

use unilateral::error::Error;
use unilateral::mesh::{BoundaryCondition, Mesh, MeshErrorKind};
use unilateral::mesh::{BoxDomain, Domain};
use unilateral::real::Point;
use unilateral::scenes::{Scene, disc_2d, hill, lshape_2d, radial, spiral_2d};
use unilateral::scheme::ConformingP1;
use unilateral::study::Study;

/// Area of all cells.
fn area(mesh: &Mesh<2>) -> f64 {
    (0..mesh.n_cells()).map(|c| mesh.geometry(c).volume).sum()
}

/// Vertices up to rounding, whatever their order.
fn positions(mesh: &Mesh<2>) -> HashSet<[i64; 2]> {
    mesh.vertices().iter().map(|x| [x[0], x[1]].map(|t| (t * 1e9).round() as i64)).collect()
}

/// Smallest and largest angle, in degrees.
fn angles(mesh: &Mesh<2>) -> (f64, f64) {
    let (mut least, mut most) = (180.0_f64, 0.0_f64);
    for c in 0..mesh.n_cells() {
        let x: Vec<Point<2>> = mesh.cell(c).iter().map(|&v| mesh.vertices()[v as usize]).collect();
        for k in 0..3 {
            let angle = (x[(k + 1) % 3] - x[k]).angle(&(x[(k + 2) % 3] - x[k])).to_degrees();
            least = least.min(angle);
            most = most.max(angle);
        }
    }
    (least, most)
}

#[test]
fn the_l_shape_has_its_area_and_its_corner() {
    for n in [1, 2, 3, 8] {
        let mesh = Mesh::<2>::l_shape(2.0, n).unwrap();
        assert_eq!(mesh.n_cells(), 6 * n * n);
        assert_eq!(mesh.vertices().len(), (2 * n + 1).pow(2) - n * n);
        assert_eq!(mesh.boundary().len(), 8 * n);
        assert!((area(&mesh) - 12.0).abs() < 1e-12);
        assert!(mesh.vertices().contains(&Point::zeros()));
        assert!(mesh.vertices().iter().all(|x| x[0] <= 0.0 || x[1] >= 0.0));
        assert!(mesh.boundary().iter().all(|f| f.condition == BoundaryCondition::Dirichlet));
        assert!(mesh.is_supported());
    }
}

#[test]
fn discs_have_round_boundaries_and_good_angles() {
    for n in [1, 2, 3, 8, 32] {
        let mesh = Mesh::<2>::disc(1.0, n).unwrap();
        assert_eq!(mesh.n_cells(), 6 * n * n);
        assert_eq!(mesh.boundary().len(), 6 * n);
        for facet in mesh.boundary() {
            for v in mesh.facet_vertices(facet.cell as usize, facet.local as usize) {
                assert!((mesh.vertices()[v as usize].norm() - 1.0).abs() < 1e-15);
            }
        }
        // of the regular polygon with as many corners
        let polygon = 3.0 * n as f64 * (std::f64::consts::TAU / (6 * n) as f64).sin();
        assert!((area(&mesh) - polygon).abs() < 1e-12);
        let (least, most) = angles(&mesh);
        assert!(least > 30.0 && most < 90.0, "n = {n}: angles {least} to {most}");
    }
}

#[test]
fn refined_levels_are_the_finer_meshes() {
    for domain in [Domain::<2>::Disc { radius: 1.5 }, Domain::LShape { half: 2.0 }] {
        for n in [1, 3, 4] {
            let coarse = domain.mesh(n).unwrap();
            let (fine, refinement) = domain.refine(&coarse).unwrap();
            let direct = domain.mesh(2 * n).unwrap();
            assert_eq!(fine.n_cells(), direct.n_cells());
            assert_eq!(positions(&fine), positions(&direct), "{domain:?}, n = {n}");
            assert_eq!(refinement.parents.len(), fine.vertices().len());
            assert!((area(&fine) - area(&direct)).abs() < 1e-12);
            assert_eq!(domain.cells(2 * n), direct.n_cells() as f64);
        }
    }
}

#[test]
fn shapes_of_the_plane_refuse_what_they_cannot_be() {
    for (shape, name) in
        [(Domain::<3>::Disc { radius: 1.0 }, "disc"), (Domain::LShape { half: 1.0 }, "L-shape")]
    {
        let Err(error) = shape.mesh(2) else { panic!("a {name} in space") };
        let said = format!("dimension = 3: a mesh of the {name} needs two");
        assert_eq!((error.kind, error.to_string()), (MeshErrorKind::Parameter, said));
    }
    for (half, n, wrong) in [(1.0, 0, "subdivisions"), (-1.0, 2, "length"), (f64::NAN, 2, "length")]
    {
        for made in [Mesh::<2>::disc(half, n), Mesh::<2>::l_shape(half, n)] {
            let Err(error) = made else { panic!("made {half}, {n}") };
            assert_eq!(error.kind, MeshErrorKind::Parameter, "{error}");
            assert!(error.to_string().starts_with(&format!("{wrong} = ")), "{error}");
        }
    }
    let huge = Mesh::<2>::disc(1.0, 1 << 20);
    assert!(huge.is_err_and(|error| error.kind == MeshErrorKind::TooLarge));
}

/// Nested starts pass through the curved refinement: the finer level begins from the coarser one.
#[test]
fn studies_run_on_both_shapes_from_coarser_levels() {
    for (scene, least_order) in [(disc_2d(), 0.8), (lshape_2d(), 0.6)] {
        let name = scene.name.clone();
        let report = Study::<2>::new(scene).scheme(ConformingP1).levels([8, 16, 32]).run().unwrap();
        for row in &report.rows {
            assert!(row.converged(), "{name} {}", row.level);
        }
        let last = &report.rows[2];
        assert_eq!(last.iterations.levels, 3);
        let order = last.order.h1.unwrap();
        assert!(order > least_order && order < 1.3, "{name}: order {order}");
    }
}

/// Zero is the datum of the spiral on its own boundary, but the obstacle is 3.6 high at the origin.
#[test]
fn a_mesh_on_which_an_obstacle_leaves_no_room_for_the_datum_does_not_fit() {
    let unit = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&unit, [4, 4]).unwrap();
    let check = |scene: Scene<2>| {
        Study::<2>::new(scene.domain(mesh.clone())).scheme(ConformingP1).levels([0]).check()
    };
    for (scene, expected) in [
        (spiral_2d(), "the mesh does not fit spiral-2d: no admissible value"),
        (hill::<2>(), "the mesh does not fit hill-2d: its exact solution is 0.2400999"),
    ] {
        let Err(Error::UnfitMesh(why)) = check(scene) else { panic!("it fits") };
        assert!(why.starts_with(expected), "{why}");
    }
    check(radial::<2>(1.0)).unwrap();
}
