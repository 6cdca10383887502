//! How rows are shared out among threads.
//!
//! Rows are partitioned into subsets. The work on a subset visits every cell that has one of its rows,
//! in ascending order, and adds to these rows only. So no two threads write to one entry, and every
//! row sums its cells in the same order whatever the partition: the bits do not depend on the number
//! of threads. Cells with rows in two subsets are visited twice; they are few where neighbours have
//! near numbers.

use std::ops::Range;

use crate::parallel::map_groups;

use crate::assemble::space::dofs::{Dofs, KINDS};

/// Cells of one block, of which only the range of their unknowns is known.
const BLOCK: usize = 256;
/// Number of blocks in a parallel task.
const BLOCKS_PER_TASK: usize = 16;

/// Fewest rows worth a subset of their own.
const LEAST_ROWS: usize = 256;

/// Rows by kind of owner: a range for each kind.
pub(crate) type Rows = [Range<u32>; KINDS];

/// The subsets into which the threads share out the rows.
pub(crate) fn partition(dofs: &Dofs<'_>) -> Vec<Rows> {
    let threads = rayon::current_num_threads();
    let most = if threads == 1 { 1 } else { 2 * threads };
    parts(dofs.kinds(), most.min(dofs.size() / LEAST_ROWS))
}

/// Cuts rows into this many subsets of the same share of each kind, so that rows of vertices come
/// with those of the edges beside them.
fn parts(rows: &Rows, n: usize) -> Vec<Rows> {
    let n = n.max(1);
    let share = |rows: &Range<u32>, subset: usize| {
        rows.start + (rows.len() as u64 * subset as u64 / n as u64) as u32
    };
    let subset = |p| rows.each_ref().map(|rows| share(rows, p)..share(rows, p + 1));
    (0..n).map(subset).collect()
}

/// Rows after which scratch memory is used again, and the most parts that this makes of a subset.
const PART_ROWS: usize = 1 << 14;
const MOST_PARTS: usize = 16;

/// Blocks of consecutive cells with the unknowns they have.
pub(crate) struct Blocks {
    /// For each block the hull of its unknowns of each kind; empty for kinds that the block does not have.
    hulls: Vec<Rows>,
    n_cells: usize,
}

/// Where the rows of a block are: none, some or all of them in a subset.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Location {
    Outside,
    Across,
    Inside,
}

impl Blocks {
    /// The blocks of a numbering whose unknown `i` of a cell is of kind `kind(i)`.
    pub fn new(dofs: &Dofs<'_>, kind: impl Fn(usize) -> usize + Sync) -> Self {
        let n_cells = dofs.n_cells();
        let hull_of = |block: usize| {
            let mut numbers = Vec::new();
            let mut hull = [const { Range { start: u32::MAX, end: 0 } }; KINDS];
            let cells = Self::cells(block, n_cells);
            for unknowns in dofs.of_cells(cells, &mut numbers).chunks_exact(dofs.per_cell()) {
                for (i, &unknown) in unknowns.iter().enumerate() {
                    let rows = &mut hull[kind(i)];
                    *rows = rows.start.min(unknown)..rows.end.max(unknown + 1);
                }
            }
            hull
        };
        let of_chunk = |blocks: Range<usize>| blocks.map(hull_of).collect::<Vec<_>>();
        let hulls = map_groups(n_cells.div_ceil(BLOCK), BLOCKS_PER_TASK, &of_chunk).concat();
        Self { hulls, n_cells }
    }
    /// The cells of a block.
    fn cells(block: usize, n_cells: usize) -> Range<usize> {
        block * BLOCK..((block + 1) * BLOCK).min(n_cells)
    }
    /// Cuts a subset into parts that one thread takes one after the other: as many as help, unless
    /// cells have so distant numbers that many belong to several parts.
    pub fn parts_of(&self, subset: &Rows) -> Vec<Rows> {
        let rows: usize = subset.iter().map(|rows| rows.len()).sum();
        let mut n = (rows / PART_ROWS).clamp(1, MOST_PARTS);
        let most = self.of(subset).count() * 5 / 4;
        loop {
            let parts = parts(subset, n);
            if n == 1 || parts.iter().map(|part| self.of(part).count()).sum::<usize>() <= most {
                return parts;
            }
            n /= 2;
        }
    }
    /// The blocks that may have rows of a subset: their cells, their location, their hulls.
    pub fn of<'b>(
        &'b self,
        subset: &'b Rows,
    ) -> impl Iterator<Item = (Range<usize>, Location, &'b Rows)> {
        let location = move |hull: &Rows| {
            let pairs = || hull.iter().zip(subset).filter(|(hull, _)| !hull.is_empty());
            if pairs().all(|(hull, rows)| rows.start <= hull.start && hull.end <= rows.end) {
                Location::Inside
            } else if pairs().any(|(hull, rows)| hull.start < rows.end && rows.start < hull.end) {
                Location::Across
            } else {
                Location::Outside
            }
        };
        let all = self.hulls.iter().enumerate();
        all.map(move |(block, hull)| (Self::cells(block, self.n_cells), location(hull), hull))
            .filter(|(_, location, _)| *location != Location::Outside)
    }
}
