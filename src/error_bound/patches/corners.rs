//! The cells around each vertex.

use std::ops::Range;

use crate::assemble::space::Space;
use crate::parallel::grouping::group_by_key;

/// A cell, with the number of a vertex in it.
#[derive(Clone, Copy, Default)]
pub(super) struct Corner(u32);

impl Corner {
    pub fn new(cell: usize, own: usize) -> Self {
        Self((cell * 4 + own) as u32)
    }
    pub fn cell(self) -> usize {
        self.0 as usize / 4
    }
    /// The number of the vertex in the cell.
    pub fn own(self) -> usize {
        self.0 as usize % 4
    }
    /// The facets of the cell at the vertex.
    pub fn facets<const D: usize>(self) -> impl Iterator<Item = usize> {
        (0..D + 1).filter(move |&facet| facet != self.own())
    }
}

/// The corners of cells at each vertex, in the order of cells.
pub(super) struct Corners {
    corners: Vec<Corner>,
    /// Where those of each vertex start.
    starts: Vec<u32>,
}

impl Corners {
    /// The corners at a vertex.
    pub fn at(&self, vertex: usize) -> &[Corner] {
        &self.corners[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

impl<const D: usize> Space<'_, D> {
    /// The corners of all vertices.
    pub(super) fn corners(&self) -> Corners {
        let n_vertices = self.mesh.vertices().len();
        let (starts, corners) = group_by_key(self.mesh.n_cells(), n_vertices, |cell, put| {
            for (own, &v) in self.mesh.cell(cell).iter().enumerate() {
                put(v, Corner::new(cell, own));
            }
        });
        Corners { corners, starts }
    }

    /// Ranges of `length` cells whose fluxes of vertices are kept at a time, each with the vertices of its cells. All cells are
    /// one range if the ranges would have more than twice as many vertices as the mesh: the numbers of neighbours are far
    /// apart then.
    pub(super) fn ranges_with_vertices(&self, length: usize) -> Vec<(Range<usize>, Vec<u32>)> {
        let (n_cells, n_vertices) = (self.mesh.n_cells(), self.mesh.vertices().len());
        let mut last_range = vec![u32::MAX; n_vertices];
        let mut ranges = Vec::new();
        let mut n_visits = 0;
        for (number, first) in (0..n_cells).step_by(length).enumerate() {
            let cells = first..(first + length).min(n_cells);
            let mut vertices = Vec::new();
            for &v in &self.mesh.cells()[cells.start * (D + 1)..cells.end * (D + 1)] {
                if last_range[v as usize] != number as u32 {
                    last_range[v as usize] = number as u32;
                    vertices.push(v);
                }
            }
            n_visits += vertices.len();
            if n_visits > 2 * n_vertices {
                return vec![(0..n_cells, (0..n_vertices as u32).collect())];
            }
            ranges.push((cells, vertices));
        }
        ranges
    }
}
