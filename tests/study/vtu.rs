//! Files of fields, read back: encoding, cells, points, fields on cells and on the contact boundary.

use std::path::Path;

use unilateral::element::{Element, P2};
use unilateral::mesh::{BoundaryCondition, BoxDomain, Domain, GroupedFacet, Mesh};
use unilateral::paraview::VtuFile;
use unilateral::prelude::*;
use unilateral::problem_file;
use unilateral::real::Point;
use unilateral::scenes::AnyScene;
use unilateral::scenes::Scene;
use unilateral::study::file_name;

use crate::support::scratch::Scratch;
use crate::vtu_grid::{Grid, read};

fn cube<const D: usize>(lower: f64, upper: f64) -> BoxDomain<D> {
    BoxDomain::dirichlet(Point::repeat(lower), Point::repeat(upper))
}

/// Writes a field that jumps from cell to cell on a box, and reads it back without a digit lost.
fn round_trip<const D: usize>(counts: [usize; D], degree: usize, cell_type: usize) {
    let mesh = Mesh::<D>::kuhn_box(&cube::<D>(-1.0, 0.5), counts).unwrap();
    let cells = mesh.n_cells();
    let n = [D + 1, (D + 1) * (D + 2) / 2][degree - 1];
    let u: Vec<f64> = (0..cells * n).map(|i| (i as f64).sqrt() - 1e-17).collect();
    let multiplier: Vec<f64> = (0..cells).map(|c| 1.0 / (1.0 + c as f64)).collect();
    let scratch = Scratch::new(&format!("vtu-{D}-{degree}"));
    let path = scratch.0.join("fields.vtu");
    let file = VtuFile::new(&mesh, &u).function_in_cells("sum", |_, x| x.sum());
    file.on_cells("a<b", &multiplier).write(&path).unwrap();

    let grid = read(&path);
    let points = grid.points();
    assert_eq!(points.len(), cells * n, "every cell has points of its own");
    assert_eq!(grid.floats("PointData", "u"), u);
    let sums = grid.floats("PointData", "sum");
    assert!(sums.iter().zip(&points).all(|(sum, x)| (sum - x.sum()).abs() < 1e-15));
    let (of_cells, of_facets) = ([D, cell_type], [D - 1, [1, 3, 5][D - 1]]);
    let facets = mesh.boundary().len();
    let list = |k: usize| [vec![of_cells[k]; cells], vec![of_facets[k]; facets]].concat();
    assert_eq!(grid.integers("CellData", "dimension"), list(0));
    assert_eq!(grid.integers("Cells", "types"), list(1));
    let values = grid.floats("CellData", "a&lt;b");
    assert_eq!(values[..cells], multiplier);
    assert!(values.len() == cells + facets && values[cells..].iter().all(|x| x.is_nan()));
    let of_edges = [vec![[0, 1]], vec![[0, 1], [1, 2], [0, 2]]];
    let mut of_edges = of_edges[usize::from(D > 1)].clone();
    if D == 3 {
        of_edges.extend([[0, 3], [1, 3], [2, 3]]);
    }
    let mut total = 0.0;
    for (c, cell) in grid.cells()[..cells].iter().enumerate() {
        let mut sorted = cell.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (c * n..(c + 1) * n).collect::<Vec<_>>());
        let measure = grid.measure(&points, cell, D);
        assert!(measure > 0.0, "cell {c} is inside out");
        total += measure;
        if degree == 2 {
            for (k, [i, j]) in of_edges.iter().enumerate() {
                let middle = (points[cell[*i]] + points[cell[*j]]) / 2.0;
                assert!((points[cell[D + 1 + k]] - middle).norm() < 1e-15, "edge {k} of cell {c}");
            }
        }
        for (k, &v) in mesh.cell(c).iter().enumerate() {
            let x = mesh.vertices()[v as usize];
            assert!((0..D).all(|i| points[c * n + k][i] == x[i]));
        }
    }
    assert!((total - 1.5_f64.powi(D as i32)).abs() < 1e-12);
}

