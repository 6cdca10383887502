//! Rows of broken spaces: each cell writes its own, once, in place.
//!
//! The rows of a cell consist of dense blocks, one for the cell and one for each neighbour, in
//! ascending order of cells. A facet's form is evaluated from each of its two sides for the rows of
//! that side, so no local matrix is ever stored and no two cells write to the same place.

use std::convert::Infallible;

use super::local::{CellSide, FacetGeometry, Local, add_stiffness, traces, zero_local};
use super::tables::{CellTable, FacetTable};
use super::{Discretisation, count, data, parallel};
use crate::algebra::SparseMatrix;
use crate::element::ReferenceElement;
use crate::facet::FacetForm;
use crate::mesh::{BoundaryPart, CellGeometry, Neighbour, Neighbours};
use crate::real::Real;
use crate::scheme::{DirichletBy, Scheme};

/// The cells coupled to a cell, itself included, ascending; at most `D + 2`.
#[inline(always)]
fn coupled<const D: usize>(neighbours: &Neighbours, cell: usize) -> ([u32; 5], usize) {
    let mut blocks = [u32::MAX; 5];
    blocks[0] = cell as u32;
    let mut n = 1;
    for local in 0..=D {
        if let Neighbour::Cell { cell: other, .. } = neighbours.across(cell, local) {
            let mut k = n;
            while k > 0 && blocks[k - 1] > other {
                blocks[k] = blocks[k - 1];
                k -= 1;
            }
            blocks[k] = other;
            n += 1;
        }
    }
    (blocks, n)
}

/// The pattern, with values zero.
pub(super) fn pattern<T: Real, const D: usize, S: Scheme<T, D>>(
    discretisation: &Discretisation<'_, T, D, S>,
) -> SparseMatrix<T> {
    let space = &discretisation.space;
    let neighbours = space.coupled_neighbours();
    let n = Discretisation::<T, D, S>::N;
    let n_cells = space.mesh.n_cells();
    let mut row_starts = Vec::with_capacity(n * n_cells + 1);
    row_starts.push(0_u32);
    let mut end = 0;
    for cell in 0..n_cells {
        let length = coupled::<D>(neighbours, cell).1 * n;
        for _ in 0..n {
            end += length as u32;
            row_starts.push(end);
        }
    }
    let mut columns = vec![0_u32; end as usize];
    for_each_cell(&row_starts, n, &mut columns, |cell, rows| {
        let (blocks, n_blocks) = coupled::<D>(neighbours, cell);
        for row in rows.chunks_exact_mut(n_blocks * n) {
            for (block, &other) in row.chunks_exact_mut(n).zip(&blocks) {
                for (j, column) in block.iter_mut().enumerate() {
                    *column = other * n as u32 + j as u32;
                }
            }
        }
    });
    let values = vec![T::lit(0.0); end as usize];
    SparseMatrix { row_starts, columns, values }
}

/// Calls a function with each cell and the entries of its rows, in parallel.
fn for_each_cell<V: Send>(
    row_starts: &[u32],
    n: usize,
    entries: &mut [V],
    work: impl Fn(usize, &mut [V]) + Sync,
) {
    let end = |cell: usize| row_starts[cell * n] as usize;
    let piece = |cells: std::ops::Range<usize>, mut piece: &mut [V]| {
        for cell in cells {
            let (rows, tail) = piece.split_at_mut(end(cell + 1) - end(cell));
            work(cell, rows);
            piece = tail;
        }
        Ok::<(), Infallible>(())
    };
    let Ok(()) = parallel::for_each((row_starts.len() - 1) / n, &end, entries, &piece);
}

