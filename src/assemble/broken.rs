//! Rows of broken spaces: each cell writes its own, once, in place.
//!
//! The rows of a cell consist of dense blocks, one for the cell and one for each cell coupled to
//! it, in ascending order of cells. A facet's form is evaluated from each of its two sides for the
//! rows of that side, so no local matrix is ever stored and no two cells write to the same place.
//!
//! A form is bilinear in moments, so on each facet it comes down to a few numbers: the products of
//! jumps are those of the reference cell, and fluxes of one moment make a matrix of rank one.

use std::convert::Infallible;

use super::lifted::{self, LiftTable};
use super::local::{CellSide, StiffnessTable, flux_share, view, zero_local};
use super::metric::Metrics;
use super::products::JumpProducts;
use super::space::Space;
use super::tables::FacetTable;
use super::{count, data, parallel};
use crate::algebra::SparseMatrix;
use crate::element::{MAX_BASIS, ReferenceElement};
use crate::facet::{FacetForm, FacetView, Trace};
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
                found.insert(other);
                if lifted {
                    found.insert_neighbours::<D>(neighbours, other as usize);
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
    fn insert_neighbours<const D: usize>(&mut self, neighbours: &Neighbours, cell: usize) {
        for local in 0..=D {
            if let Neighbour::Cell { cell: other, .. } = neighbours.across(cell, local)
                && !self.cells[..self.n].contains(&other)
            {
                self.insert(other);
            }
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
struct Filling<'s, 'a, T: Real, const D: usize, F> {
    space: &'s Space<'a, T, D>,
    form: &'s F,
    metrics: Metrics<T>,
    stiffness: StiffnessTable<T>,
    facets: FacetTable<T>,
    jumps: JumpProducts<T>,
    /// How many moments have fluxes.
    flux_moments: usize,
}

/// The values, on a known pattern.
pub(super) fn fill<T: Real, const D: usize, E: ReferenceElement<T, D>, F: FacetForm<T, D>>(
    space: &Space<'_, T, D>,
    form: &F,
    matrix: &mut SparseMatrix<T>,
) {
    let neighbours = space.coupled_neighbours();
    let facets = FacetTable::new::<E, D>(F::moments(E::DEGREE));
    let filling = Filling {
        space,
        form,
        metrics: Metrics::of(space.mesh),
        stiffness: StiffnessTable::new::<E, D>(),
        jumps: JumpProducts::new::<D>(&facets, |degree| form.moment_weight(degree)),
        flux_moments: facets.degrees.iter().filter(|&&k| k < E::DEGREE).count(),
        facets,
    };
    let lifts = F::LIFTED.then(|| LiftTable::new::<E, D>());
    let reaction = data::ReactionTerm::new::<E>(space);
    let SparseMatrix { row_starts, values, .. } = matrix;
    for_each_cell(row_starts, E::N, values, |cell, rows| {
        let coupled = Coupled::of::<D>(neighbours, cell, F::LIFTED);
        filling.write_cell::<E>(neighbours, cell, &coupled, rows);
        if let Some(table) = &lifts {
            let lifting = lifted::Lifting { space, form, metrics: &filling.metrics, table };
            lifting.add::<E>(neighbours, cell, &coupled, rows);
        }
        if let Some(reaction) = &reaction {
            let mut own = zero_local();
            reaction.add::<E>(space.mesh, cell, filling.metrics.at::<D>(cell).volume, &mut own);
            let block = coupled.position(cell);
            for (row, values) in rows.chunks_exact_mut(coupled.n * E::N).zip(&own) {
                for (entry, value) in row[block * E::N..].iter_mut().zip(&values[..E::N]) {
                    *entry += *value;
                }
            }
        }
    });
}

impl<T: Real, const D: usize, F: FacetForm<T, D>> Filling<'_, '_, T, D, F> {
    /// Writes the rows of a cell: its stiffness and the form on its facets.
    #[inline(always)]
    fn write_cell<E: ReferenceElement<T, D>>(
        &self,
        neighbours: &Neighbours,
        cell: usize,
        coupled: &Coupled,
        rows: &mut [T],
    ) {
        let row = coupled.n * E::N;
        if F::LIFTED {
            rows.fill(T::lit(0.0));
        }
        let metric = self.metrics.at(cell);
        let coefficient = self.space.alpha(cell);
        let own = coupled.position(cell) * E::N;
        for i in 0..E::N {
            let out = &mut rows[i * row + own..i * row + own + E::N];
            for j in 0..E::N {
                out[j] = coefficient * self.stiffness.entry::<D>(&metric, i, j);
            }
        }
        for local in 0..=D {
            let me = CellSide { cell, local, metric: &metric, coefficient };
            match neighbours.across(cell, local) {
                Neighbour::Cell { cell: other, local: other_local } => {
                    let cell = other as usize;
                    let metric = self.metrics.at(cell);
                    let local = other_local as usize;
                    let coefficient = self.space.alpha(cell);
                    let other = CellSide { cell, local, metric: &metric, coefficient };
                    let across = coupled.position(cell) * E::N;
                    self.add_facet::<E>(&me, Some((&other, across)), own, row, rows);
                }
                Neighbour::Boundary(BoundaryPart::Dirichlet) if !self.space.pins => {
                    self.add_facet::<E>(&me, None, own, row, rows);
                }
                Neighbour::Boundary(_) => {}
            }
        }
    }

    /// Adds the form on a facet to the rows of one of its cells: to the columns of this cell, which
    /// start at `own`, and to those of the other, which start at the number beside it.
    #[inline(always)]
    fn add_facet<E: ReferenceElement<T, D>>(
        &self,
        me: &CellSide<'_, T, D>,
        other: Option<(&CellSide<'_, T, D>, usize)>,
        own: usize,
        row: usize,
        rows: &mut [T],
    ) {
        count::facets(1);
        let is_here = other.is_none_or(|(other, _)| me.cell < other.cell);
        let facet = match other {
            Some((other, _)) if is_here => view(self.space.mesh, me, Some(other)),
            Some((other, _)) => view(self.space.mesh, other, Some(me)),
            None => view(self.space.mesh, me, None),
        };
        let penalty = self.form.penalty(&facet);
        let products = self.jumps.own(me.local);
        for (class, &weight) in self.jumps.weights.iter().enumerate() {
            let scale = facet.measure * self.jump_jump(penalty * weight);
            add_scaled::<T>(E::N, scale, &products[class], own, row, rows);
        }
        if let Some((other, across)) = other {
            let products = self.jumps.across(me.local, other.local);
            for (class, &weight) in self.jumps.weights.iter().enumerate() {
                let scale = -facet.measure * self.jump_jump(penalty * weight);
                if class == 0 && !F::LIFTED {
                    write_scaled::<T>(E::N, scale, &products[class], across, row, rows);
                } else {
                    add_scaled::<T>(E::N, scale, &products[class], across, row, rows);
                }
            }
        }
        if F::USES_FLUX {
            self.add_fluxes::<E>(&facet, is_here, penalty, me, other, own, row, rows);
        }
    }

    /// Adds the products of jumps with fluxes and of fluxes with each other.
    ///
    /// Both flip their sign with the direction of the normal, so their products do not: here all
    /// normals point out of this cell.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "the pieces of one facet, passed in registers")]
    fn add_fluxes<E: ReferenceElement<T, D>>(
        &self,
        facet: &FacetView<T, D>,
        is_here: bool,
        penalty: T,
        me: &CellSide<'_, T, D>,
        other: Option<(&CellSide<'_, T, D>, usize)>,
        own: usize,
        row: usize,
        rows: &mut [T],
    ) {
        let share = flux_share(self.form, facet, is_here);
        for moment in 0..self.flux_moments {
            let weight = T::lit(self.form.moment_weight(self.facets.degrees[moment]));
            let (jump_flux, flux_jump, flux_flux) = self.with_flux(penalty * weight);
            let flux_flux = flux_flux / facet.measure;
            let mine = &self.facets.on(me.local)[moment];
            let flux = me.normal_derivatives::<E>(mine).map(|d| share * d);
            for i in 0..E::N {
                let (jump, slope) = (mine.values[i], flux[i]);
                let (a, b) = (jump_flux * jump + flux_flux * slope, flux_jump * slope);
                let out = &mut rows[i * row + own..i * row + own + E::N];
                for j in 0..E::N {
                    out[j] += a * flux[j] + b * mine.values[j];
                }
            }
            if let Some((other, across)) = other {
                let theirs = &self.facets.on(other.local)[moment];
                let other_share = flux_share(self.form, facet, !is_here);
                // their outward normal is the opposite of mine
                let other_flux = other.normal_derivatives::<E>(theirs).map(|d| -other_share * d);
                for i in 0..E::N {
                    let (jump, slope) = (mine.values[i], flux[i]);
                    let (a, b) = (jump_flux * jump + flux_flux * slope, flux_jump * slope);
                    let out = &mut rows[i * row + across..i * row + across + E::N];
                    for j in 0..E::N {
                        out[j] += a * other_flux[j] - b * theirs.values[j];
                    }
                }
            }
        }
    }

    /// The form's coefficient of `[v][u]`.
    #[inline(always)]
    fn jump_jump(&self, penalty: T) -> T {
        let flux = T::lit(if F::USES_FLUX { 0.0 } else { f64::NAN });
        let jump = Trace { jump: T::lit(1.0), flux };
        self.form.integrand(jump, jump, penalty)
    }
    /// The form's coefficients of `[v] flux(u)`, `flux(v) [u]` and `flux(v) flux(u)`.
    #[inline(always)]
    fn with_flux(&self, penalty: T) -> (T, T, T) {
        let jump = Trace { jump: T::lit(1.0), flux: T::lit(0.0) };
        let flux = Trace { jump: T::lit(0.0), flux: T::lit(1.0) };
        let at = |v, u| self.form.integrand(v, u, penalty);
        (at(jump, flux), at(flux, jump), at(flux, flux))
    }
}

#[inline(always)]
fn add_scaled<T: Real>(
    n: usize,
    scale: T,
    products: &[[T; MAX_BASIS]; MAX_BASIS],
    start: usize,
    row: usize,
    rows: &mut [T],
) {
    for i in 0..n {
        let out = &mut rows[i * row + start..i * row + start + n];
        for j in 0..n {
            out[j] += scale * products[i][j];
        }
    }
}

#[inline(always)]
fn write_scaled<T: Real>(
    n: usize,
    scale: T,
    products: &[[T; MAX_BASIS]; MAX_BASIS],
    start: usize,
    row: usize,
    rows: &mut [T],
) {
    for i in 0..n {
        let out = &mut rows[i * row + start..i * row + start + n];
        for j in 0..n {
            out[j] = scale * products[i][j];
        }
    }
}