#[test]
fn fields_read_back_in_every_dimension_and_degree() {
    round_trip::<1>([7], 1, 3);
    round_trip::<2>([3, 2], 1, 5);
    round_trip::<3>([2, 1, 2], 1, 10);
    round_trip::<1>([7], 2, 21);
    round_trip::<2>([3, 2], 2, 22);
    round_trip::<3>([2, 1, 2], 2, 24);
}

/// More than one block of an array.
#[test]
fn long_arrays_are_cut_into_blocks() {
    let mesh = Mesh::<2>::kuhn_box(&cube::<2>(0.0, 1.0), [128, 128]).unwrap();
    let u: Vec<f64> = (0..3 * mesh.n_cells()).map(|i| (i as f64).sin()).collect();
    let scratch = Scratch::new("vtu-blocks");
    let path = scratch.0.join("fields.vtu");
    // a pressure of the air: steps of single precision would be 8e-3
    let air = |_: usize, x: &Point<2>| 101_325.0 + x[0];
    let file = VtuFile::new(&mesh, &u).function_in_cells("air", air);
    file.error_from_in_cells(|_, _| 0.0).write(&path).unwrap();
    let grid = read(&path);
    assert_eq!(grid.floats("PointData", "u"), u);
    assert_eq!(grid.floats("PointData", "error"), u);
    let expected: Vec<f64> = grid.points().iter().map(|x| 101_325.0 + x[0]).collect();
    assert_eq!(grid.floats("PointData", "air"), expected);
    assert_eq!(std::fs::read_dir(&scratch.0).unwrap().count(), 1, "no draft is left");
}

#[test]
fn fields_of_the_wrong_length_are_refused_by_name() {
    let mesh = Mesh::<2>::kuhn_box(&cube::<2>(0.0, 1.0), [1, 1]).unwrap();
    let scratch = Scratch::new("vtu-refused");
    let path = scratch.0.join("fields.vtu");
    let said = |file: VtuFile<'_, 2>| file.write(&path).unwrap_err().to_string();
    let u = [1.0; 6];
    let wrong = said(VtuFile::new(&mesh, &u[..5]));
    assert!(wrong.ends_with("field u has 5 values, the mesh needs 6"), "{wrong}");
    let wrong = said(VtuFile::new(&mesh, &u).on_cells("contact", &[0.0]));
    assert!(wrong.ends_with("field contact has 1 values, the mesh needs 2"), "{wrong}");
    let wrong = said(VtuFile::new(&mesh, &u).on_facets("gap", &[(0, 0)], &[]));
    assert!(wrong.ends_with("field gap has 0 values, the mesh needs 1"), "{wrong}");
    for place in [(2, 0), (0, 1)] {
        let wrong = said(VtuFile::new(&mesh, &u).on_facets("gap", &[place], &[0.0]));
        let (cell, local) = place;
        let end = format!("facet {local} of cell {cell} is not on the boundary of the mesh");
        assert!(wrong.ends_with(&end), "{wrong}");
    }
    assert_eq!(std::fs::read_dir(&scratch.0).unwrap().count(), 0, "nothing is written");
}

/// The file of a scheme on a scene, and the sum of the multipliers.
fn solution<const D: usize>(scene: &Scene<D>, scheme: &dyn Scheme<D>, level: usize) -> (Grid, f64) {
    let scratch =
        Scratch::new(&format!("vtu-{}", file_name(&format!("{}-{}", scene.name, scheme.name()))));
    let meshes = Hierarchy::<_>::of_domain(&scene.domain, level).unwrap();
    let solved = solve(&scene.problem, &meshes, scheme).unwrap();
    assert!(solved.converged());
    let path = scratch.0.join("fields.vtu");
    solved.write_vtu(&path).unwrap();
    (read(&path), solved.multiplier().unwrap().iter().sum())
}

