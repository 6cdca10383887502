//! Lower bounds of the first eigenvalue of a mesh, and the guarantee of error bounds on domains with holes.

use unilateral::error_bound::{Unproven, least_eigenvalue};
use unilateral::mesh::{BoundaryCondition, BoxDomain, Domain, Mesh, TaggedFacet};
use unilateral::prelude::*;

/// The cells of a box of squares whose barycentres a function keeps; boundary facets have a condition by their middle.
fn part_of_square(
    half: f64,
    n: usize,
    keeps: impl Fn(&Point<2>) -> bool,
    condition: impl Fn(&Point<2>) -> BoundaryCondition,
) -> Mesh<2> {
    let whole = Mesh::<2>::kuhn_box(&BoxDomain::centred(half), [n, n]).unwrap();
    let kept: Vec<&[u32]> = (0..whole.n_cells())
        .filter(|&c| keeps(&whole.barycentre(c)))
        .map(|c| whole.cell(c))
        .collect();
    mesh_of(whole.vertices().to_vec(), kept.concat(), condition)
}

/// A mesh of these cells; edges of one cell have a condition by their middle.
fn mesh_of(
    vertices: Vec<Point<2>>,
    cells: Vec<u32>,
    condition: impl Fn(&Point<2>) -> BoundaryCondition,
) -> Mesh<2> {
    let edges = |cell: &[u32]| [[0, 1], [0, 2], [1, 2]].map(|[a, b]| [cell[a], cell[b]]);
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let all: Vec<[u32; 2]> = cells.chunks(3).flat_map(edges).map(sorted).collect();
    let ends = all.iter().filter(|edge| all.iter().filter(|other| other == edge).count() == 1);
    let facet = |&ends: &[u32; 2]| {
        let [x, y] = ends.map(|v| vertices[v as usize]);
        TaggedFacet { vertices: ends, condition: condition(&((x + y) * 0.5)) }
    };
    let facets: Vec<_> = ends.map(facet).collect();
    Mesh::new(vertices, cells, &facets).unwrap()
}

/// The square of side two with a slit from its centre to a side, whose vertices come twice.
fn slit(n: usize) -> Mesh<2> {
    let whole = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [2 * n, 2 * n]).unwrap();
    let mut vertices = whole.vertices().to_vec();
    let mut below: Vec<u32> = (0..vertices.len() as u32).collect();
    for v in 0..below.len() {
        if vertices[v][1] == 0.0 && vertices[v][0] > 0.0 {
            below[v] = vertices.len() as u32;
            vertices.push(vertices[v]);
        }
    }
    let side = |cell: usize, v: u32| match whole.barycentre(cell)[1] < 0.0 {
        true => below[v as usize],
        false => v,
    };
    let of_cell = |cell: usize| whole.cell(cell).iter().map(move |&v| side(cell, v));
    let cells = (0..whole.n_cells()).flat_map(of_cell).collect();
    mesh_of(vertices, cells, |_| BoundaryCondition::Dirichlet)
}

/// Known eigenvalues bound those that are found from above; twice these, on fine meshes, from below.
#[test]
fn eigenvalues_are_bounded_from_below() {
    use std::f64::consts::PI;
    let square = |n: usize| {
        let domain = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
        Mesh::kuhn_box(&domain, [n, n]).unwrap()
    };
    let left = |n: usize| {
        let mut domain = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
        for (axis, end) in [(0, 1), (1, 0), (1, 1)] {
            domain = domain.side(axis, end, BoundaryCondition::Neumann);
        }
        Mesh::kuhn_box(&domain, [n, n]).unwrap()
    };
    let l_shape = |n: usize| Domain::<2>::LShape { half: 1.0 }.mesh(n).unwrap();
    let known: [(&dyn Fn(usize) -> Mesh<2>, f64); 4] = [
        (&square, 2.0 * PI * PI),
        (&left, PI * PI / 4.0),
        (&l_shape, 9.639_723_844),
        (&slit, 8.371_329_711),
    ];
    for (mesh, known) in known {
        for n in [1, 2, 4, 16] {
            let found = least_eigenvalue(&mesh(n)).unwrap().unwrap();
            assert!(found > 0.0 && found <= known, "{n}: {found} for {known}");
            assert!(n < 16 || found > 0.45 * known, "{n}: {found} for {known}");
        }
    }
    let cube = |n: usize| {
        let domain = BoxDomain::<3>::dirichlet(Point::zeros(), Point::repeat(1.0));
        Mesh::kuhn_box(&domain, [n; 3]).unwrap()
    };
    let found = least_eigenvalue(&cube(5)).unwrap().unwrap();
    assert!(found <= 3.0 * PI * PI && found > 9.0, "{found}");
    let free = BoxDomain::<1>::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(0, 1, BoundaryCondition::Neumann);
    assert_eq!(least_eigenvalue(&Mesh::<1>::kuhn_box(&free, [4]).unwrap()).unwrap(), None);
}

/// A square with a hole that alone is held: along no axis all lines begin on it.
#[test]
fn bounds_are_guaranteed_on_a_plate_with_a_hole() {
    let is_hole = |x: &Point<2>| x.amax() < 1.0;
    let on_hole = |x: &Point<2>| match x.amax() < 1.5 {
        true => BoundaryCondition::Dirichlet,
        false => BoundaryCondition::Neumann,
    };
    let mesh = part_of_square(3.0, 6, |x| !is_hole(x), on_hole);
    let problem = Problem::new().constant_source(-1.0).obstacle_below(|_| -1.0);
    let problem = problem.obstacles_of_degree(0);
    for scheme in [&ConformingP1 as &dyn Scheme<2>, &ConformingP2, &Sipg::default()] {
        let bound = solve(&problem, &mesh, scheme).unwrap().bound().unwrap();
        assert_eq!(bound.unproven, [], "{}", scheme.name());
        assert!(bound.terms.algebra < 1e-6, "{}: {}", scheme.name(), bound.terms.algebra);
    }
    // without Dirichlet data there is no constant
    let free = part_of_square(3.0, 6, |x| !is_hole(x), |_| BoundaryCondition::Neumann);
    let bound = solve(&problem, &free, &Sipg::default()).unwrap().bound().unwrap();
    assert!(bound.unproven.iter().all(|term| *term == Unproven::Algebra));
}