/// The values, on a known pattern.
pub(super) fn fill<T: Real, const D: usize, S: Scheme<T, D>>(
    discretisation: &Discretisation<'_, T, D, S>,
    matrix: &mut SparseMatrix<T>,
) {
    let space = &discretisation.space;
    let neighbours = space.coupled_neighbours();
    let n = Discretisation::<T, D, S>::N;
    let degree = <S::Element as ReferenceElement<T, D>>::DEGREE;
    let stiffness = CellTable::new::<S::Element, D>(2 * (degree - 1));
    let facets = FacetTable::new::<S::Element, D>(<S::Facet as FacetForm<T, D>>::sampling(degree));
    let reaction = data::ReactionTerm::new::<S::Element>(space);
    let SparseMatrix { row_starts, values, .. } = matrix;
    for_each_cell(row_starts, n, values, |cell, rows| {
        rows.fill(T::lit(0.0));
        let geometry = space.mesh.geometry(cell);
        let (blocks, n_blocks) = coupled::<D>(neighbours, cell);
        let row = n_blocks * n;
        let mut own = zero_local();
        add_stiffness::<T, D, S::Element>(&geometry, space.alpha(cell), &stiffness, &mut own);
        if let Some(reaction) = &reaction {
            reaction.add::<S::Element>(space.mesh, cell, geometry.volume, &mut own);
        }
        for local in 0..=D {
            let here = space.side(cell, local, &geometry);
            match neighbours.across(cell, local) {
                Neighbour::Cell { cell: other, local: other_local } => {
                    let other = other as usize;
                    let other_geometry = space.mesh.geometry(other);
                    let there = space.side(other, other_local as usize, &other_geometry);
                    let mut across = zero_local();
                    add_facet(discretisation, &facets, &here, &there, &mut own, &mut across);
                    let block = blocks.iter().position(|&b| b == other as u32).unwrap_or(0);
                    write_block(&across, n, block, row, rows);
                }
                Neighbour::Boundary(BoundaryPart::Dirichlet)
                    if S::DIRICHLET == DirichletBy::FacetForm =>
                {
                    add_boundary_facet(discretisation, &facets, &here, &mut own);
                }
                Neighbour::Boundary(_) => {}
            }
        }
        let block = blocks.iter().position(|&b| b == cell as u32).unwrap_or(0);
        write_block(&own, n, block, row, rows);
    });
}

#[inline(always)]
fn write_block<T: Real>(local: &Local<T>, n: usize, block: usize, row: usize, rows: &mut [T]) {
    for i in 0..n {
        let start = i * row + block * n;
        rows[start..start + n].copy_from_slice(&local[i][..n]);
    }
}

/// Adds the form on an interior facet to the rows of one of its cells: `own` for its own columns,
/// `across` for those of the other cell.
#[inline(always)]
fn add_facet<T: Real, const D: usize, S: Scheme<T, D>>(
    discretisation: &Discretisation<'_, T, D, S>,
    table: &FacetTable<T>,
    me: &CellSide<'_, T, D>,
    other: &CellSide<'_, T, D>,
    own: &mut Local<T>,
    across: &mut Local<T>,
) {
    count::facets(1);
    let n = Discretisation::<T, D, S>::N;
    let first = me.cell < other.cell;
    let (here, there) = if first { (me, other) } else { (other, me) };
    let facet = FacetGeometry::new(discretisation.space.mesh, here, Some(there));
    let sign = |is_here: bool| T::lit(if is_here { 1.0 } else { -1.0 });
    let penalty = discretisation.form.penalty(&facet.view);
    let samples = table.on(me.local).iter().zip(table.on(other.local)).zip(&table.weights);
    for ((basis, other_basis), &weight) in samples {
        let mine: CellTraces<T> =
            traces::<T, D, S::Element, S::Facet>(&facet, me.geometry, sign(first), basis);
        let theirs: CellTraces<T> =
            traces::<T, D, S::Element, S::Facet>(&facet, other.geometry, sign(!first), other_basis);
        let scale = weight * facet.view.measure;
        for i in 0..n {
            for j in 0..n {
                own[i][j] += scale * discretisation.form.integrand(mine[i], mine[j], penalty);
                across[i][j] += scale * discretisation.form.integrand(mine[i], theirs[j], penalty);
            }
        }
    }
}

type CellTraces<T> = [crate::facet::Trace<T>; crate::element::MAX_BASIS];

/// Adds the form on a Dirichlet facet.
#[inline(always)]
fn add_boundary_facet<T: Real, const D: usize, S: Scheme<T, D>>(
    discretisation: &Discretisation<'_, T, D, S>,
    table: &FacetTable<T>,
    here: &CellSide<'_, T, D>,
    own: &mut Local<T>,
) {
    count::facets(1);
    let n = Discretisation::<T, D, S>::N;
    let facet = FacetGeometry::new(discretisation.space.mesh, here, None);
    let penalty = discretisation.form.penalty(&facet.view);
    for (basis, &weight) in table.on(here.local).iter().zip(&table.weights) {
        let geometry: &CellGeometry<T, D> = here.geometry;
        let mine: CellTraces<T> =
            traces::<T, D, S::Element, S::Facet>(&facet, geometry, T::lit(1.0), basis);
        for i in 0..n {
            for j in 0..n {
                own[i][j] += weight
                    * facet.view.measure
                    * discretisation.form.integrand(mine[i], mine[j], penalty);
            }
        }
    }
}
