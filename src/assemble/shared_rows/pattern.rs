//! The pattern of a space that shares unknowns, and where in it each cell adds its matrix.

use std::ops::Range;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::parallel::{for_each_item, map_indices};

use super::partition::{Blocks, Rows, partition};
use super::unknowns::{ANY, CellUnknowns};
use crate::algebra::SparseMatrix;
use crate::arrays::map_entries;
use crate::assemble::space::dofs::{Dofs, KINDS};
use crate::memory::in_large_pages;

/// Where each cell adds its matrix: made with the pattern, kept for every filling of it.
pub(crate) struct EntryPositions {
    /// For each cell, its unknown `i` and its unknown `j`: the position of column `j` in row `i`.
    ///
    /// In rows of more than 256 entries a byte does not hold the position, and filling searches for
    /// it. The bytes are atomic because two threads may make the rows of one cell, each thread the
    /// positions in its own rows.
    pub in_rows: Vec<AtomicU8>,
    /// The cells in blocks.
    pub blocks: Blocks,
    /// Entries of the pattern.
    pub nonzeros: usize,
}

/// Longest row whose positions a byte holds.
pub(crate) const LONGEST: usize = 256;

/// The pattern of the rows of a subset, by kind.
type PatternOfSubset = [PatternOfRows; KINDS];

/// Columns and lengths of rows.
#[derive(Default)]
struct PatternOfRows {
    columns: Vec<u32>,
    lengths: Vec<u32>,
}

/// The pattern, with values zero, and the positions at which cells add to it.
pub(crate) fn pattern<const D: usize>(dofs: &Dofs<'_>) -> (SparseMatrix<f64>, EntryPositions) {
    // constant conditions: loops for another dimension are not even instantiated
    match CellUnknowns::<D>::constant_count(dofs) {
        2 if const { D == 1 } => pattern_with::<D, 2>(dofs),
        3 if const { D < 3 } => pattern_with::<D, 3>(dofs),
        4 if const { D == 3 } => pattern_with::<D, 4>(dofs),
        6 if const { D == 2 } => pattern_with::<D, 6>(dofs),
        10 if const { D == 3 } => pattern_with::<D, 10>(dofs),
        _ => pattern_with::<D, ANY>(dofs),
    }
}

/// As [`pattern`], for cells of `N` unknowns.
fn pattern_with<const D: usize, const N: usize>(
    dofs: &Dofs<'_>,
) -> (SparseMatrix<f64>, EntryPositions) {
    let of_cell = CellUnknowns::<D, N>::new(dofs);
    let blocks = Blocks::new(dofs, |i| of_cell.kind(i));
    let in_rows = zeros(dofs.n_cells() * of_cell.count() * of_cell.count());
    let builder = PatternBuilder { dofs, of_cell, blocks: &blocks, in_rows: &in_rows };
    let subsets = partition(dofs);
    let build = |k: usize| builder.rows(&subsets[k]);
    let mut made: Vec<PatternOfSubset> = map_indices(subsets.len(), &build);
    let row_starts = row_starts(dofs.size(), &made);
    let columns = columns_of(&row_starts, &mut made);
    let nonzeros = columns.len();
    let values = in_large_pages(vec![0.0; nonzeros]);
    let matrix = SparseMatrix { row_starts, columns, values };
    (matrix, EntryPositions { in_rows, blocks, nonzeros })
}

/// The columns of all rows, taken from the patterns of the subsets: of a single subset they are moved, of several
/// copied.
fn columns_of(row_starts: &[u32], made: &mut [PatternOfSubset]) -> Vec<u32> {
    match made {
        [only] => {
            let mut columns = std::mem::take(only).map(|rows| rows.columns).into_iter();
            let mut all = columns.find(|columns| !columns.is_empty()).unwrap_or_default();
            columns.for_each(|more| all.extend(more));
            all
        }
        _ => join(row_starts, made),
    }
}

fn zeros(n: usize) -> Vec<AtomicU8> {
    // the system hands out zeroed bytes; the conversion copies nothing
    in_large_pages(vec![0_u8; n]).into_iter().map(AtomicU8::new).collect()
}

