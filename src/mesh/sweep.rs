//! Sweeps over the vertices of a mesh with the cells around each, a range of vertices per thread.

use std::ops::Range;

use rayon::prelude::*;

use crate::memory::in_large_pages;

/// Cells of one block, of which only the range of their vertices is known.
const BLOCK: usize = 256;

/// Fewest vertices worth a range of their own.
const LEAST: usize = 256;

/// Cells by their vertices: of each cell the first few, its leading ones.
pub(super) struct Sweep<'m, const D: usize> {
    cells: &'m [u32],
    n_vertices: usize,
    leading: usize,
    /// For each block of consecutive cells the hull of their leading vertices.
    hulls: Vec<Range<u32>>,
}

/// The cells around each vertex of a range.
pub(super) struct Around {
    vertices: Range<u32>,
    starts: Vec<u32>,
    slots: Vec<u32>,
}

impl<'m, const D: usize> Sweep<'m, D> {
    /// Sweeps that meet each cell of these at its first `leading` vertices.
    pub fn new(cells: &'m [u32], n_vertices: usize, leading: usize) -> Self {
        let hull = |block: &[u32]| {
            let mut hull = Range { start: u32::MAX, end: 0 };
            for cell in block.chunks_exact(D + 1) {
                for &v in &cell[..leading] {
                    hull = hull.start.min(v)..hull.end.max(v + 1);
                }
            }
            hull
        };
        let blocks = cells.par_chunks((D + 1) * BLOCK).with_min_len(16);
        Self { cells, n_vertices, leading, hulls: blocks.map(hull).collect() }
    }
    /// Ranges of vertices that threads take; what a sweep finds does not depend on them.
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
    /// The cells around the vertices of a range: a counting sort.
    pub fn around(&self, vertices: Range<u32>) -> Around {
        let n = vertices.len();
        // counts two places on become, summed, starts one place on, which filling makes starts
        let mut starts = in_large_pages(vec![0_u32; n + 2]);
        self.visit(&vertices, |v, _| starts[v + 2] += 1);
        for v in 0..n {
            starts[v + 2] += starts[v + 1];
        }
        let mut slots = in_large_pages(vec![0_u32; starts[n + 1] as usize]);
        self.visit(&vertices, |v, slot| {
            let at = &mut starts[v + 1];
            slots[*at as usize] = slot;
            *at += 1;
        });
        Around { vertices, starts, slots }
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

impl Around {
    /// Each vertex with its cells, ascending, and its number in each.
    #[inline(always)]
    pub fn each(&self) -> impl Iterator<Item = (u32, impl Iterator<Item = (usize, usize)>)> {
        let slots = |k: usize| &self.slots[self.starts[k] as usize..self.starts[k + 1] as usize];
        let sides = |&slot: &u32| ((slot >> 2) as usize, (slot & 3) as usize);
        self.vertices.clone().enumerate().map(move |(k, v)| (v, slots(k).iter().map(sides)))
    }
}

/// What was met at the vertex at hand, by vertices of higher number; each is forgotten at the next.
pub(super) struct Met {
    /// One more than the running number of what was met last.
    last: Vec<u32>,
    base: u32,
    n: u32,
}

impl Met {
    pub fn new(n_vertices: usize) -> Self {
        Self { last: in_large_pages(vec![0; n_vertices]), base: 0, n: 0 }
    }
    /// Forgets all.
    #[inline(always)]
    pub fn next_vertex(&mut self) {
        self.base += self.n;
        self.n = 0;
    }
    /// The number, counted at this vertex, of what was met last with another vertex.
    #[inline(always)]
    pub fn with(&self, other: u32) -> Option<u32> {
        let last = self.last[other as usize];
        (last > self.base).then(|| last - self.base - 1)
    }
    /// Numbers something met with another vertex.
    #[inline(always)]
    pub fn push(&mut self, other: u32) {
        self.n += 1;
        self.last[other as usize] = self.base + self.n;
    }
}
