//! The pattern of a space that shares unknowns, and where in it each cell adds its matrix.

use std::ops::Range;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::parallel::{for_each_item, map_indices};

use super::unknowns::{CellUnknowns, Rows, with_constant_count};
use crate::algebra::SparseMatrix;
use crate::assemble::space::dofs::{Dofs, KINDS};
use crate::memory::in_large_pages;
use crate::mesh::incidence::{Blocks, Incidence, Stars, partition};
use crate::mesh::neighbour_numbers::{LANES, NeighbourNumbers, rank};

/// Where each cell adds its matrix: made with the pattern, kept for every filling of it.
pub(crate) struct EntryPositions {
    /// For each cell, its unknown `i` and its unknown `j`: the position of column `j` in row `i`.
    ///
    /// In rows of more than 256 entries a byte does not hold the position, and filling searches for
    /// it. The bytes are atomic because two threads may make the rows of one cell, each thread the
    /// positions in its own rows.
    pub in_rows: Vec<AtomicU8>,
    /// The cells in blocks.
    pub blocks: Blocks<KINDS>,
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
    with_constant_count!(D, dofs, N => pattern_with::<D, N>(dofs))
}

/// As [`pattern`], for cells of `N` unknowns.
fn pattern_with<const D: usize, const N: usize>(
    dofs: &Dofs<'_>,
) -> (SparseMatrix<f64>, EntryPositions) {
    let of_cell = CellUnknowns::<D, N>::new(dofs);
    let consecutive: Vec<u32>;
    let table = match dofs.table() {
        Some(table) => table,
        None => {
            consecutive = (0..dofs.size() as u32).collect();
            &consecutive
        }
    };
    let in_rows = zeros(table.len() * of_cell.count());
    let incidence = Incidence::new(table, of_cell);
    let builder = PatternBuilder { size: dofs.size(), incidence, in_rows: &in_rows };
    let subsets = partition(dofs.kinds());
    let build = |k: usize| builder.rows(&subsets[k]);
    let mut made: Vec<PatternOfSubset> = map_indices(subsets.len(), &build);
    let row_starts = row_starts(dofs.size(), &made);
    let columns = columns_of(&row_starts, &mut made);
    let nonzeros = columns.len();
    let values = in_large_pages(vec![0.0; nonzeros]);
    let matrix = SparseMatrix { row_starts, columns, values };
    let blocks = builder.incidence.blocks;
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
    /// Number of unknowns.
    size: usize,
    incidence: Incidence<'m, CellUnknowns<D, N>, KINDS>,
    in_rows: &'m [AtomicU8],
}

impl<const D: usize, const N: usize> PatternBuilder<'_, D, N> {
    /// The rows of a subset, in pieces, so that scratch memory is small and used again.
    ///
    /// Not inlined into the parallel loop: all the loops over cells would be optimised twice.
    #[inline(never)]
    fn rows(&self, subset: &Rows) -> PatternOfSubset {
        let mut stars = Stars::default();
        let mut last = in_large_pages(vec![0; self.size]);
        let mut neighbours = NeighbourNumbers::new(&mut last);
        let mut row = Row::default();
        let mut made = self.room_for(subset);
        for piece in self.incidence.blocks.pieces_of(subset) {
            self.incidence.find_stars(&piece, &mut stars);
            let mut k = 0;
            for (rows, made) in piece.iter().zip(&mut made) {
                for _ in rows.clone() {
                    self.row(stars.of(k), &mut neighbours, &mut row, made);
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
        let entries = |rows: &Range<u32>| self.in_rows.len() / self.size * rows.len();
        subset.each_ref().map(|rows| PatternOfRows {
            columns: in_large_pages(Vec::with_capacity(entries(rows))),
            lengths: in_large_pages(Vec::with_capacity(rows.len())),
        })
    }

    /// Makes a row from its star, and the positions of the star's cells in it.
    #[inline(always)]
    fn row(
        &self,
        star: &[u32],
        neighbours: &mut NeighbourNumbers<'_>,
        row: &mut Row,
        made: &mut PatternOfRows,
    ) {
        let (table, per_cell) = (self.incidence.table, self.incidence.columns.count());
        row.make_room(star.len() * per_cell);
        let Row { columns, numbers, ranks } = row;
        let columns = &mut columns[..];
        neighbours.next_vertex();
        for (&place, numbers) in star.iter().zip(numbers.chunks_exact_mut(per_cell)) {
            let first = place as usize / per_cell * per_cell;
            let unknowns = &table[first..first + per_cell];
            for j in 0..per_cell {
                let number = neighbours.get_or_push(unknowns[j]);
                numbers[j] = number;
                columns[number as usize] = unknowns[j];
            }
        }
        let n = neighbours.count();
        rank(columns, n, ranks);
        let start = made.columns.len();
        made.columns.resize(start + n, 0);
        let out = &mut made.columns[start..];
        for (&rank, &column) in ranks[..n].iter().zip(&columns[..n]) {
            out[rank as usize] = column;
        }
        made.lengths.push(n as u32);
        for (&place, numbers) in star.iter().zip(numbers.chunks_exact(per_cell)) {
            let positions = &self.in_rows[place as usize * per_cell..][..per_cell];
            for (position, &number) in positions.iter().zip(numbers) {
                position.store(ranks[number as usize] as u8, Ordering::Relaxed);
            }
        }
    }
}

/// A row in the making.
#[derive(Default)]
struct Row {
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
