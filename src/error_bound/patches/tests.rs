use super::*;
use crate::assemble::{DataQuadrature, Discretisation};
use crate::mesh::{BoxDomain, Mesh};
use crate::problem::Problem;
use crate::scheme::ConformingP1;

/// Boxes with sides of different lengths.
fn mesh<const D: usize>(n: usize) -> Mesh<f64, D> {
    let far = Point::from_fn(|k, _| [1.0, 0.7, 1.9][k]);
    Mesh::kuhn_box(&BoxDomain::dirichlet(Point::zeros(), far), [n; D]).unwrap()
}

/// Some number for each of `n` indices.
fn numbers(n: usize) -> Vec<f64> {
    (0..n).map(|i| ((7 * i * i + 3 * i) % 23) as f64 - 11.0).collect()
}

/// The closed form for a tetrahedron without fixed fluxes, against the inverse of the matrix of products.
#[test]
fn the_closed_form_of_a_cell_in_space_is_the_general_one() {
    let (mesh, problem) = (mesh::<3>(1), Problem::new().coefficient(|x| 2.0 + x[0] - 0.5 * x[2]));
    let of =
        Discretisation::new(&ConformingP1, &problem, &mesh, DataQuadrature::default()).unwrap();
    let n = mesh.vertices().len();
    let neighbours = Neighbours::new(&mesh);
    let (zero, obstacles) = (vec![0.0; n], of.space.active_obstacles(&[], &[]));
    let of_solver = (&zero[..], &obstacles);
    let patches = of.space.patches(&numbers(n), of_solver, &[], &neighbours).ok().unwrap();
    for corner in (0..mesh.n_cells() as u32).flat_map(|cell| (0..4).map(move |own| (cell, own))) {
        let facets = [FacetOfPatch::Free; 3];
        let one = patches.free_cell_of_patch(corner, facets, 0.7);
        let other = patches.any_cell_of_patch(corner, facets, 0.7);
        assert!((one.slopes - other.slopes).norm() < 1e-12 * other.slopes.norm(), "{corner:?}");
        assert!((one.fluxes - other.fluxes).norm() < 1e-12 * other.fluxes.norm(), "{corner:?}");
        assert!((one.fluxes.sum() - 0.7).abs() < 1e-14);
    }
}

/// The parts of a few cells at a time, and of all cells, have the same bits; so do cells whose neighbours have
/// numbers far apart, which are one range.
fn ranges<const D: usize>() {
    let (mesh, problem) = (mesh::<D>(5), Problem::new().constant_source(1.5));
    let of =
        Discretisation::new(&ConformingP1, &problem, &mesh, DataQuadrature::default()).unwrap();
    let n = mesh.vertices().len();
    let neighbours = Neighbours::new(&mesh);
    let (zero, obstacles) = (vec![0.0; n], of.space.active_obstacles(&[], &[]));
    let of_solver = (&zero[..], &obstacles);
    let fluxes = |length: usize| {
        let patches = of.space.patches(&numbers(n), of_solver, &[], &neighbours).ok().unwrap();
        of.space.fluxes_by_ranges(length, patches).ok().unwrap()
    };
    let n_cells = mesh.n_cells();
    let whole = fluxes(n_cells);
    assert!(whole.iter().any(|flux| *flux != 0.0));
    let n_ranges = |length: usize| of.space.ranges_with_vertices(length).len();
    assert_eq!([n_cells, n_cells / 2 + 1, 1].map(n_ranges), [1, 2, 1]);
    assert_eq!(fluxes(n_cells / 2 + 1), whole);
    assert_eq!(fluxes(1), whole);
}

#[test]
fn fluxes_do_not_depend_on_ranges_of_cells() {
    ranges::<2>();
    ranges::<3>();
}
