//! The pattern of a space that shares unknowns, and where in it each cell adds its matrix.

use std::sync::atomic::{AtomicU8, Ordering};

use rayon::prelude::*;

use super::cut::{Blocks, Rows, pieces};
use crate::algebra::SparseMatrix;
use crate::assemble::dofs::{Dofs, kind_of};
use crate::element::ReferenceElement;
use crate::real::Real;

/// Where each cell adds its matrix: made with the pattern, kept for every filling of it.
pub(in crate::assemble) struct Places {
    /// For each cell, its unknown `i` and its unknown `j`: the place of column `j` in row `i`.
    ///
    /// Of rows with more than 256 entries the places are wrong, and are searched for instead.
    /// Atomic because the rows of one cell may be made by two threads, each its own places.
    pub places: Vec<AtomicU8>,
    /// The cells in blocks.
    pub blocks: Blocks,
    /// Entries of the pattern.
    pub nonzeros: usize,
}

/// Longest row whose places a byte can name.
pub(super) const LONGEST: usize = 256;

/// Rows of a piece, kind after kind: their columns and lengths.
struct Made {
    columns: Vec<u32>,
    lengths: Vec<u32>,
}

/// The pattern, with values zero; the places are left with the numbering.
pub(super) fn pattern<T: Real, const D: usize, E: ReferenceElement<T, D>>(
    dofs: &Dofs<'_>,
) -> SparseMatrix<T> {
    let blocks = Blocks::new(dofs, |i| kind_of(E::LAYOUT, D, i));
    let places = zeros(dofs.n_cells() * E::N * E::N);
    let cut = pieces(dofs);
    let make = |rows: &Rows| Maker { dofs, blocks: &blocks, places: &places }.rows::<T, E, D>(rows);
    let mut made: Vec<Made> = cut.par_iter().map(make).collect();
    let row_starts = row_starts(dofs.size(), &cut, &made);
    let columns = match &mut made[..] {
        // kind after kind, the rows of a single piece are all rows in order
        [only] => std::mem::take(&mut only.columns),
        _ => join(&row_starts, &cut, &made),
    };
    let nonzeros = columns.len();
    // a numbering has one pattern: what another thread may have left here is the same
    let _ = dofs.places.set(Places { places, blocks, nonzeros });
    SparseMatrix { row_starts, columns, values: vec![T::lit(0.0); nonzeros] }
}

fn zeros(n: usize) -> Vec<AtomicU8> {
    // bytes that the system hands out as zeros, taken for what they are in place
    vec![0_u8; n].into_iter().map(AtomicU8::new).collect()
}

/// Where rows start, from their lengths.
fn row_starts(size: usize, cut: &[Rows], made: &[Made]) -> Vec<u32> {
    let mut starts = Vec::with_capacity(size + 1);
    starts.push(0);
    let mut end = 0;
    let mut used = vec![0; cut.len()];
    for kind in 0..cut[0].len() {
        for ((rows, piece), used) in cut.iter().zip(made).zip(&mut used) {
            let lengths = &piece.lengths[*used..*used + rows[kind].len()];
            *used += lengths.len();
            starts.extend(lengths.iter().map(|length| {
                end += length;
                end
            }));
        }
    }
    starts
}

/// The columns of all pieces in the order of rows.
fn join(row_starts: &[u32], cut: &[Rows], made: &[Made]) -> Vec<u32> {
    let mut columns = vec![0; row_starts[row_starts.len() - 1] as usize];
    let mut copies = Vec::new();
    let mut rest = &mut columns[..];
    let mut used = vec![0; cut.len()];
    for kind in 0..cut[0].len() {
        for ((rows, piece), used) in cut.iter().zip(made).zip(&mut used) {
            let rows = &rows[kind];
            let entries = row_starts[rows.end as usize] - row_starts[rows.start as usize];
            let (out, tail) = rest.split_at_mut(entries as usize);
            copies.push((out, &piece.columns[*used..*used + entries as usize]));
            *used += entries as usize;
            rest = tail;
        }
    }
    copies.into_par_iter().for_each(|(out, from)| out.copy_from_slice(from));
    columns
}

/// What the rows of a piece are made from.
struct Maker<'m> {
    dofs: &'m Dofs<'m>,
    blocks: &'m Blocks,
    places: &'m [AtomicU8],
}

