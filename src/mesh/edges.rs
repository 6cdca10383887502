//! Edges: the pairs of vertices that some cell joins, each once.

use super::Mesh;
use crate::real::Real;

/// Vertices of the edges of a cell, by their numbers in it. A cell of dimension `D` has the first
/// `D (D + 1) / 2` of these.
///
/// They are ordered by their second vertex, so that a segment, a triangle and a tetrahedron number
/// the edges they share alike.
pub const EDGE_VERTICES: [[usize; 2]; 6] = [[0, 1], [0, 2], [1, 2], [0, 3], [1, 3], [2, 3]];

/// Vertices of the edges of a cell of this dimension.
pub const fn edge_vertices(dimension: usize) -> &'static [[usize; 2]] {
    EDGE_VERTICES.split_at(dimension * (dimension + 1) / 2).0
}

/// All edges of a mesh, numbered by their pairs of vertices in lexicographic order.
///
/// In one dimension they are the cells, in two the facets, under other numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edges {
    /// Number of the first edge that starts at each vertex, and the number of all edges.
    starts: Vec<u32>,
    /// The end of each edge that has the higher number.
    upper: Vec<u32>,
}

impl Edges {
    /// The edges of a mesh: a counting sort by the lower end, then tiny sorts.
    pub fn of<T: Real, const D: usize>(mesh: &Mesh<T, D>) -> Self {
        let n = mesh.vertices().len();
        let mut starts = vec![0_u32; n + 1];
        for cell in mesh.cells().chunks_exact(D + 1) {
            for (i, &a) in cell.iter().enumerate() {
                starts[a as usize + 1] += (D - i) as u32;
            }
        }
        for v in 0..n {
            starts[v + 1] += starts[v];
        }
        let mut upper = vec![0_u32; starts[n] as usize];
        let mut fill = starts.clone();
        for cell in mesh.cells().chunks_exact(D + 1) {
            for (i, &a) in cell.iter().enumerate() {
                for &b in &cell[i + 1..] {
                    upper[fill[a as usize] as usize] = b;
                    fill[a as usize] += 1;
                }
            }
        }
        let mut kept = 0;
        for v in 0..n {
            let (begin, end) = (starts[v] as usize, starts[v + 1] as usize);
            upper[begin..end].sort_unstable();
            starts[v] = kept as u32;
            for k in begin..end {
                let b = upper[k];
                if kept == starts[v] as usize || b != upper[kept - 1] {
                    upper[kept] = b;
                    kept += 1;
                }
            }
        }
        starts[n] = kept as u32;
        upper.truncate(kept);
        Self { starts, upper }
    }
    /// Number of edges.
    pub fn len(&self) -> usize {
        self.upper.len()
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.upper.is_empty()
    }
    /// Number of the first edge that starts at a vertex, or of all edges for the number of vertices.
    pub(super) fn first_at(&self, vertex: u32) -> u32 {
        self.starts[vertex as usize]
    }
    /// Number of the edge between `a < b`; none where no cell joins them.
    pub fn number(&self, a: u32, b: u32) -> Option<u32> {
        self.upper_ends(a).binary_search(&b).ok().map(|k| self.first_at(a) + k as u32)
    }
    /// The vertices of higher number at the other end of a vertex' edges, ascending.
    pub fn upper_ends(&self, a: u32) -> &[u32] {
        &self.upper[self.first_at(a) as usize..self.first_at(a + 1) as usize]
    }
    /// The number of every edge of every cell of the same mesh, in the order of [`edge_vertices`].
    pub fn numbers<T: Real, const D: usize>(&self, mesh: &Mesh<T, D>) -> Vec<u32> {
        let of_cell = |cell: &[u32], [i, j]: [usize; 2]| {
            // every pair of a cell's vertices is an edge
            self.number(cell[i], cell[j]).unwrap_or_default()
        };
        let cells = mesh.cells().chunks_exact(D + 1);
        cells.flat_map(|cell| edge_vertices(D).iter().map(move |&e| of_cell(cell, e))).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::{Edges, edge_vertices};
    use crate::mesh::{Facets, Mesh, Neighbours};
    use crate::real::Point;
    use crate::scenes::BoxDomain;

    fn check<const D: usize>(counts: [usize; D]) -> usize {
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let mesh = Mesh::<f64, D>::kuhn_box(&domain, counts).unwrap();
        let edges = Edges::of(&mesh);
        let pairs = mesh.cells().chunks(D + 1).flat_map(|cell| {
            cell.iter().flat_map(|&a| cell.iter().map(move |&b| [a, b])).filter(|[a, b]| a < b)
        });
        // a sorted set numbers its members in lexicographic order
        let expected: Vec<[u32; 2]> = pairs.collect::<BTreeSet<_>>().into_iter().collect();
        assert_eq!(edges.len(), expected.len());
        for (k, &[a, b]) in expected.iter().enumerate() {
            assert_eq!(edges.number(a, b), Some(k as u32));
        }
        let last = mesh.vertices().len() as u32 - 1;
        assert_eq!(edges.number(0, 0), None);
        assert_eq!(edges.number(last, 0), None);
        let numbers = edges.numbers(&mesh);
        let per_cell = edge_vertices(D).len();
        assert_eq!(numbers.len(), per_cell * mesh.n_cells());
        for (cell, numbers) in mesh.cells().chunks(D + 1).zip(numbers.chunks(per_cell)) {
            for (&[i, j], &number) in edge_vertices(D).iter().zip(numbers) {
                assert_eq!([cell[i], cell[j]], expected[number as usize]);
            }
        }
        match D {
            1 => assert_eq!(edges.len(), mesh.n_cells()),
            2 => assert_eq!(edges.len(), Facets::of(&mesh, &Neighbours::of(&mesh)).len()),
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
}
