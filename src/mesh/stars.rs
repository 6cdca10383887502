//! The star of every vertex, the cells that contain it, for one range of vertices per thread.

use std::ops::Range;

use crate::parallel::map_groups;

use crate::memory::in_large_pages;

/// Number of cells of a block, of which only the range of their vertices is stored.
const BLOCK: usize = 256;
/// Number of blocks in a parallel task.
const BLOCKS_PER_TASK: usize = 16;

/// Least number of vertices of a range.
const LEAST: usize = 256;

/// The inverse of the map from cells to their leading vertices, built for a range of vertices at a
/// time.
pub(super) struct VertexToCells<'m, const D: usize> {
    cells: &'m [u32],
    n_vertices: usize,
    leading: usize,
    /// For each block of consecutive cells the smallest range that contains their leading vertices.
    hulls: Vec<Range<u32>>,
}

/// The stars of the vertices of a range, in compressed rows.
pub(super) struct Stars {
    vertices: Range<u32>,
    starts: Vec<u32>,
    /// Four times the cell plus the number of the vertex in it.
    corners: Vec<u32>,
}

impl<'m, const D: usize> VertexToCells<'m, D> {
    /// The cells by their first `leading` vertices.
    pub fn new(cells: &'m [u32], n_vertices: usize, leading: usize) -> Self {
        let length = (D + 1) * BLOCK;
        let hull_of = |block: &[u32]| {
            let mut hull = Range { start: u32::MAX, end: 0 };
            for cell in block.chunks_exact(D + 1) {
                for &v in &cell[..leading] {
                    hull = hull.start.min(v)..hull.end.max(v + 1);
                }
            }
            hull
        };
        let n_blocks = cells.len().div_ceil(length);
        let of_chunk = |blocks: Range<usize>| -> Vec<Range<u32>> {
            cells.chunks(length).skip(blocks.start).take(blocks.len()).map(hull_of).collect()
        };
        let hulls = map_groups(n_blocks, BLOCKS_PER_TASK, &of_chunk).concat();
        Self { cells, n_vertices, leading, hulls }
    }
    /// A partition of the vertices into ranges, one per task. Results are independent of it.
    pub fn ranges(&self) -> Vec<Range<u32>> {
        let threads = rayon::current_num_threads();
        let most = if threads == 1 { 1 } else { 2 * threads };
        let n = most.min(self.n_vertices / LEAST).max(1);
        let cut = |k: usize| (self.n_vertices * k / n) as u32;
        (0..n).map(|k| cut(k)..cut(k + 1)).collect()
    }
    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.n_vertices
    }
    /// The vertices of a cell.
    #[inline(always)]
    pub fn cell(&self, cell: usize) -> &'m [u32] {
        &self.cells[cell * (D + 1)..(cell + 1) * (D + 1)]
    }
    /// The stars of the vertices of a range, by a counting sort.
    pub fn stars(&self, vertices: Range<u32>) -> Stars {
        let n = vertices.len();
        // the count of vertex v stands at v + 2; summed up, entry v + 1 is where row v starts, and
        // filling the row moves it to where row v ends
        let mut starts = in_large_pages(vec![0_u32; n + 2]);
        self.visit(&vertices, |v, _| starts[v + 2] += 1);
        for v in 0..n {
            starts[v + 2] += starts[v + 1];
        }
        let mut corners = in_large_pages(vec![0_u32; starts[n + 1] as usize]);
        self.visit(&vertices, |v, corner| {
            let at = &mut starts[v + 1];
            corners[*at as usize] = corner;
            *at += 1;
        });
        Stars { vertices, starts, corners }
    }
    #[inline(always)]
    fn visit(&self, vertices: &Range<u32>, mut visit: impl FnMut(usize, u32)) {
        let blocks = self.cells.chunks((D + 1) * BLOCK).zip(&self.hulls).enumerate();
        for (block, (cells, hull)) in blocks {
            if hull.end <= vertices.start || vertices.end <= hull.start {
                continue;
            }
            for (c, cell) in cells.chunks_exact(D + 1).enumerate() {
                for (k, &v) in cell[..self.leading].iter().enumerate() {
                    let v = v.wrapping_sub(vertices.start) as usize;
                    if v < vertices.len() {
                        visit(v, ((block * BLOCK + c) * 4 + k) as u32);
                    }
                }
            }
        }
    }
}

impl Stars {
    /// Each vertex with the cells of its star, ascending, and its number in each of them.
    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = (u32, impl Iterator<Item = (usize, usize)>)> {
        let corners =
            |k: usize| &self.corners[self.starts[k] as usize..self.starts[k + 1] as usize];
        let split = |&corner: &u32| ((corner >> 2) as usize, (corner & 3) as usize);
        self.vertices.clone().enumerate().map(move |(k, v)| (v, corners(k).iter().map(split)))
    }
}

/// Running numbers of pairs of a current vertex and a neighbour; those of the current vertex count
/// from zero. Moving to the next vertex takes constant time.
pub(super) struct NeighbourNumbers {
    /// For each neighbour one more than the number of its last pair, over all vertices.
    last: Vec<u32>,
    base: u32,
    n: u32,
}

impl NeighbourNumbers {
    pub fn new(n_vertices: usize) -> Self {
        Self { last: in_large_pages(vec![0; n_vertices]), base: 0, n: 0 }
    }
    /// Starts with the next current vertex, of which no pair has a number.
    #[inline(always)]
    pub fn next_vertex(&mut self) {
        self.base += self.n;
        self.n = 0;
    }
    /// The number last given to the current vertex and this neighbour.
    #[inline(always)]
    pub fn get(&self, neighbour: u32) -> Option<u32> {
        let last = self.last[neighbour as usize];
        (last > self.base).then(|| last - self.base - 1)
    }
    /// Gives the next number to the current vertex and this neighbour.
    #[inline(always)]
    pub fn push(&mut self, neighbour: u32) {
        self.n += 1;
        self.last[neighbour as usize] = self.base + self.n;
    }
}