/// Where rows start, from their lengths.
fn row_starts(size: usize, made: &[PatternOfSubset]) -> Vec<u32> {
    let mut starts = in_large_pages(Vec::with_capacity(size + 1));
    starts.push(0);
    let mut end = 0;
    for kind in 0..KINDS {
        for subset in made {
            starts.extend(subset[kind].lengths.iter().map(|length| {
                end += length;
                end
            }));
        }
    }
    starts
}

/// The columns of all subsets in the order of rows.
fn join(row_starts: &[u32], made: &[PatternOfSubset]) -> Vec<u32> {
    let mut columns = in_large_pages(vec![0; row_starts[row_starts.len() - 1] as usize]);
    let mut copies = Vec::new();
    let mut rest = &mut columns[..];
    for kind in 0..KINDS {
        for subset in made {
            let from = &subset[kind].columns;
            let (out, tail) = rest.split_at_mut(from.len());
            copies.push((out, from));
            rest = tail;
        }
    }
    for_each_item(copies, &|_, (out, from): (&mut [u32], &Vec<u32>)| out.copy_from_slice(from));
    columns
}

/// Builds the pattern of the rows of a subset.
struct PatternBuilder<'m, const D: usize, const N: usize> {
    dofs: &'m Dofs<'m>,
    of_cell: CellUnknowns<D, N>,
    blocks: &'m Blocks,
    in_rows: &'m [AtomicU8],
}

impl<const D: usize, const N: usize> PatternBuilder<'_, D, N> {
    /// The rows of a subset, in parts, so that scratch memory is small and used again.
    ///
    /// Not inlined into the parallel loop: all the loops over cells would be optimised twice.
    #[inline(never)]
    fn rows(&self, subset: &Rows) -> PatternOfSubset {
        let mut stars = Stars::default();
        let mut row = Row { seen: in_large_pages(vec![0; self.dofs.size()]), ..Row::default() };
        let mut made = self.room_for(subset);
        for part in self.blocks.parts_of(subset) {
            self.find_stars(&part, &mut stars);
            let mut k = 0;
            for (rows, made) in part.iter().zip(&mut made) {
                for _ in rows.clone() {
                    self.row(stars.of_row(k), &mut row, made);
                    k += 1;
                }
            }
        }
        made.iter_mut().for_each(|rows| rows.columns.shrink_to_fit());
        made
    }

    /// Room for the pattern of a subset: about as many entries as the cells' matrices have, of which those that
    /// are not used are never touched.
    fn room_for(&self, subset: &Rows) -> PatternOfSubset {
        let entries = |rows: &Range<u32>| self.in_rows.len() / self.dofs.size() * rows.len();
        subset.each_ref().map(|rows| PatternOfRows {
            columns: in_large_pages(Vec::with_capacity(entries(rows))),
            lengths: in_large_pages(Vec::with_capacity(rows.len())),
        })
    }

    /// Finds the star of each row of a part: a counting sort.
    #[inline(always)]
    fn find_stars(&self, part: &Rows, stars: &mut Stars) {
        let mut n_rows = 0;
        let offsets = map_entries(part.each_ref(), |rows| {
            n_rows += rows.len();
            n_rows - rows.len()
        });
        let Stars { starts, slots } = stars;
        // counts stand two entries on; summed they are starts one entry on; filling moves them to
        // their own entries
        starts.clear();
        starts.resize(n_rows + 2, 0);
        self.visit(part, &offsets, |row, _| starts[row + 2] += 1);
        for row in 0..n_rows {
            starts[row + 2] += starts[row + 1];
        }
        slots.clear();
        slots.resize(starts[n_rows + 1] as usize, 0);
        self.visit(part, &offsets, |row, slot| {
            let at = &mut starts[row + 1];
            slots[*at as usize] = slot as u32;
            *at += 1;
        });
    }

    /// Calls a function with each row of a part and each cell that has it: the cell times `N` plus
    /// the number of the unknown in it.
    #[inline(always)]
    fn visit(&self, part: &Rows, offsets: &[usize; KINDS], mut visit: impl FnMut(usize, usize)) {
        let n = self.of_cell.count();
        let mut numbers = Vec::new();
        for (cells, ..) in self.blocks.of(part) {
            let first = cells.start;
            let unknowns = self.dofs.of_cells(cells, &mut numbers);
            for (c, unknowns) in unknowns.chunks_exact(n).enumerate() {
                for i in 0..n {
                    let kind = self.of_cell.kind(i);
                    let row = unknowns[i].wrapping_sub(part[kind].start);
                    if (row as usize) < part[kind].len() {
                        visit(offsets[kind] + row as usize, (first + c) * n + i);
                    }
                }
            }
        }
    }

    /// Makes a row from its star, and the positions of the star's cells in it.
    #[inline(always)]
    fn row(&self, star: &[u32], row: &mut Row, made: &mut PatternOfRows) {
        let per_cell = self.of_cell.count();
        row.make_room(star.len() * per_cell);
        let Row { seen, columns, numbers, ranks, base } = row;
        let table = self.dofs.table();
        let mut n = 0_u32;
        for (&slot, numbers) in star.iter().zip(numbers.chunks_exact_mut(per_cell)) {
            let first = slot as usize / per_cell * per_cell;
            let unknowns = table.map(|t| &t[first..first + per_cell]);
            for j in 0..per_cell {
                let column = unknowns.map_or((first + j) as u32, |u| u[j]);
                let seen = &mut seen[column as usize];
                let is_new = *seen <= *base;
                let number = if is_new { n } else { *seen - *base - 1 };
                *seen = *base + number + 1;
                numbers[j] = number;
                columns[n as usize] = column;
                n += u32::from(is_new);
            }
        }
        *base += n;
        let n = n as usize;
        rank(&mut columns[..n.next_multiple_of(LANES)], n, ranks);
        let start = made.columns.len();
        made.columns.resize(start + n, 0);
        let out = &mut made.columns[start..];
        for (&rank, &column) in ranks[..n].iter().zip(&columns[..n]) {
            out[rank as usize] = column;
        }
        made.lengths.push(n as u32);
        for (&slot, numbers) in star.iter().zip(numbers.chunks_exact(per_cell)) {
            let positions = &self.in_rows[slot as usize * per_cell..][..per_cell];
            for (position, &number) in positions.iter().zip(numbers) {
                position.store(ranks[number as usize] as u8, Ordering::Relaxed);
            }
        }
    }
}

