//! Rows of broken spaces: each cell writes its own, once, in place.
//!
//! The rows of a cell consist of dense blocks, one for the cell and one for each cell coupled to
//! it, in ascending order of cells. A facet's form is evaluated from each of its two sides for the
//! rows of that side, so no local matrix is ever stored and no two cells write to the same place.
//!
//! A form is bilinear in moments, so on each facet it comes down to a few numbers: the products of
//! jumps are those of the reference cell, and fluxes of one moment make a matrix of rank one.

use std::convert::Infallible;

use super::lifted::{LiftTable, Lifting};
use super::local::{CellSide, StiffnessTable, vector, zero_local};
use super::metric::Metrics;
use super::products::JumpProducts;
use super::space::Space;
use super::tables::FacetTable;
use super::weights::{FacetWeight, FacetWeights};
use super::{count, data, parallel};
use crate::algebra::SparseMatrix;
use crate::facet::AnyForm;
use crate::mesh::{BoundaryPart, Neighbour, Neighbours};
use crate::real::Real;

/// The cells coupled to a cell, itself included, ascending.
pub(super) struct Coupled {
    /// At most the cell, its neighbours and theirs.
    cells: [u32; 17],
    n: usize,
}

impl Coupled {
    /// The cell with its neighbours and, where jumps are lifted, the neighbours of these.
    #[inline(always)]
    fn of<const D: usize>(neighbours: &Neighbours, cell: usize, lifted: bool) -> Self {
        let mut found = Self { cells: [u32::MAX; 17], n: 1 };
        found.cells[0] = cell as u32;
        for local in 0..=D {
            if let Neighbour::Cell { cell: other, .. } = neighbours.across(cell, local) {
                if !lifted {
                    found.insert(other);
                    continue;
                }
                // around a vertex or an edge of three cells each is the neighbour of the others
                found.insert_new(other);
                for local in 0..=D {
                    if let Neighbour::Cell { cell, .. } = neighbours.across(other as usize, local) {
                        found.insert_new(cell);
                    }
                }
            }
        }
        found
    }
    #[inline(always)]
    fn insert(&mut self, other: u32) {
        let mut k = self.n;
        while k > 0 && self.cells[k - 1] > other {
            self.cells[k] = self.cells[k - 1];
            k -= 1;
        }
        self.cells[k] = other;
        self.n += 1;
    }
    fn insert_new(&mut self, other: u32) {
        if !self.cells[..self.n].contains(&other) {
            self.insert(other);
        }
    }
    /// The place of a coupled cell among them.
    #[inline(always)]
    pub fn position(&self, cell: usize) -> usize {
        self.cells[..self.n].iter().position(|&c| c == cell as u32).unwrap_or(0)
    }
}

