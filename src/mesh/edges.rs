//! Edges: the pairs of vertices that some cell joins, each once.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::Mesh;
use super::sweep::{Met, Sweep};
use crate::memory::in_large_pages;
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
    /// The edges of a mesh, in time linear in its cells.
    pub fn of<T: Real, const D: usize>(mesh: &Mesh<T, D>) -> Self {
        Self::found::<D>(mesh.cells(), mesh.vertices().len(), None)
    }
    /// The edges of a mesh, and the number of every edge of every cell in the order of
    /// [`edge_vertices`].
    pub fn numbered<T: Real, const D: usize>(mesh: &Mesh<T, D>) -> (Self, Vec<u32>) {
        let pairs = edge_vertices(D);
        let mut places = in_large_pages(Vec::with_capacity(pairs.len() * mesh.n_cells()));
        places.resize_with(pairs.len() * mesh.n_cells(), AtomicU32::default);
        let edges = Self::found::<D>(mesh.cells(), mesh.vertices().len(), Some(&places));
        let mut numbers: Vec<u32> = places.into_iter().map(AtomicU32::into_inner).collect();
        // so far these count from the first edge that starts at the lower vertex
        let cells = mesh.cells().par_chunks_exact(D + 1);
        cells.zip(numbers.par_chunks_exact_mut(pairs.len())).with_min_len(4096).for_each(
            |(cell, numbers)| {
                for (number, &[i, _]) in numbers.iter_mut().zip(pairs) {
                    *number += edges.starts[cell[i] as usize];
                }
            },
        );
        (edges, numbers)
    }
    /// The edges; at each edge of each cell its place among those of the same lower vertex.
    fn found<const D: usize>(
        cells: &[u32],
        n_vertices: usize,
        places: Option<&[AtomicU32]>,
    ) -> Self {
        let sweep = Sweep::<D>::new(cells, n_vertices, D);
        let ranges = sweep.ranges();
        let found = |vertices: &Range<u32>| upper_ends(&sweep, vertices.clone(), places);
        let mut found: Vec<(Vec<u32>, Vec<u32>)> = ranges.par_iter().map(found).collect();
        let mut starts = in_large_pages(Vec::with_capacity(n_vertices + 1));
        starts.push(0);
        let mut end = 0;
        for (_, degrees) in &found {
            starts.extend(degrees.iter().map(|degree| {
                end += degree;
                end
            }));
        }
        let upper = match &mut found[..] {
            [(only, _)] => std::mem::take(only),
            _ => found.iter().flat_map(|(upper, _)| upper).copied().collect(),
        };
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
    /// The number of every edge of every cell of the same mesh, in the order of [`edge_vertices`];
    /// by searches, where [`Edges::numbered`] has them as it finds the edges.
    pub fn numbers<T: Real, const D: usize>(&self, mesh: &Mesh<T, D>) -> Vec<u32> {
        let of_cell = |cell: &[u32], [i, j]: [usize; 2]| {
            // every pair of a cell's vertices is an edge
            self.number(cell[i], cell[j]).unwrap_or_default()
        };
        let cells = mesh.cells().chunks_exact(D + 1);
        cells.flat_map(|cell| edge_vertices(D).iter().map(move |&e| of_cell(cell, e))).collect()
    }
}

/// The higher ends of the edges of a range of lower vertices, and how many each has.
fn upper_ends<const D: usize>(
    sweep: &Sweep<'_, D>,
    vertices: Range<u32>,
    places: Option<&[AtomicU32]>,
) -> (Vec<u32>, Vec<u32>) {
    let mut met = Met::new(sweep.n_vertices());
    let (mut upper, mut degrees) = (Vec::new(), Vec::with_capacity(vertices.len()));
    // of each vertex the ends in the order in which they are met, and each edge of each cell
    let (mut ends, mut sides, mut ranks) = (Vec::new(), Vec::new(), Vec::new());
    for (_, cells) in sweep.around(vertices).each() {
        met.next_vertex();
        ends.clear();
        sides.clear();
        for (c, i) in cells {
            for (j, &end) in sweep.cell(c).iter().enumerate().skip(i + 1) {
                let number = met.with(end).unwrap_or_else(|| {
                    met.push(end);
                    ends.push(end);
                    ends.len() as u32 - 1
                });
                // edge (i, j) of a cell comes after those of lower second vertices
                sides.push((c * edge_vertices(D).len() + j * (j - 1) / 2 + i, number));
            }
        }
        rank(&ends, &mut ranks);
        let start = upper.len();
        upper.resize(start + ends.len(), 0);
        for (&end, &rank) in ends.iter().zip(&ranks) {
            upper[start + rank as usize] = end;
        }
        degrees.push(ends.len() as u32);
        if let Some(places) = places {
            for &(side, number) in &sides {
                places[side].store(ranks[number as usize], Ordering::Relaxed);
            }
        }
    }
    (upper, degrees)
}

/// Longest list ranked by comparing all pairs.
const ALL_PAIRS: usize = 64;

/// The place of each number of a list in its sorted order.
fn rank(list: &[u32], ranks: &mut Vec<u32>) {
    ranks.clear();
    if list.len() <= ALL_PAIRS {
        ranks.extend(list.iter().map(|a| list.iter().map(|b| u32::from(b < a)).sum::<u32>()));
        return;
    }
    let mut order: Vec<u32> = (0..list.len() as u32).collect();
    order.sort_unstable_by_key(|&k| list[k as usize]);
    ranks.resize(list.len(), 0);
    for (rank, k) in order.into_iter().enumerate() {
        ranks[k as usize] = rank as u32;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::{Edges, edge_vertices};
    use crate::mesh::{BoxDomain, Facets, Mesh, Neighbours};
    use crate::real::Point;

    fn check<const D: usize>(counts: [usize; D]) -> usize {
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let mesh = Mesh::<f64, D>::kuhn_box(&domain, counts).unwrap();
        let (edges, numbers) = Edges::numbered(&mesh);
        assert_eq!(edges, Edges::of(&mesh));
        assert_eq!(numbers, edges.numbers(&mesh));
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
