//! Edges: the pairs of vertices that some cell joins, each once.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::parallel::map_indices;
use crate::parallel::vectors::{collect, concat, for_each_chunk_of_groups, starts};

use super::incidence::{FirstVertices, VertexToCells, vertex_ranges};
use super::simplicial::Mesh;
use crate::memory::in_large_pages;

/// Local vertices of the edges of a cell, ordered by their second vertex. A cell of dimension `D`
/// has the first `D (D + 1) / 2` of them.
const EDGE_VERTICES: [[usize; 2]; 6] = [[0, 1], [0, 2], [1, 2], [0, 3], [1, 3], [2, 3]];

/// Local vertices of the edges of a cell of this dimension.
pub(crate) const fn edge_vertices(dimension: usize) -> &'static [[usize; 2]] {
    EDGE_VERTICES.split_at(dimension * (dimension + 1) / 2).0
}

/// All edges of a mesh, numbered by their pairs of vertices in lexicographic order: in one dimension
/// the cells, in two the facets, under other numbers.
///
/// # Panics
/// A method that takes the number of a vertex panics if the mesh has no such vertex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edges {
    /// Number of the first edge that starts at each vertex, and the number of all edges.
    starts: Vec<u32>,
    /// The end of higher number of each edge.
    upper: Vec<u32>,
}

impl Edges {
    /// The edges of a mesh, and the number of every edge of every cell, ordered in each cell by the
    /// second local vertex of the edge; in time linear in its cells.
    pub fn with_cell_edges<const D: usize>(mesh: &Mesh<D>) -> (Self, Vec<u32>) {
        let pairs = edge_vertices(D);
        // of each edge of each cell the rank among the edges with the same lower vertex
        let ranks = collect(pairs.len() * mesh.n_cells(), |_| AtomicU32::default());
        let incidence = VertexToCells::<D>::new(mesh.cells(), FirstVertices(D));
        let ranges = vertex_ranges(mesh.vertices().len());
        let found = |k: usize| upper_ends(&incidence, &ranges[k], &ranks);
        let (upper, ends): (Vec<_>, Vec<_>) = map_indices(ranges.len(), &found).into_iter().unzip();
        let ends: Vec<&[u32]> = ends.iter().map(|ends: &Vec<u32>| &ends[..]).collect();
        let edges = Self { starts: starts(&ends), upper: concat(upper) };
        // the number of an edge is that of the first edge with its lower vertex plus its rank
        let mut numbers = in_large_pages(vec![0; ranks.len()]);
        for_each_chunk_of_groups(&mut numbers, pairs.len(), |range, numbers| {
            let first = range.start / pairs.len();
            let ranks = ranks[range].chunks_exact(pairs.len());
            let cells = numbers.chunks_exact_mut(pairs.len()).zip(ranks).enumerate();
            for (k, (numbers, ranks)) in cells {
                let cell = mesh.cell(first + k);
                for ((number, rank), &[i, _]) in numbers.iter_mut().zip(ranks).zip(pairs) {
                    *number = edges.starts[cell[i] as usize] + rank.load(Ordering::Relaxed);
                }
            }
        });
        (edges, numbers)
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
    /// The vertices of higher number at the other end of a vertex' edges, ascending.
    pub fn upper_ends(&self, a: u32) -> &[u32] {
        &self.upper[self.first_at(a) as usize..self.first_at(a + 1) as usize]
    }
}

/// The upper ends of the edges with a lower vertex in a range, and where those of each of these
/// vertices end. In `ranks` each edge of each cell gets its rank.
fn upper_ends<const D: usize>(
    incidence: &VertexToCells<'_, D>,
    vertices: &Range<u32>,
    ranks: &[AtomicU32],
) -> (Vec<u32>, Vec<u32>) {
    let (mut upper, mut ends_of_vertices) = (Vec::new(), Vec::with_capacity(vertices.len()));
    // of each vertex the upper ends, with the edges of the cells
    let mut ends: Vec<(u32, usize)> = Vec::new();
    for (_, cells) in incidence.stars(vertices).of_vertices(vertices.clone()) {
        ends.clear();
        for (c, i) in cells {
            // edge (i, j) of a cell follows the edges of lower second vertices
            let edge = |j: usize| c * edge_vertices(D).len() + j * (j - 1) / 2 + i;
            let cell = incidence.cell(c).iter().enumerate().skip(i + 1);
            ends.extend(cell.map(|(j, &end)| (end, edge(j))));
        }
        ends.sort_unstable();
        for (rank, same) in (0..).zip(ends.chunk_by(|a, b| a.0 == b.0)) {
            upper.push(same[0].0);
            same.iter().for_each(|&(_, edge)| ranks[edge].store(rank, Ordering::Relaxed));
        }
        ends_of_vertices.push(upper.len() as u32);
    }
    (upper, ends_of_vertices)
}
