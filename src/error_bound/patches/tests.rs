use std::cell::RefCell;

use super::*;
use crate::assemble::{DataQuadrature, Discretisation};
use crate::mesh::{BoxDomain, Mesh, TaggedFacet};
use crate::problem::Problem;
use crate::real::Point;
use crate::scheme::{ConformingP1, ConformingP2};

/// Boxes with sides of different lengths; one side is not Dirichlet.
fn mesh<const D: usize>(n: usize) -> Mesh<D> {
    let far = Point::from_fn(|k, _| [1.0, 0.7, 1.9][k]);
    let domain = BoxDomain::dirichlet(Point::zeros(), far).side(1, 0, BoundaryCondition::Neumann);
    Mesh::kuhn_box(&domain, [n; D]).unwrap()
}

/// Some number for each of `n` indices.
fn numbers(n: usize) -> Vec<f64> {
    (0..n).map(|i| ((7 * i * i + 3 * i) % 23) as f64 - 11.0).collect()
}

/// The numbers that a function sets, sorted by cell and place in it.
fn collected(find: impl FnOnce(&dyn Fn(Corner, usize, f64))) -> Vec<(usize, usize, f64)> {
    let numbers = RefCell::new(Vec::new());
    find(&|corner, k, number| numbers.borrow_mut().push((corner.cell(), k, number)));
    let mut numbers = numbers.into_inner();
    numbers.sort_by_key(|&(cell, k, _)| (cell, k));
    numbers
}

/// In the plane the numbers along a fan, in space those from one number for each edge, are those of least squares
/// on facets where the equation of the vertex holds: inside the domain and on the Dirichlet boundary, here of a linear
/// function with a load.
fn direct_numbers_are_those_of_least_squares<const D: usize>() {
    let (mesh, problem) =
        (mesh::<D>(3), Problem::new().coefficient(|x: &Point<D>| 2.0 + x[0] - 0.5 * x[1]));
    let of =
        Discretisation::new(&ConformingP1, &problem, &mesh, DataQuadrature::default()).unwrap();
    let (u, neighbours) = (numbers(mesh.vertices().len()), Neighbours::new(&mesh));
    let inequality = of.inequality().unwrap();
    let mut residual = vec![0.0; u.len()];
    inequality.residual_f64(&u, &mut residual);
    let obstacles = of.space.active_obstacles(&[], &[]);
    let cells = of.space.linear_cells(&u, (&residual, &obstacles), &[], &neighbours).ok().unwrap();
    let corners = of.space.corners();
    let (mut fan, mut link) = (Vec::new(), Link::default());
    for vertex in 0..u.len() {
        let directly = collected(|set| match D {
            2 => assert!(cells.set_fan(vertex, &mut fan, set)),
            _ => assert!(cells.set_link(vertex, &mut link, set)),
        });
        let around = corners.at(vertex);
        let by_patch = collected(|set| Patch::default().solve(&cells, &neighbours, around, set));
        assert_eq!(directly.len(), by_patch.len());
        let largest = directly.iter().fold(0.0, |most: f64, (_, _, number)| most.max(number.abs()));
        for ((cell, k, one), (of_cell, of_k, other)) in directly.iter().zip(&by_patch) {
            assert_eq!((cell, k), (of_cell, of_k));
            // without a load some patches have no flux at all
            assert!((one - other).abs() <= 1e-11 * largest, "{vertex}: {one} {other}");
        }
    }
}

#[test]
fn direct_numbers_of_linears_are_those_of_least_squares() {
    direct_numbers_are_those_of_least_squares::<2>();
    direct_numbers_are_those_of_least_squares::<3>();
}

