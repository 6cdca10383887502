//! The cells around each vertex.

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
}