impl Maker<'_> {
    /// For each row of a piece the cells that have it: where they start, and each cell times `N`
    /// plus the number of the unknown in it.
    #[inline(always)]
    fn incidence<T: Real, E: ReferenceElement<T, D>, const D: usize>(
        &self,
        rows: &Rows,
    ) -> (Vec<u32>, Vec<u32>) {
        let mut n_rows = 0;
        let offsets = rows.each_ref().map(|rows| {
            n_rows += rows.len();
            n_rows - rows.len()
        });
        // counts two places on become, summed, starts one place on, which filling makes starts
        let mut starts = vec![0_u32; n_rows + 2];
        let mut numbers = Vec::new();
        let mut visit = |visit: &mut dyn FnMut(usize, usize)| {
            for (cells, ..) in self.blocks.of(rows) {
                let first = cells.start;
                let unknowns = self.dofs.of_cells(cells, &mut numbers);
                for (c, unknowns) in unknowns.chunks_exact(E::N).enumerate() {
                    for i in 0..E::N {
                        let kind = kind_of(E::LAYOUT, D, i);
                        let row = unknowns[i].wrapping_sub(rows[kind].start);
                        if (row as usize) < rows[kind].len() {
                            visit(offsets[kind] + row as usize, (first + c) * E::N + i);
                        }
                    }
                }
            }
        };
        visit(&mut |row, _| starts[row + 2] += 1);
        for row in 0..n_rows {
            starts[row + 2] += starts[row + 1];
        }
        let mut slots = vec![0_u32; starts[n_rows + 1] as usize];
        visit(&mut |row, slot| {
            let at = &mut starts[row + 1];
            slots[*at as usize] = slot as u32;
            *at += 1;
        });
        (starts, slots)
    }

    /// The rows of a piece.
    fn rows<T: Real, E: ReferenceElement<T, D>, const D: usize>(&self, rows: &Rows) -> Made {
        let (starts, slots) = self.incidence::<T, E, D>(rows);
        let n_rows = starts.len() - 2;
        let table = self.dofs.table();
        let mut row = Row { seen: vec![0; self.dofs.size()], ..Row::default() };
        let mut columns = Vec::with_capacity(slots.len());
        let mut lengths = Vec::with_capacity(n_rows);
        for k in 0..n_rows {
            let slots = &slots[starts[k] as usize..starts[k + 1] as usize];
            row.start(columns.len() as u32, slots.len() * E::N);
            for (&slot, met) in slots.iter().zip(row.met.chunks_exact_mut(E::N)) {
                let first = slot as usize / E::N * E::N;
                let unknowns = table.as_ref().map(|t| &t[first..first + E::N]);
                for j in 0..E::N {
                    let column = unknowns.map_or((first + j) as u32, |u| u[j]);
                    let seen = &mut row.seen[column as usize];
                    let is_new = *seen <= row.base;
                    let number = if is_new { row.n as u32 } else { *seen - row.base - 1 };
                    *seen = row.base + number + 1;
                    met[j] = number;
                    row.columns[row.n] = column;
                    row.n += usize::from(is_new);
                }
            }
            row.rank();
            row.append_to(&mut columns);
            lengths.push(row.n as u32);
            for (&slot, met) in slots.iter().zip(row.met.chunks_exact(E::N)) {
                let places = &self.places[slot as usize * E::N..][..E::N];
                for (place, &number) in places.iter().zip(met) {
                    place.store(row.ranks[number as usize] as u8, Ordering::Relaxed);
                }
            }
        }
        columns.shrink_to_fit();
        Made { columns, lengths }
    }
}

/// A row in the making: its columns in the order in which they are met.
#[derive(Default)]
struct Row {
    /// For each column one more than the running number at which it was last met first.
    seen: Vec<u32>,
    /// Running number of the first column of this row.
    base: u32,
    /// How many columns were met.
    n: usize,
    columns: Vec<u32>,
    /// For each unknown of each cell the number of its column.
    met: Vec<u32>,
    /// The place in the row of each column.
    ranks: Vec<u32>,
}

/// Columns compared at once.
const LANES: usize = 8;

/// Longest row ranked by comparing all pairs, which vectorises; longer ones are sorted.
const ALL_PAIRS: usize = 128;

impl Row {
    #[inline(always)]
    fn start(&mut self, base: u32, most: usize) {
        (self.base, self.n) = (base, 0);
        if self.columns.len() < most + LANES {
            self.columns.resize(most + LANES, 0);
            self.ranks.resize(most + LANES, 0);
            self.met.resize(most, 0);
        }
    }
    /// Finds the place of each column.
    #[inline(always)]
    fn rank(&mut self) {
        if self.n > ALL_PAIRS {
            return self.sort();
        }
        self.columns[self.n..self.n + LANES].fill(u32::MAX);
        let padded = &self.columns[..self.n.next_multiple_of(LANES)];
        for (rank, &column) in self.ranks.iter_mut().zip(&self.columns[..self.n]) {
            let mut below = [0_u32; LANES];
            for others in padded.chunks_exact(LANES) {
                for k in 0..LANES {
                    below[k] += u32::from(others[k] < column);
                }
            }
            *rank = below.iter().sum();
        }
    }
    #[cold]
    fn sort(&mut self) {
        let mut order: Vec<u32> = (0..self.n as u32).collect();
        order.sort_unstable_by_key(|&k| self.columns[k as usize]);
        for (rank, k) in order.into_iter().enumerate() {
            self.ranks[k as usize] = rank as u32;
        }
    }
    #[inline(always)]
    fn append_to(&self, columns: &mut Vec<u32>) {
        let start = columns.len();
        columns.resize(start + self.n, 0);
        let out = &mut columns[start..];
        for (&rank, &column) in self.ranks.iter().zip(&self.columns[..self.n]) {
            out[rank as usize] = column;
        }
    }
}
