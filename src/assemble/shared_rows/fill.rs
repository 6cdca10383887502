//! The values of a known pattern: each cell adds its matrix at the positions noted for its entries.

use std::ops::Range;
use std::sync::atomic::Ordering;

use crate::parallel::for_each_item;

use super::pattern::{EntryPositions, LONGEST};
use super::unknowns::{CellUnknowns, Rows, with_constant_count};
use crate::algebra::SparseMatrix;
use crate::assemble::space::Space;
use crate::assemble::space::dofs::KINDS;
use crate::assemble::stiffness::StiffnessTable;
use crate::mesh::incidence::{Columns, Overlap, partition};

/// The rows of one kind in a subset, and their values.
struct Target<'v> {
    rows: Range<u32>,
    /// Where the first of them starts.
    base: usize,
    values: &'v mut [f64],
    /// How many of the values are no longer those from before.
    cleared: usize,
}

/// The values, on a known pattern.
pub(crate) fn fill<const D: usize>(
    space: &Space<'_, D>,
    positions: &EntryPositions,
    matrix: &mut SparseMatrix<f64>,
) {
    with_constant_count!(D, &space.dofs, N => fill_with::<D, N>(space, positions, matrix));
}

/// As [`fill`], for cells of `N` unknowns.
fn fill_with<const D: usize, const N: usize>(
    space: &Space<'_, D>,
    positions: &EntryPositions,
    matrix: &mut SparseMatrix<f64>,
) {
    let dofs = &space.dofs;
    let SparseMatrix { row_starts, columns, values } = matrix;
    let same = row_starts.len() == dofs.size() + 1 && values.len() == positions.nonzeros;
    assert!(same, "the matrix has the pattern of another discretisation");
    let unknowns = CellUnknowns::<D, N>::new(dofs);
    let table = space.stiffness_table();
    let filling = Filling { space, row_starts, columns, positions, table, unknowns };
    let subsets = partition(dofs.kinds());
    let targets = targets(&subsets, row_starts, values);
    for_each_item(targets, &|k, targets| filling.fill_subset(&subsets[k], targets));
}

/// Divides the values among the subsets: each subset has the values of its rows.
fn targets<'v>(
    subsets: &[Rows],
    row_starts: &[u32],
    values: &'v mut [f64],
) -> Vec<[Target<'v>; KINDS]> {
    let mut rest = values;
    let mut by_kind = [const { Vec::new() }; KINDS];
    for (kind, targets) in by_kind.iter_mut().enumerate() {
        for rows in subsets {
            let rows = rows[kind].clone();
            let base = row_starts[rows.start as usize] as usize;
            let (values, tail) = rest.split_at_mut(row_starts[rows.end as usize] as usize - base);
            targets.push(Target { rows, base, values, cleared: 0 });
            rest = tail;
        }
    }
    let mut by_kind = by_kind.map(Vec::into_iter);
    let next = |_| by_kind.each_mut().map(|targets| targets.next());
    let of_subsets = (0..subsets.len()).map(next);
    of_subsets
        .map(|subset| subset.map(|target| target.expect("a target for every subset")))
        .collect()
}

impl Target<'_> {
    /// Sets the values before a row to zero just before entries are added to them: they are then in
    /// the cache.
    #[inline(always)]
    fn clear_before(&mut self, row: u32, row_starts: &[u32]) {
        let row = row.min(self.rows.end);
        if row > self.rows.start {
            let end = row_starts[row as usize] as usize - self.base;
            if end > self.cleared {
                self.values[self.cleared..end].fill(0.0);
                self.cleared = end;
            }
        }
    }
}

/// All that the loop over cells reads.
struct Filling<'f, 's, const D: usize, const N: usize> {
    space: &'f Space<'s, D>,
    row_starts: &'f [u32],
    columns: &'f [u32],
    positions: &'f EntryPositions,
    table: StiffnessTable,
    unknowns: CellUnknowns<D, N>,
}

impl<const D: usize, const N: usize> Filling<'_, '_, D, N> {
    /// Not inlined into the parallel loop: all the loops over cells would be optimised twice.
    #[inline(never)]
    fn fill_subset(&self, rows: &Rows, mut targets: [Target<'_>; KINDS]) {
        for (cells, overlap, hull) in self.positions.blocks.of(rows) {
            for (target, hull) in targets.iter_mut().zip(hull) {
                target.clear_before(hull.end, self.row_starts);
            }
            match overlap {
                Overlap::Inside => self.add::<true>(cells, &mut targets),
                _ => self.add::<false>(cells, &mut targets),
            }
        }
        for target in &mut targets {
            target.clear_before(target.rows.end, self.row_starts);
        }
    }

    /// Adds the matrices of the cells of a block to those of their rows that the targets have.
    #[inline(always)]
    fn add<const INSIDE: bool>(&self, cells: Range<usize>, targets: &mut [Target<'_>; KINDS]) {
        let mut numbers = Vec::new();
        // a copy stays in registers, whatever is written to the values
        let of_cell = self.unknowns;
        let n = of_cell.count();
        let square = n * n;
        let positions = &self.positions.in_rows[cells.start * square..cells.end * square];
        let unknowns = self.space.dofs.of_cells(cells.clone(), &mut numbers);
        let each = unknowns.chunks_exact(n).zip(positions.chunks_exact(square)).zip(cells);
        for ((unknowns, positions), cell) in each {
            let has = |i: usize| targets[of_cell.kind(i)].rows.contains(&unknowns[i]);
            if !INSIDE && !(0..n).any(has) {
                continue;
            }
            let matrix = self.matrix(cell);
            for i in 0..n {
                let target = &mut targets[of_cell.kind(i)];
                if INSIDE || target.rows.contains(&unknowns[i]) {
                    let row = unknowns[i] as usize;
                    let start = self.row_starts[row] as usize - target.base;
                    let end = self.row_starts[row + 1] as usize - target.base;
                    let out = &mut target.values[start..end];
                    if out.len() <= LONGEST {
                        for j in 0..n {
                            let position = positions[i * n + j].load(Ordering::Relaxed);
                            out[position as usize] += matrix[i][j];
                        }
                    } else {
                        let columns = &self.columns[start + target.base..end + target.base];
                        add_by_search(out, columns, unknowns, &|j| matrix[i][j]);
                    }
                }
            }
        }
    }

    /// The matrix of a cell.
    #[inline(always)]
    fn matrix(&self, cell: usize) -> [[f64; N]; N] {
        let (volume, products) = self.space.shape(cell, 1.0);
        let mut matrix = self.space.stiffness(&self.table, cell, &products);
        self.space.add_reaction(cell, volume, &mut matrix);
        matrix
    }
}

/// Adds the entries of some unknowns to a row whose positions are not noted, by searching its columns.
#[cold]
#[inline(never)]
pub(super) fn add_by_search(
    out: &mut [f64],
    columns: &[u32],
    unknowns: &[u32],
    entry: &dyn Fn(usize) -> f64,
) {
    for (j, unknown) in unknowns.iter().enumerate() {
        let at = columns.binary_search(unknown).expect("the pattern has all that is added to it");
        out[at] += entry(j);
    }
}