#[test]
fn points_are_shared_where_the_space_shares_them() {
    let scene = scenes::radial::<2>(1.0);
    let size = |scheme: &dyn Scheme<2>| {
        let (grid, _) = solution(&scene, scheme, 4);
        (grid.points().len(), grid.integers("Cells", "types")[0])
    };
    // 5 by 5 vertices, 56 edges, 32 cells
    assert_eq!(size(&ConformingP1), (25, 5));
    assert_eq!(size(&ConformingP2), (81, 22));
    assert_eq!(size(&NonconformingP1), (96, 5));
    assert_eq!(size(&Sipg::default()), (96, 5));
    let quadratic = size(&*NamedScheme::list(["sipg-p2"]).unwrap()[0].make::<2>());
    assert_eq!(quadratic, (192, 22));
}

/// The solution at points inside a quadratic cell is that of the file.
#[test]
fn quadratics_are_written_as_quadratics() {
    let scene = scenes::radial::<2>(1.0);
    let meshes = Hierarchy::<_>::of_domain(&scene.domain, 4).unwrap();
    let solved = solve(&scene.problem, &meshes, &ConformingP2).unwrap();
    let (grid, _) = solution(&scene, &ConformingP2, 4);
    let (points, u) = (grid.points(), grid.floats("PointData", "u"));
    let error = grid.floats("PointData", "error");
    let exact = scene.problem.exact.as_ref().unwrap();
    let lambda = [0.2, 0.3, 0.5];
    for cell in &grid.cells()[..meshes.finest().n_cells()] {
        let x: Point<3> = (0..3).map(|k| points[cell[k]] * lambda[k]).sum();
        // the format has the edges (0, 1), (1, 2), (0, 2), the element (0, 1), (0, 2), (1, 2)
        let own = [0, 1, 2, 3, 5, 4].map(|k| u[cell[k]]);
        let mut basis = [0.0; 6];
        Element::<2>::values(&P2, &lambda, &mut basis);
        let value: f64 = own.iter().zip(basis).map(|(u, phi)| u * phi).sum();
        let expected = solved.value_at(&Point::from([x[0], x[1]])).unwrap();
        assert!((value - expected).abs() < 1e-12);
    }
    for (x, (u, error)) in points.iter().zip(u.iter().zip(&error)) {
        let expected = u - exact.value.at(&Point::from([x[0], x[1]]));
        assert!((error - expected).abs() < 1e-14);
    }
}

/// Whether the solution does not touch on both sides of every facet in contact.
fn is_broken(scheme: &str) -> bool {
    scheme.contains("sip")
}

/// The integral of the pressure over the contact boundary, as a reader of the file computes it, is the
/// total contact force, here the sum of the multipliers.
fn integrates<const D: usize>(scene: &Scene<D>, scheme: &dyn Scheme<D>, level: usize) {
    let (grid, force) = solution(scene, scheme, level);
    let (points, dimensions) = (grid.points(), grid.integers("CellData", "dimension"));
    let [pressure, gap, contact] =
        ["pressure", "gap", "contact"].map(|n| grid.floats("CellData", n));
    let Domain::Box(domain) = &scene.domain else { panic!("a box") };
    let sides = domain.sides.iter().flatten();
    let names = sides.zip(["left", "right", "bottom", "top", "back", "front"]);
    let contact_side =
        names.filter(|(side, _)| **side == BoundaryCondition::Contact).map(|(_, n)| n);
    let members: Vec<Vec<usize>> = contact_side.map(|n| grid.integers("CellData", n)).collect();
    let (mut total, mut touching) = (0.0, 0);
    for (c, cell) in grid.cells().iter().enumerate() {
        if members.iter().all(|side| side[c] == 0) {
            assert!(pressure[c].is_nan() && gap[c].is_nan() && contact[c].is_nan());
            continue;
        }
        // quadratic lines would not be integrated
        assert_eq!((dimensions[c], cell.len()), (D - 1, D));
        total += pressure[c] * grid.measure(&points, cell, D - 1);
        if contact[c] == 1.0 {
            touching += 1;
            let bound = if is_broken(scheme.name()) { 0.01 } else { 1e-9 };
            assert!(gap[c].abs() < bound, "{} {}: gap {}", scene.name, scheme.name(), gap[c]);
        }
    }
    assert!(touching > 0 && force > 0.0);
    let name = (&scene.name, scheme.name());
    assert!((total - force).abs() < 1e-10 * force, "{name:?}: {total} {force}");
}

