//! The inverse of a table of cells: the star of every vertex or unknown, which is the cells that have it.
//!
//! The table has a row of numbers for each cell, the vertices of the cell or its unknowns. The threads share out these
//! numbers by ranges. The work on a range visits every cell that has a number in it, in ascending order, and writes to
//! what belongs to these numbers only: no two threads write to one place, and the bits of a result do not depend on
//! how many threads there are. Cells with numbers in two ranges are visited twice; they are few where neighbours have
//! near numbers.

use std::ops::Range;

use crate::arrays::map_entries;
use crate::memory::in_large_pages;
use crate::parallel::map_groups;

/// Cells of one block, of which only the range of their numbers is known.
const BLOCK: usize = 256;
/// Number of blocks in a parallel task.
const BLOCKS_PER_TASK: usize = 16;

/// Fewest numbers worth a range of their own.
const LEAST: usize = 256;

/// Numbers after which scratch memory is used again, and the most pieces that this makes of a range.
const PIECE: usize = 1 << 14;
const MOST_PIECES: usize = 16;

/// A range of numbers of each kind: one kind of vertices, or `K` kinds of unknowns by their owners.
pub(crate) type Ranges<const K: usize> = [Range<u32>; K];

/// The ranges that the threads share out: each has the same share of every kind, so that unknowns of vertices come with
/// those of the edges beside them.
pub(crate) fn partition<const K: usize>(all: &Ranges<K>) -> Vec<Ranges<K>> {
    let threads = rayon::current_num_threads();
    let most = if threads == 1 { 1 } else { 2 * threads };
    pieces(all, most.min(length(all) / LEAST))
}

fn length<const K: usize>(ranges: &Ranges<K>) -> usize {
    ranges.iter().map(|range| range.len()).sum()
}

/// Cuts ranges into this many pieces.
fn pieces<const K: usize>(ranges: &Ranges<K>, n: usize) -> Vec<Ranges<K>> {
    let n = n.max(1);
    let share = |range: &Range<u32>, piece: usize| {
        range.start + (range.len() as u64 * piece as u64 / n as u64) as u32
    };
    let piece = |p| ranges.each_ref().map(|range| share(range, p)..share(range, p + 1));
    (0..n).map(piece).collect()
}

/// What the numbers of a cell are. Constants unroll the loops over them.
pub(crate) trait Columns: Copy + Sync {
    /// How many numbers a cell has.
    fn width(&self) -> usize;
    /// How many of them, the first ones, are inverted.
    fn inverted(&self) -> usize;
    /// The kind of number `i` of a cell.
    fn kind(&self, i: usize) -> usize;
    /// The place of number `i` of a cell, by which stars name the cell and the number in it.
    fn place(&self, cell: usize, i: usize) -> usize;
}

/// A table of cells and how to invert it.
pub(crate) struct Incidence<'t, C, const K: usize> {
    pub table: &'t [u32],
    pub columns: C,
    pub blocks: Blocks<K>,
}

/// Blocks of consecutive cells with the numbers they have.
pub(crate) struct Blocks<const K: usize> {
    /// For each block the hull of its numbers of each kind; empty for kinds that the block does not have.
    hulls: Vec<Ranges<K>>,
    n_cells: usize,
}

/// Where the numbers of a block are: none, some or all of them in a range.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Overlap {
    Outside,
    Across,
    Inside,
}

/// The stars of the numbers of a range, one kind after the other.
#[derive(Default)]
pub(crate) struct Stars {
    starts: Vec<u32>,
    places: Vec<u32>,
}

impl<'t, C: Columns, const K: usize> Incidence<'t, C, K> {
    pub fn new(table: &'t [u32], columns: C) -> Self {
        let blocks = Blocks::new(table, columns);
        Self { table, columns, blocks }
    }
    /// The numbers of a cell.
    #[inline(always)]
    pub fn cell(&self, cell: usize) -> &'t [u32] {
        let width = self.columns.width();
        &self.table[cell * width..(cell + 1) * width]
    }
    /// Finds the star of each number of a range, by a counting sort.
    #[inline(always)]
    pub fn find_stars(&self, ranges: &Ranges<K>, stars: &mut Stars) {
        let mut n = 0;
        let offsets = map_entries(ranges.each_ref(), |range| {
            n += range.len();
            n - range.len()
        });
        let Stars { starts, places } = stars;
        // the count of star k stands at k + 2; summed up, entry k + 1 is where star k starts, and
        // filling the star moves it to where star k ends
        let starts = zeros_in(starts, n + 2);
        self.visit(ranges, |kind, k, _| starts[offsets[kind] + k + 2] += 1);
        for k in 0..n {
            starts[k + 2] += starts[k + 1];
        }
        let places = zeros_in(places, starts[n + 1] as usize);
        self.visit(ranges, |kind, k, (cell, i)| {
            let at = &mut starts[offsets[kind] + k + 1];
            places[*at as usize] = self.columns.place(cell, i) as u32;
            *at += 1;
        });
    }
    /// Calls a function with the kind of each number in the ranges, its position in the range of that kind, and each
    /// cell that has it with the number of it in the cell, by ascending cells.
    #[inline(always)]
    pub fn visit(&self, ranges: &Ranges<K>, mut visit: impl FnMut(usize, usize, (usize, usize))) {
        let columns = self.columns;
        let width = columns.width();
        for (cells, ..) in self.blocks.of(ranges) {
            let first = cells.start;
            let numbers = &self.table[cells.start * width..cells.end * width];
            for (c, numbers) in numbers.chunks_exact(width).enumerate() {
                for (i, number) in numbers[..columns.inverted()].iter().enumerate() {
                    let kind = columns.kind(i);
                    let k = number.wrapping_sub(ranges[kind].start) as usize;
                    if k < ranges[kind].len() {
                        visit(kind, k, (first + c, i));
                    }
                }
            }
        }
    }
}