/// The pattern, with values zero.
pub(super) fn pattern<T: Real, const D: usize>(
    space: &Space<'_, T, D>,
    lifted: bool,
) -> SparseMatrix<T> {
    let neighbours = space.coupled_neighbours();
    let n = space.per_cell();
    let n_cells = space.mesh.n_cells();
    let mut row_starts = Vec::with_capacity(n * n_cells + 1);
    row_starts.push(0_u32);
    let mut end = 0;
    for cell in 0..n_cells {
        let length = Coupled::of::<D>(neighbours, cell, lifted).n * n;
        for _ in 0..n {
            end += length as u32;
            row_starts.push(end);
        }
    }
    let mut columns = vec![0_u32; end as usize];
    for_each_cell(&row_starts, n, &mut columns, |cell, rows| {
        let coupled = Coupled::of::<D>(neighbours, cell, lifted);
        for row in rows.chunks_exact_mut(coupled.n * n) {
            for (block, &other) in row.chunks_exact_mut(n).zip(&coupled.cells) {
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

/// All that the loop over cells reads.
struct Filling<'s, 'a, T: Real, const D: usize> {
    space: &'s Space<'a, T, D>,
    neighbours: &'s Neighbours,
    metrics: &'s Metrics<T>,
    weights: &'s FacetWeights<T>,
    stiffness: StiffnessTable<T>,
    facets: FacetTable<T>,
    jumps: JumpProducts<T>,
    /// By what the penalty is multiplied for each moment that has a flux.
    flux_moments: Vec<T>,
    lifted: bool,
}

/// The values, on a known pattern.
pub(super) fn fill<T: Real, const D: usize>(
    space: &Space<'_, T, D>,
    form: &dyn AnyForm<T, D>,
    metrics: &Metrics<T>,
    weights: &FacetWeights<T>,
    matrix: &mut SparseMatrix<T>,
) {
    let facets = space.facet_table(form.moments(space.degree));
    let of_degree = |k| form.moment_weight(k);
    let has_flux = |k: &&usize| form.uses_flux() && **k < space.degree;
    let filling = Filling {
        space,
        neighbours: space.coupled_neighbours(),
        metrics,
        weights,
        stiffness: space.stiffness_table(),
        jumps: JumpProducts::new::<D>(&facets, of_degree),
        flux_moments: facets.degrees.iter().filter(has_flux).map(|&k| of_degree(k)).collect(),
        facets,
        lifted: form.is_lifted(),
    };
    let SparseMatrix { row_starts, values, .. } = matrix;
    match (D, space.per_cell()) {
        (1, 2) => filling.fill::<2>(row_starts, values),
        (1, 3) | (2, 3) => filling.fill::<3>(row_starts, values),
        (2, 6) => filling.fill::<6>(row_starts, values),
        (3, 4) => filling.fill::<4>(row_starts, values),
        (3, 10) => filling.fill::<10>(row_starts, values),
        _ => filling.fill::<0>(row_starts, values),
    }
    if form.is_lifted() {
        let table = LiftTable::new(space);
        let lifting = Lifting { space, form, metrics, table: &table };
        filling.add_to_cells(row_starts, values, &|cell, coupled, rows| {
            lifting.add(filling.neighbours, cell, coupled, rows);
        });
    }
    if let Some(reaction) = data::ReactionTerm::new(space) {
        let n = space.per_cell();
        filling.add_to_cells(row_starts, values, &|cell, coupled, rows| {
            let mut own = zero_local();
            reaction.add(space.mesh, cell, metrics.at::<D>(cell).volume, &mut own);
            let block = coupled.position(cell) * n;
            for (row, values) in rows.chunks_exact_mut(coupled.n * n).zip(&own) {
                for (entry, value) in row[block..].iter_mut().zip(&values[..n]) {
                    *entry += *value;
                }
            }
        });
    }
}

/// What adds to the rows of a cell.
type AddToCell<'w, T> = &'w (dyn Fn(usize, &Coupled, &mut [T]) + Sync);

impl<T: Real, const D: usize> Filling<'_, '_, T, D> {
    /// Calls a function with each cell and its rows.
    fn add_to_cells(&self, row_starts: &[u32], values: &mut [T], add: AddToCell<'_, T>) {
        for_each_cell(row_starts, self.space.per_cell(), values, |cell, rows| {
            add(cell, &Coupled::of::<D>(self.neighbours, cell, self.lifted), rows);
        });
    }

    /// The rows of all cells, for elements of `N` functions; any number for `N = 0`.
    fn fill<const N: usize>(&self, row_starts: &[u32], values: &mut [T]) {
        for_each_cell(row_starts, self.space.per_cell(), values, |cell, rows| {
            let coupled = Coupled::of::<D>(self.neighbours, cell, self.lifted);
            if self.lifted {
                rows.fill(T::lit(0.0));
            }
            let rows =
                Rows::<T, N> { n: self.n::<N>(), row: rows.len() / self.n::<N>(), entries: rows };
            self.write_cell(cell, &coupled, rows);
        });
    }
    #[inline(always)]
    fn n<const N: usize>(&self) -> usize {
        if N == 0 { self.space.per_cell() } else { N }
    }

    /// Writes the rows of a cell: its stiffness and the form on its facets.
    #[inline(always)]
    fn write_cell<const N: usize>(&self, cell: usize, coupled: &Coupled, mut rows: Rows<'_, T, N>) {
        let n = self.n::<N>();
        let metric = self.metrics.at(cell);
        let coefficient = self.space.alpha(cell);
        let own = coupled.position(cell) * n;
        rows.write(own, |i, j| coefficient * self.stiffness.entry::<D>(&metric, i, j));
        for local in 0..=D {
            let me = CellSide { cell, local, metric: &metric, coefficient };
            match self.neighbours.across(cell, local) {
                Neighbour::Cell { cell: other, local: other_local } => {
                    let other = other as usize;
                    let there = (other, other_local as usize);
                    let from_here = cell < other;
                    let here = if from_here { (cell, local) } else { there };
                    let weight = self.weights.at::<D>(here, from_here);
                    let across = coupled.position(other) * n;
                    self.write_across(&me, there, &weight, across, &mut rows);
                    self.add_facet(&me, Some((there, across)), &weight, own, &mut rows);
                }
                Neighbour::Boundary(BoundaryPart::Dirichlet) if !self.space.pins => {
                    let weight = self.weights.at::<D>((cell, local), true);
                    self.add_facet(&me, None, &weight, own, &mut rows);
                }
                Neighbour::Boundary(_) => {}
            }
        }
    }

    /// Writes the products of jumps to the columns of the cell across.
    #[inline(always)]
    fn write_across<const N: usize>(
        &self,
        me: &CellSide<'_, T, D>,
        (_, other_local): (usize, usize),
        weight: &FacetWeight<T>,
        across: usize,
        rows: &mut Rows<'_, T, N>,
    ) {
        let form = &self.weights.coefficients;
        let measure = me.metric.measures[me.local];
        let products = self.jumps.across(me.local, other_local);
        for (class, (products, &factor)) in products.iter().zip(&self.jumps.weights).enumerate() {
            let scale = -measure * form.jump_jump.at(weight.penalty * factor);
            if class == 0 {
                rows.write(across, |i, j| scale * products[i][j]);
            } else {
                rows.add(across, |i, j| scale * products[i][j]);
            }
        }
    }

    /// Adds the products of jumps to the columns of the cell whose rows these are, and all products
    /// with fluxes to its columns and to those of the cell across.
    ///
    /// Jumps and fluxes both flip their sign with the direction of the normal, so their products do
    /// not: here normals point out of the cell whose rows these are.
    #[inline(always)]
    fn add_facet<const N: usize>(
        &self,
        me: &CellSide<'_, T, D>,
        other: Option<((usize, usize), usize)>,
        weight: &FacetWeight<T>,
        own: usize,
        rows: &mut Rows<'_, T, N>,
    ) {
        count::facets(1);
        let form = &self.weights.coefficients;
        let measure = me.metric.measures[me.local];
        let products = self.jumps.own(me.local);
        for (products, &class) in products.iter().zip(&self.jumps.weights) {
            let scale = measure * form.jump_jump.at(weight.penalty * class);
            rows.add(own, |i, j| scale * products[i][j]);
        }
        if self.flux_moments.is_empty() {
            return;
        }
        let n = if N == 0 { rows.n } else { N };
        let other_metric = other.map(|((cell, _), _)| self.metrics.at::<D>(cell));
        for (k, &class) in self.flux_moments.iter().enumerate() {
            let penalty = weight.penalty * class;
            let flux_flux = form.flux_flux.at(penalty) / measure;
            let (jump_flux, flux_jump) = (form.jump_flux.at(penalty), form.flux_jump.at(penalty));
            let mine = &self.facets.on(me.local)[k];
            let flux = me.normal_derivatives(mine, n, weight.own_share);
            let by_flux = vector(n, |i| jump_flux * mine.values[i] + flux_flux * flux[i]);
            let by_jump = vector(n, |i| flux_jump * flux[i]);
            rows.add(own, |i, j| by_flux[i] * flux[j] + by_jump[i] * mine.values[j]);
            if let (Some(((cell, local), across)), Some(metric)) = (other, &other_metric) {
                let coefficient = self.space.alpha(cell);
                let other = CellSide { cell, local, metric, coefficient };
                let theirs = &self.facets.on(local)[k];
                let other_flux = other.normal_derivatives(theirs, n, -weight.other_share);
                rows.add(across, |i, j| by_flux[i] * other_flux[j] - by_jump[i] * theirs.values[j]);
            }
        }
    }
}

/// The rows of a cell, `n` of them; `N` is that number where it is known in advance.
struct Rows<'r, T, const N: usize> {
    n: usize,
    /// Length of each.
    row: usize,
    entries: &'r mut [T],
}

impl<T: Real, const N: usize> Rows<'_, T, N> {
    #[inline(always)]
    fn block(&mut self, i: usize, start: usize) -> &mut [T] {
        let n = if N == 0 { self.n } else { N };
        &mut self.entries[i * self.row + start..i * self.row + start + n]
    }
    /// Writes a dense block that starts at this column.
    #[inline(always)]
    fn write(&mut self, start: usize, entry: impl Fn(usize, usize) -> T) {
        let n = if N == 0 { self.n } else { N };
        for i in 0..n {
            let out = self.block(i, start);
            for j in 0..n {
                out[j] = entry(i, j);
            }
        }
    }
    /// Adds to a dense block that starts at this column.
    #[inline(always)]
    fn add(&mut self, start: usize, entry: impl Fn(usize, usize) -> T) {
        let n = if N == 0 { self.n } else { N };
        for i in 0..n {
            let out = self.block(i, start);
            for j in 0..n {
                out[j] += entry(i, j);
            }
        }
    }
}