#[test]
fn the_pressure_integrates_to_the_contact_force() {
    let names = ["p1", "p2", "cr", "sipg", "wopsip", "wopsip:facet-means", "sipg-p2"];
    for scheme in NamedScheme::list(names).unwrap() {
        let mut scene = scenes::signorini_2d();
        if let Some(set) = scheme.constraint_set() {
            scene.problem = scene.problem.on(set);
        }
        integrates(&scene, &*scheme.make(), 8);
    }
    integrates(&scenes::signorini_harmonic::<3>(), &Sipg::default(), 4);
    integrates(&scenes::signorini_closed_1d(), &ConformingP1, 8);
}

#[test]
fn the_multiplier_of_an_obstacle_integrates_to_the_sum_of_nodal_multipliers() {
    for scheme in NamedScheme::list(["p1", "cr", "sipg", "wopsip:facet-means", "p2"]).unwrap() {
        let mut scene = scenes::radial::<2>(1.0);
        if let Some(set) = scheme.constraint_set() {
            scene.problem = scene.problem.on(set);
        }
        let (grid, sum) = solution(&scene, &*scheme.make(), 8);
        let (points, multiplier) = (grid.points(), grid.floats("CellData", "multiplier"));
        let cells = grid.cells();
        let n = grid.integers("CellData", "dimension").iter().filter(|&&d| d == 2).count();
        let of_cell =
            |(cell, density): (&Vec<usize>, &f64)| grid.measure(&points, cell, 2) * density;
        let total: f64 = cells.iter().zip(&multiplier[..n]).map(of_cell).sum();
        assert!((total - sum).abs() < 1e-10 * sum, "{}: {total} {sum}", scheme.name());
    }
}

#[test]
fn a_study_writes_all_levels_on_request() {
    let scratch = Scratch::new("vtu-levels");
    let study = Study::<2>::new(scenes::radial(1.0)).scheme(Wopsip::default()).levels([4, 8]);
    study.fields_to(scratch.0.join("made")).fields_of_all_levels().run().unwrap();
    let list = scratch.read("made/radial-2d-wopsip.pvd");
    assert!(list.contains("timestep=\"4\"") && list.contains("file=\"radial-2d-wopsip-4.vtu\""));
    assert!(list.contains("timestep=\"8\"") && list.contains("file=\"radial-2d-wopsip.vtu\""));
    let grid = read(scratch.0.join("made/radial-2d-wopsip-4.vtu"));
    assert_eq!(grid.array("FieldData", "level").1, "4");
    assert_eq!(grid.names("PointData"), ["obstacle", "error", "u", "recovered_gradient"]);
    let scalars = ["bound", "normal_flux", "multiplier", "contact"];
    let fields = [&scalars[..], &["flux", "gradient", "dimension"]].concat();
    assert_eq!(grid.names("CellData"), [&fields[..], &["left", "right", "bottom", "top"]].concat());
    let shares = grid.floats("CellData", "bound").into_iter().filter(|share| !share.is_nan());
    let shares: f64 = shares.sum();
    assert!((shares - 1.0).abs() < 1e-6, "{shares}");
}

/// Against a reference the field is the difference from that, at the same points of its cells.
#[test]
fn the_error_is_the_difference_from_a_reference() {
    let scratch = Scratch::new("vtu-reference");
    let scene = scenes::radial::<2>(1.0);
    let exact = scene.problem.exact.clone().unwrap();
    let study = Study::<2>::new(scene).scheme(Wopsip::default()).levels([4]);
    let study = study.reference(ConformingP2, 64).fields_to(&scratch.0);
    study.run().unwrap();
    let grid = read(scratch.0.join(file_name("radial-2d-wopsip") + ".vtu"));
    let [u, error] = ["u", "error"].map(|name| grid.floats("PointData", name));
    let points = grid.floats("Points", "Points");
    let largest = error.iter().fold(0.0, |most: f64, e| most.max(e.abs()));
    assert!(largest > 1e-2, "{largest}");
    for ((x, u), error) in points.chunks(3).zip(u).zip(error) {
        let from_exact = u - exact.value.at(&Point::from([x[0], x[1]]));
        assert!((error - from_exact).abs() < 0.02 * largest, "{x:?}: {error} {from_exact}");
    }
}