/// Two cells that have one vertex in common, and no link that is a sphere or a disc there.
#[test]
fn a_vertex_between_two_cells_without_a_common_facet_has_no_simple_link() {
    let above = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let below = above.map(|x| x.map(|x: f64| -x));
    let vertices = [[0.0; 3]].into_iter().chain(above).chain(below).map(Point::from).collect();
    let cells = [[0, 1, 2, 3], [0, 4, 5, 6]];
    let sides = cells.map(|[a, b, c, d]| [[a, b, c], [a, b, d], [a, c, d], [b, c, d]]);
    let dirichlet = |vertices| TaggedFacet { vertices, condition: BoundaryCondition::Dirichlet };
    let boundary: Vec<_> = sides.concat().into_iter().map(dirichlet).collect();
    let mesh = Mesh::<3>::new(vertices, cells.concat(), &boundary).unwrap();
    let problem = Problem::new().constant_source(1.0);
    let of =
        Discretisation::new(&ConformingP1, &problem, &mesh, DataQuadrature::default()).unwrap();
    let (u, neighbours) = (numbers(7), Neighbours::new(&mesh));
    let obstacles = of.space.active_obstacles(&[], &[]);
    let cells = of.space.linear_cells(&u, (&u, &obstacles), &[], &neighbours).ok().unwrap();
    let simple = |vertex| cells.set_link(vertex, &mut Link::default(), |_, _, _| ());
    assert_eq!((0..7).map(simple).collect::<Vec<_>>(), [false, true, true, true, true, true, true]);
}

/// The fluxes of a few cells at a time, and of all cells, have the same bits; so do cells whose neighbours have
/// numbers far apart, which are one range.
fn check_ranges<const D: usize>(flux_of: impl Fn(&Mesh<D>, usize) -> (Flux<D>, [usize; 3])) {
    let mesh = mesh::<D>(5);
    let n_cells = mesh.n_cells();
    let (whole, n_ranges) = flux_of(&mesh, n_cells);
    assert!((0..n_cells).any(|cell| whole.through(cell, 0) != 0.0));
    assert_eq!(n_ranges, [1, 2, 1]);
    assert_eq!(flux_of(&mesh, n_cells / 2 + 1).0, whole);
    assert_eq!(flux_of(&mesh, 1).0, whole);
}

fn ranges<const D: usize>() {
    let problem = Problem::new().constant_source(1.5);
    let n_ranges = |space: &Space<'_, D>| {
        let n_cells = space.mesh.n_cells();
        [n_cells, n_cells / 2 + 1, 1].map(|length| space.ranges_with_vertices(length).len())
    };
    check_ranges::<D>(|mesh, length| {
        let of =
            Discretisation::new(&ConformingP1, &problem, mesh, DataQuadrature::default()).unwrap();
        let (n, neighbours) = (of.space.dofs.size(), Neighbours::new(mesh));
        let (zero, obstacles) = (vec![0.0; n], of.space.active_obstacles(&[], &[]));
        let of_solver = (&zero[..], &obstacles);
        let cells = of.space.linear_cells(&numbers(n), of_solver, &[], &neighbours).ok().unwrap();
        (of.space.flux_of_patches(&cells, Some(&cells), &neighbours, length), n_ranges(&of.space))
    });
    check_ranges::<D>(|mesh, length| {
        let of =
            Discretisation::new(&ConformingP2, &problem, mesh, DataQuadrature::default()).unwrap();
        let (n, neighbours) = (of.space.dofs.size(), Neighbours::new(mesh));
        let (zero, obstacles) = (vec![0.0; n], of.space.active_obstacles(&[], &[]));
        let (u, of_solver) = (numbers(n), (&zero[..], &obstacles));
        let bounds = of.inequality().unwrap().bounds;
        let loads = of.space.cell_loads(&u, of_solver, (&bounds, &[]), &[], None);
        let (mut loads, function) =
            (loads.ok().unwrap(), of.space.admissible_function(&u, (&bounds, &[])));
        let cells = of.space.quadratic_cells((&u, &function), &neighbours, &mut loads);
        (of.space.flux_of_patches(&cells, None, &neighbours, length), n_ranges(&of.space))
    });
}

#[test]
fn fluxes_do_not_depend_on_ranges_of_cells() {
    ranges::<2>();
    ranges::<3>();
}
