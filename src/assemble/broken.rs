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
use super::local::{CellSide, StiffnessTable, zero_local};
use super::metric::Metrics;
use super::products::JumpProducts;
use super::space::Space;
use super::tables::{BasisAt, FacetTable};
use super::weights::{FacetWeight, FacetWeights};
use super::{count, data, parallel};
use crate::algebra::SparseMatrix;
use crate::element::MAX_BASIS;
use crate::facet::AnyForm;
use crate::memory::in_large_pages;
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
    let mut row_starts = in_large_pages(Vec::with_capacity(n * n_cells + 1));
    row_starts.push(0_u32);
    let mut end = 0;
    for cell in 0..n_cells {
        let length = Coupled::of::<D>(neighbours, cell, lifted).n * n;
        for _ in 0..n {
            end += length as u32;
            row_starts.push(end);
        }
    }
    let mut columns = in_large_pages(vec![0_u32; end as usize]);
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
    let values = in_large_pages(vec![T::lit(0.0); end as usize]);
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
    /// If the gradient of basis function `i` is `c` times that of barycentric coordinate `i`: `c`.
    gradient: T,
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
    let gradient = space.gradient_factor();
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
        gradient: gradient.unwrap_or_else(|| T::lit(0.0)),
        lifted: form.is_lifted(),
    };
    let SparseMatrix { row_starts, values, .. } = matrix;
    match (D, space.per_cell(), gradient) {
        (1, 2, Some(_)) => filling.fill::<2, true>(row_starts, values),
        (2, 3, Some(_)) => filling.fill::<3, true>(row_starts, values),
        (3, 4, Some(_)) => filling.fill::<4, true>(row_starts, values),
        (1, 3, _) => filling.fill::<3, false>(row_starts, values),
        (2, 6, _) => filling.fill::<6, false>(row_starts, values),
        _ => filling.fill::<MAX_BASIS, false>(row_starts, values),
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

    /// The rows of all cells, for elements of `N` functions, or of fewer for the largest `N`.
    ///
    /// `LINEAR`: gradients of basis functions are those of barycentric coordinates times a factor.
    fn fill<const N: usize, const LINEAR: bool>(&self, row_starts: &[u32], values: &mut [T]) {
        let n = if N == MAX_BASIS { self.space.per_cell() } else { N };
        for_each_cell(row_starts, n, values, |cell, rows| {
            let coupled = Coupled::of::<D>(self.neighbours, cell, self.lifted);
            if self.lifted {
                rows.fill(T::lit(0.0));
            }
            let rows = Rows { n, length: rows.len() / n, entries: rows };
            self.write_cell::<N, LINEAR>(cell, &coupled, rows);
        });
    }

    /// Writes the rows of a cell: its stiffness and the form on its facets.
    #[inline(always)]
    fn write_cell<const N: usize, const LINEAR: bool>(
        &self,
        cell: usize,
        coupled: &Coupled,
        mut rows: Rows<'_, T>,
    ) {
        let metric = self.metrics.at(cell);
        let coefficient = self.space.alpha(cell);
        let mut own: Block<T, N> = if LINEAR {
            let scale = coefficient * self.gradient * self.gradient;
            block(|i, j| scale * metric.products[i][j])
        } else {
            block(|i, j| coefficient * self.stiffness.entry::<D>(&metric, i, j))
        };
        for local in 0..=D {
            let me = CellSide { cell, local, metric: &metric, coefficient };
            match self.neighbours.across(cell, local) {
                Neighbour::Cell { cell: other, local: other_local } => {
                    let there = (other as usize, other_local as usize);
                    let from_here = cell < there.0;
                    let here = if from_here { (cell, local) } else { there };
                    let weight = self.weights.at::<D>(here, from_here);
                    let mut across = self.add_jumps(&me, Some(there.1), &weight, &mut own);
                    self.add_fluxes::<N, LINEAR>(&me, Some(there), &weight, &mut own, &mut across);
                    rows.write(coupled.position(there.0), &across);
                }
                Neighbour::Boundary(BoundaryPart::Dirichlet) if !self.space.pins => {
                    let weight = self.weights.at::<D>((cell, local), true);
                    let mut none = self.add_jumps(&me, None, &weight, &mut own);
                    self.add_fluxes::<N, LINEAR>(&me, None, &weight, &mut own, &mut none);
                }
                Neighbour::Boundary(_) => {}
            }
        }
        rows.write(coupled.position(cell), &own);
    }

    /// Adds the products of jumps to the columns of the cell whose rows these are, and returns those
    /// in the columns of the cell across, which has the facet under the number `other`.
    #[inline(always)]
    fn add_jumps<const N: usize>(
        &self,
        me: &CellSide<'_, T, D>,
        other: Option<usize>,
        weight: &FacetWeight<T>,
        own: &mut Block<T, N>,
    ) -> Block<T, N> {
        count::facets(1);
        let form = &self.weights.coefficients;
        let mut across = [[T::lit(0.0); N]; N];
        for (class, &factor) in self.jumps.weights.iter().enumerate() {
            let scale = me.metric.measures[me.local] * form.jump_jump.at(weight.penalty * factor);
            let mine = &self.jumps.own(me.local)[class];
            add(own, |i, j| scale * mine[i][j]);
            if let Some(other) = other {
                let theirs = &self.jumps.across(me.local, other)[class];
                add(&mut across, |i, j| -scale * theirs[i][j]);
            }
        }
        across
    }

    /// Adds all products with fluxes to the columns of the cell whose rows these are and to those of
    /// the cell across.
    ///
    /// Jumps and fluxes both flip their sign with the direction of the normal, so their products do
    /// not: here normals point out of the cell whose rows these are.
    #[inline(always)]
    fn add_fluxes<const N: usize, const LINEAR: bool>(
        &self,
        me: &CellSide<'_, T, D>,
        other: Option<(usize, usize)>,
        weight: &FacetWeight<T>,
        own: &mut Block<T, N>,
        across: &mut Block<T, N>,
    ) {
        let form = &self.weights.coefficients;
        let measure = me.metric.measures[me.local];
        let of_mine = &me.metric.products[me.local];
        let of_theirs = other.map(|(cell, local)| self.metrics.products_of::<D>(cell, local));
        for (k, &class) in self.flux_moments.iter().enumerate() {
            let penalty = weight.penalty * class;
            let flux_flux = form.flux_flux.at(penalty) / measure;
            let (jump_flux, flux_jump) = (form.jump_flux.at(penalty), form.flux_jump.at(penalty));
            let mine = &self.facets.on(me.local)[k];
            let flux: [T; N] = self.flux::<N, LINEAR>(mine, of_mine, weight.own_share);
            let by_flux: [T; N] =
                std::array::from_fn(|i| jump_flux * mine.values[i] + flux_flux * flux[i]);
            let by_jump = flux.map(|flux| flux_jump * flux);
            add(own, |i, j| by_flux[i] * flux[j] + by_jump[i] * mine.values[j]);
            if let (Some((_, local)), Some(of_theirs)) = (other, &of_theirs) {
                let theirs = &self.facets.on(local)[k];
                let flux: [T; N] = self.flux::<N, LINEAR>(theirs, of_theirs, -weight.other_share);
                add(across, |i, j| by_flux[i] * flux[j] - by_jump[i] * theirs.values[j]);
            }
        }
    }

    /// The fluxes of the basis functions of a cell through one of its facets, of one moment: their
    /// derivatives along the outward normal times the measure of the facet and a factor.
    /// `products`: those of the gradient opposite the facet with all gradients.
    #[inline(always)]
    fn flux<const N: usize, const LINEAR: bool>(
        &self,
        basis: &BasisAt<T>,
        products: &[T; 4],
        factor: T,
    ) -> [T; N] {
        count::normal_derivatives(N);
        let scale = T::lit(-(D as f64)) * factor;
        if LINEAR {
            let scale = scale * self.gradient;
            return std::array::from_fn(|i| scale * products[i]);
        }
        std::array::from_fn(|i| {
            let sum = |sum, k: usize| sum + basis.derivatives[i][k] * products[k];
            scale * (1..=D).fold(basis.derivatives[i][0] * products[0], sum)
        })
    }
}

/// A dense block of the rows of a cell.
type Block<T, const N: usize> = [[T; N]; N];

#[inline(always)]
fn block<T, const N: usize>(entry: impl Fn(usize, usize) -> T) -> Block<T, N> {
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

#[inline(always)]
fn add<T: Real, const N: usize>(block: &mut Block<T, N>, entry: impl Fn(usize, usize) -> T) {
    for i in 0..N {
        for j in 0..N {
            block[i][j] += entry(i, j);
        }
    }
}

/// The `n` rows of a cell.
struct Rows<'r, T> {
    n: usize,
    /// Entries of each.
    length: usize,
    entries: &'r mut [T],
}

impl<T: Real> Rows<'_, T> {
    /// Writes the columns of the coupled cell at this place.
    #[inline(always)]
    fn write<const N: usize>(&mut self, place: usize, block: &Block<T, N>) {
        let n = self.n.min(N);
        for (row, from) in self.entries.chunks_exact_mut(self.length).zip(block) {
            row[place * n..(place + 1) * n].copy_from_slice(&from[..n]);
        }
    }
}