/// A mesh far from the origin, whose points would be on few places if coordinates had 32 bits.
#[test]
fn points_keep_their_places_far_from_the_origin() {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/problems/utm.toml");
    let AnyScene::Two(own) = problem_file::read(&own).unwrap().scene else {
        panic!("in the plane")
    };
    let mesh = own.domain.mesh(0).unwrap();
    let meshes = Hierarchy::refine(&mesh, 3).unwrap();
    let solved = solve(&own.problem, &meshes, &ConformingP1).unwrap();
    let scratch = Scratch::new("vtu-utm");
    let path = scratch.0.join("fields.vtu");
    solved.write_vtu(&path).unwrap();
    let grid = read(&path);
    let mut points = grid.points();
    points.sort_by(|a, b| a.as_slice().partial_cmp(b.as_slice()).unwrap());
    points.dedup();
    assert_eq!((points.len(), grid.points().len()), (1473, 1473));
}

/// Regions and boundary groups are arrays of zeros and ones, called by their names.
#[test]
fn groups_are_arrays_of_small_integers() {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems/plate.toml");
    let AnyScene::Two(own) = problem_file::read(&own).unwrap().scene else {
        panic!("in the plane")
    };
    let mesh = own.domain.mesh(0).unwrap();
    let scratch = Scratch::new("vtu-groups");
    let path = scratch.0.join("fields.vtu");
    let solved = solve(&own.problem, &mesh, &ConformingP1).unwrap();
    solved.write_vtu(&path).unwrap();
    let grid = read(&path);
    let names = mesh.regions().iter().chain(mesh.boundary_groups().iter().map(|g| &g.names));
    let names: Vec<&String> = names.flatten().collect();
    assert!(names.len() > 4, "{names:?}");
    for name in names {
        assert_eq!(grid.array("CellData", name).0, "UInt8");
        let (cells, facets) = (0..mesh.n_cells(), mesh.boundary().iter());
        let cells = cells.map(|c| mesh.regions()[mesh.region(c)].contains(name));
        let facets =
            facets.map(|f| mesh.boundary_groups()[usize::from(f.group)].names.contains(name));
        let expected: Vec<usize> = cells.chain(facets).map(usize::from).collect();
        assert_eq!(grid.integers("CellData", name), expected, "{name}");
    }
}

/// A group with the name of a field has another array, one with control characters a name that the format has.
#[test]
fn names_of_groups_are_told_from_those_of_fields() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Point::from).to_vec();
    let names = ["contact", "a \"b\"\n\u{1}", "contact_group"].map(str::to_owned);
    let groups = [([0, 1], 0), ([1, 2], 1), ([0, 2], 2)];
    let facets = groups.map(|(vertices, group)| GroupedFacet { vertices, group });
    let mesh = Mesh::<2>::with_groups(corners, vec![0, 1, 2], &facets, &names).unwrap();
    let scratch = Scratch::new("vtu-names");
    let path = scratch.0.join("fields.vtu");
    let file = VtuFile::new(&mesh, &[0.0; 3]).on_facets("contact", &[(0, 2)], &[0.5]);
    file.write(&path).unwrap();
    let grid = read(&path);
    assert_eq!(grid.floats("CellData", "contact")[3], 0.5);
    let other = r"a &quot;b&quot;\n\u{1}";
    for (name, facet) in [("contact_group", 3), (other, 1), ("contact_group_group", 2)] {
        let mut expected = [0; 4];
        expected[facet] = 1;
        assert_eq!(grid.integers("CellData", name), expected, "{name}");
    }
}