/// The stars of rows: the cells that have a row's unknown.
#[derive(Default)]
struct Stars {
    starts: Vec<u32>,
    /// Each cell times `N` plus the number of the row's unknown in it.
    slots: Vec<u32>,
}

impl Stars {
    #[inline(always)]
    fn of_row(&self, k: usize) -> &[u32] {
        &self.slots[self.starts[k] as usize..self.starts[k + 1] as usize]
    }
}

/// A row in the making.
#[derive(Default)]
struct Row {
    /// For each column one more than the running number that it got in the last row that has it.
    seen: Vec<u32>,
    /// Running number of the first column of this row.
    base: u32,
    /// The columns in the order of their numbers.
    columns: Vec<u32>,
    /// For each unknown of each cell the number of its column.
    numbers: Vec<u32>,
    /// The position in the row of each column.
    ranks: Vec<u32>,
}

impl Row {
    #[inline(always)]
    fn make_room(&mut self, most: usize) {
        if self.numbers.len() < most {
            self.columns.resize(most + LANES, 0);
            self.ranks.resize(most + LANES, 0);
            self.numbers.resize(most, 0);
        }
    }
}

/// Columns compared at once.
const LANES: usize = 8;

/// Longest row ranked by comparing all pairs, which vectorises; longer ones are sorted.
const ALL_PAIRS: usize = 128;

/// The position of each of the first `n` columns in their sorted order; the others are overwritten.
#[inline(always)]
fn rank(columns: &mut [u32], n: usize, ranks: &mut [u32]) {
    if n > ALL_PAIRS {
        return sort(&columns[..n], ranks);
    }
    columns[n..].fill(u32::MAX);
    for (ranks, own) in ranks.chunks_exact_mut(LANES).zip(columns.chunks_exact(LANES)) {
        let mut below = [0_u32; LANES];
        for &other in &columns[..n] {
            for k in 0..LANES {
                below[k] += u32::from(other < own[k]);
            }
        }
        ranks.copy_from_slice(&below);
    }
}

#[cold]
fn sort(columns: &[u32], ranks: &mut [u32]) {
    let mut order: Vec<u32> = (0..columns.len() as u32).collect();
    order.sort_unstable_by_key(|&k| columns[k as usize]);
    for (rank, k) in order.into_iter().enumerate() {
        ranks[k as usize] = rank as u32;
    }
}
