//! Edges: every pair of vertices that a cell joins, once.

use std::collections::BTreeSet;

use unilateral::mesh::{BoxDomain, Edges, Facets, Mesh, Neighbours};
use unilateral::prelude::*;

/// The edges of a cell, ordered by their second vertex.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [1, 2], [0, 3], [1, 3], [2, 3]];

fn check<const D: usize>(counts: [usize; D]) -> usize {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<D>::kuhn_box(&domain, counts).unwrap();
    let (edges, numbers) = Edges::with_cell_edges(&mesh);
    let pairs = mesh.cells().chunks(D + 1).flat_map(|cell| {
        cell.iter().flat_map(|&a| cell.iter().map(move |&b| [a, b])).filter(|[a, b]| a < b)
    });
    // a sorted set numbers its members in lexicographic order
    let expected: Vec<[u32; 2]> = pairs.collect::<BTreeSet<_>>().into_iter().collect();
    assert_eq!(edges.len(), expected.len());
    let of_vertex = |a: u32| edges.upper_ends(a).iter().map(move |&b| [a, b]);
    let found = (0..mesh.vertices().len() as u32).flat_map(of_vertex);
    assert!(found.eq(expected.iter().copied()));
    let of_cell = &EDGES[..D * (D + 1) / 2];
    assert_eq!(numbers.len(), of_cell.len() * mesh.n_cells());
    for (cell, numbers) in mesh.cells().chunks(D + 1).zip(numbers.chunks(of_cell.len())) {
        for (&[i, j], &number) in of_cell.iter().zip(numbers) {
            assert_eq!([cell[i], cell[j]], expected[number as usize]);
        }
    }
    match D {
        1 => assert_eq!(edges.len(), mesh.n_cells()),
        2 => assert_eq!(edges.len(), Facets::new(&mesh, &Neighbours::new(&mesh)).len()),
        _ => {}
    }
    edges.len()
}

#[test]
fn every_pair_that_a_cell_joins_is_an_edge_once() {
    assert_eq!(check([5]), 5);
    // along the axes and diagonals
    assert_eq!(check([3, 2]), 9 + 8 + 6);
    // along axes, diagonals of faces, diagonals of cubes
    assert_eq!(check([2, 1, 1]), (8 + 6 + 6) + (4 + 4 + 3) + 2);
}