/// This many zeros in a vector, in the memory it has if that is enough.
fn zeros_in(vector: &mut Vec<u32>, n: usize) -> &mut [u32] {
    if vector.capacity() < n {
        *vector = in_large_pages(vec![0; n]);
    } else {
        vector.clear();
        vector.resize(n, 0);
    }
    vector
}

impl<const K: usize> Blocks<K> {
    fn new<C: Columns>(table: &[u32], columns: C) -> Self {
        let width = columns.width();
        let n_cells = table.len() / width;
        let hull_of = |block: usize| {
            let mut hull = [const { Range { start: u32::MAX, end: 0 } }; K];
            let cells = Self::cells(block, n_cells);
            for numbers in table[cells.start * width..cells.end * width].chunks_exact(width) {
                for (i, &number) in numbers[..columns.inverted()].iter().enumerate() {
                    let range = &mut hull[columns.kind(i)];
                    *range = range.start.min(number)..range.end.max(number + 1);
                }
            }
            hull
        };
        let of_chunk = |blocks: Range<usize>| blocks.map(hull_of).collect::<Vec<_>>();
        let hulls = map_groups(n_cells.div_ceil(BLOCK), BLOCKS_PER_TASK, &of_chunk).concat();
        Self { hulls, n_cells }
    }
    fn cells(block: usize, n_cells: usize) -> Range<usize> {
        block * BLOCK..((block + 1) * BLOCK).min(n_cells)
    }
    /// Cuts a range into pieces that one thread takes one after the other: as many as help, unless
    /// cells have so distant numbers that many belong to several pieces.
    pub fn pieces_of(&self, ranges: &Ranges<K>) -> Vec<Ranges<K>> {
        let mut n = (length(ranges) / PIECE).clamp(1, MOST_PIECES);
        let most = self.of(ranges).count() * 5 / 4;
        loop {
            let pieces = pieces(ranges, n);
            if n == 1 || pieces.iter().map(|piece| self.of(piece).count()).sum::<usize>() <= most {
                return pieces;
            }
            n /= 2;
        }
    }
    /// The blocks that may have numbers of a range: their cells, their overlap with the range, their hulls.
    pub fn of<'b>(
        &'b self,
        ranges: &'b Ranges<K>,
    ) -> impl Iterator<Item = (Range<usize>, Overlap, &'b Ranges<K>)> {
        let overlap = move |hull: &Ranges<K>| {
            let pairs = || hull.iter().zip(ranges).filter(|(hull, _)| !hull.is_empty());
            if pairs().all(|(hull, range)| range.start <= hull.start && hull.end <= range.end) {
                Overlap::Inside
            } else if pairs().any(|(hull, range)| hull.start < range.end && range.start < hull.end)
            {
                Overlap::Across
            } else {
                Overlap::Outside
            }
        };
        let all = self.hulls.iter().enumerate();
        all.map(move |(block, hull)| (Self::cells(block, self.n_cells), overlap(hull), hull))
            .filter(|(_, overlap, _)| *overlap != Overlap::Outside)
    }
}

impl Stars {
    /// The places of the cells of star `k`, ascending.
    #[inline(always)]
    pub fn of(&self, k: usize) -> &[u32] {
        &self.places[self.starts[k] as usize..self.starts[k + 1] as usize]
    }
}

/// The first vertices of the cells of a mesh, this many of each.
#[derive(Clone, Copy)]
pub(super) struct FirstVertices<const D: usize>(pub usize);

/// The inverse of the map from cells to their first vertices.
pub(super) type VertexToCells<'m, const D: usize> = Incidence<'m, FirstVertices<D>, 1>;

/// The ranges of vertices that the threads share out.
pub(super) fn vertex_ranges(n_vertices: usize) -> Vec<Range<u32>> {
    partition(std::array::from_ref(&(0..n_vertices as u32))).concat()
}

impl<const D: usize> Columns for FirstVertices<D> {
    #[inline(always)]
    fn width(&self) -> usize {
        D + 1
    }
    #[inline(always)]
    fn inverted(&self) -> usize {
        self.0
    }
    #[inline(always)]
    fn kind(&self, _: usize) -> usize {
        0
    }
    #[inline(always)]
    fn place(&self, cell: usize, i: usize) -> usize {
        cell * 4 + i
    }
}

impl<const D: usize> VertexToCells<'_, D> {
    pub fn stars(&self, vertices: &Range<u32>) -> Stars {
        let mut stars = Stars::default();
        self.find_stars(std::array::from_ref(vertices), &mut stars);
        stars
    }
}

impl Stars {
    /// Each vertex of the range with the cells of its star, ascending, and its number in each of them.
    #[inline(always)]
    pub(super) fn of_vertices(
        &self,
        vertices: Range<u32>,
    ) -> impl Iterator<Item = (u32, impl Iterator<Item = (usize, usize)>)> {
        let split = |&place: &u32| ((place >> 2) as usize, (place & 3) as usize);
        vertices.enumerate().map(move |(k, v)| (v, self.of(k).iter().map(split)))
    }
}
