//! The rows of one cell: its stiffness, and on each facet the products of moments.
//!
//! Sums are made a row of a block at a time, in registers, and each entry is written once; products of lifts are added
//! after that.

use super::rows_by_cell::for_each_cell;
use super::{Coupled, Filling};
use crate::assemble::facet_coefficients::FacetWeight;
use crate::assemble::space::metric::CellMetric;
use crate::assemble::space::tables::Derivatives;
use crate::element::MAX_BASIS;
use crate::facet::FacetKind;
use crate::mesh::{BoundaryCondition, HalfFacet, Neighbour};

/// A dense block of the rows of a cell, of which small elements use the upper left corner.
type Block<const N: usize> = [[f64; N]; N];

/// Moments on a facet, of `N` functions each.
type Moments<const N: usize, const M: usize> = [[f64; N]; M];

/// The `n` rows of a cell.
struct Rows<'r> {
    n: usize,
    /// Entries of each.
    length: usize,
    entries: &'r mut [f64],
    /// The place among the coupled cells of the other cell of each facet, and of the cell itself.
    others: [usize; 4],
    own: usize,
}

impl<'r> Rows<'r> {
    #[inline(always)]
    fn new(n: usize, entries: &'r mut [f64], (others, own): ([usize; 4], usize)) -> Self {
        Self { n, length: entries.len() / n, entries, others, own }
    }
    /// Writes row `i` of the block of the coupled cell at a place, as much of it as there is.
    #[inline(always)]
    fn write<const N: usize>(&mut self, place: usize, i: usize, row: &[f64; N]) {
        if self.n == N {
            let start = i * self.length + place * N;
            self.entries[start..start + N].copy_from_slice(row);
        } else if i < self.n {
            let start = i * self.length + place * self.n;
            self.entries[start..start + self.n].copy_from_slice(&row[..self.n]);
        }
    }
}

/// The cell whose rows are made, seen from one of its facets.
#[derive(Clone, Copy)]
struct Own<'f, const D: usize> {
    cell: usize,
    local: usize,
    metric: &'f CellMetric<D>,
}

/// One facet of a cell, as it enters the rows of that cell: normals point out of it.
///
/// Jumps and fluxes both flip their sign with the direction of the normal, so their products do not.
struct OnFacet<'f, const D: usize, const N: usize, const M: usize> {
    own: Own<'f, D>,
    weight: FacetWeight<'f>,
    /// The factor of the products of jumps of the first class.
    jump_jump: f64,
    /// By moment what multiplies fluxes of trial functions, for each test function.
    by_flux: Moments<N, M>,
    /// By moment what multiplies jumps of trial functions besides, for each test function.
    by_jump: Moments<N, M>,
}

impl<const D: usize> Filling<'_, '_, D> {
    /// The rows of all cells, for elements of `N` functions, or of fewer for the largest `N`, with at
    /// most `M` moments of fluxes on a facet.
    pub(crate) fn fill<const N: usize, const M: usize>(
        &self,
        row_starts: &[u32],
        values: &mut [f64],
    ) {
        let n = if N == MAX_BASIS { self.space.per_cell() } else { N };
        for_each_cell(row_starts, n, values, |cell, entries| {
            if self.lifted {
                entries.fill(0.0);
            }
            let rows = Rows::new(n, entries, self.positions(cell));
            self.write_cell::<N, M>(cell, rows);
        });
    }

    /// The positions of the other cells of all facets among the coupled cells, and that of the cell
    /// itself.
    #[inline(always)]
    fn positions(&self, cell: usize) -> ([usize; 4], usize) {
        let other = |local| match self.neighbours.across(cell, local) {
            Neighbour::Cell { cell, .. } => cell,
            Neighbour::Boundary(_) | Neighbour::Cut => u32::MAX,
        };
        let mut cells = [u32::MAX; 4];
        for local in 0..=D {
            cells[local] = other(local);
        }
        if self.lifted {
            let coupled = Coupled::of::<D>(self.neighbours, cell, true);
            // behind a facet of the boundary is no cell, and its entry is not read
            let others = cells.map(|other| match other {
                u32::MAX => usize::MAX,
                other => coupled.position(other as usize),
            });
            return (others, coupled.position(cell));
        }
        // ranks by comparison of all pairs, without branches
        let own = cell as u32;
        let below = |than: u32| {
            (0..D + 1).fold(usize::from(own < than), |n, k| n + usize::from(cells[k] < than))
        };
        (cells.map(below), below(own))
    }

    /// Writes the rows of a cell: its stiffness and the form on its facets.
    #[inline(always)]
    fn write_cell<const N: usize, const M: usize>(&self, cell: usize, mut rows: Rows<'_>) {
        let metric = self.metrics.at(cell);
        let mut block_of_own: Block<N> =
            self.space.stiffness(&self.stiffness, cell, &metric.products);
        self.space.add_reaction(cell, metric.volume, &mut block_of_own);
        for local in 0..=D {
            let own = Own { cell, local, metric: &metric };
            match self.neighbours.across(cell, local) {
                Neighbour::Cell { cell: other, local: other_local } => {
                    let other = (other as usize, other_local as usize);
                    let from_here = cell < other.0;
                    let here = if from_here { (cell, local) } else { other };
                    let weight = self.weights.at::<D>(here, from_here, FacetKind::Interior);
                    let facet = self.add_facet::<N, M>(own, Some(other), weight, &mut block_of_own);
                    self.write_other::<N, M>(&facet, other, &mut rows);
                }
                Neighbour::Boundary(BoundaryCondition::Dirichlet) if !self.space.pins => {
                    let weight = self.weights.at::<D>((cell, local), true, FacetKind::Dirichlet);
                    self.add_facet::<N, M>(own, None, weight, &mut block_of_own);
                }
                Neighbour::Boundary(_) | Neighbour::Cut => {}
            }
        }
        for (i, row) in block_of_own.iter().enumerate() {
            rows.write(rows.own, i, row);
        }
    }

    /// Adds what the form makes of a facet to the columns of the cell whose rows these are.
    #[inline(always)]
    fn add_facet<'f, const N: usize, const M: usize>(
        &'f self,
        own: Own<'f, D>,
        other: Option<HalfFacet>,
        weight: FacetWeight<'f>,
        block_of_own: &mut Block<N>,
    ) -> OnFacet<'f, D, N, M> {
        let form = weight.coefficients;
        let measure = own.metric.measures[own.local];
        let jump_jump = self.jump_scale(&own, &weight, self.jumps.weights[0]);
        let zero = [[0.0; N]; M];
        let mut facet = OnFacet { own, weight, jump_jump, by_flux: zero, by_jump: zero };
        let mut flux = zero;
        let moments = self.facets.on(own.local);
        for k in 0..self.n_fluxes::<M>() {
            let penalty = weight.penalty * self.flux_moments[k];
            let flux_flux = form.flux_flux.at(penalty) / measure;
            let (jump_flux, flux_jump) = (form.jump_flux.at(penalty), form.flux_jump.at(penalty));
            let basis = &moments[k];
            let products = &own.metric.products[own.local];
            let own_weight = weight.own_flux_weight;
            flux[k] = match self.space.flux_derivatives((own.cell, own.local), other, own_weight, k)
            {
                None => self.flux::<N>(&basis.derivatives, products, own_weight),
                Some(weighted) => self.flux::<N>(&weighted, products, 1.0),
            };
            facet.by_flux[k] =
                std::array::from_fn(|i| jump_flux * basis.values[i] + flux_flux * flux[k][i]);
            facet.by_jump[k] = flux[k].map(|flux| flux_jump * flux);
        }
        let products = self.jumps.own(own.local);
        for i in 0..N {
            let mut row: [f64; N] = std::array::from_fn(|j| jump_jump * products[0][i][j]);
            for class in 1..products.len() {
                let scale = self.jump_scale(&own, &weight, self.jumps.weights[class]);
                for j in 0..N {
                    row[j] += scale * products[class][i][j];
                }
            }
            for k in 0..self.n_fluxes::<M>() {
                let (by_flux, by_jump) = (facet.by_flux[k][i], facet.by_jump[k][i]);
                let values = &moments[k].values;
                for j in 0..N {
                    row[j] += by_flux * flux[k][j] + by_jump * values[j];
                }
            }
            for j in 0..N {
                block_of_own[i][j] += row[j];
            }
        }
        facet
    }

    /// Writes what the form makes of a facet to the columns of the other cell, which has the facet
    /// under another number.
    #[inline(always)]
    fn write_other<const N: usize, const M: usize>(
        &self,
        facet: &OnFacet<'_, D, N, M>,
        other: HalfFacet,
        rows: &mut Rows<'_>,
    ) {
        let Own { cell, local, .. } = facet.own;
        let mut flux = [[0.0; N]; M];
        let moments = self.facets.on(other.1);
        if self.n_fluxes::<M>() > 0 {
            let products = self.metrics.products_of::<D>(other.0, other.1);
            for k in 0..self.n_fluxes::<M>() {
                let weight = facet.weight.other_flux_weight;
                let weighted = self.space.flux_derivatives(other, Some((cell, local)), weight, k);
                flux[k] = match weighted {
                    None => self.flux::<N>(&moments[k].derivatives, &products, -weight),
                    Some(weighted) => self.flux::<N>(&weighted, &products, -1.0),
                };
            }
        }
        let products = self.jumps.other(local, other.1);
        for i in 0..N {
            let mut row: [f64; N] = std::array::from_fn(|j| -facet.jump_jump * products[0][i][j]);
            for class in 1..products.len() {
                let scale = self.jump_scale(&facet.own, &facet.weight, self.jumps.weights[class]);
                for j in 0..N {
                    row[j] -= scale * products[class][i][j];
                }
            }
            for k in 0..self.n_fluxes::<M>() {
                let (by_flux, by_jump) = (facet.by_flux[k][i], facet.by_jump[k][i]);
                let values = &moments[k].values;
                for j in 0..N {
                    row[j] += by_flux * flux[k][j] - by_jump * values[j];
                }
            }
            rows.write(rows.others[local], i, &row);
        }
    }

    /// How many moments have a flux.
    #[inline(always)]
    fn n_fluxes<const M: usize>(&self) -> usize {
        self.flux_moments.len().min(M)
    }

    /// The factor of the products of jumps of a class.
    #[inline(always)]
    fn jump_scale(&self, own: &Own<'_, D>, weight: &FacetWeight<'_>, class: f64) -> f64 {
        own.metric.measures[own.local] * weight.coefficients.jump_jump.at(weight.penalty * class)
    }

    /// The fluxes of the basis functions of a cell through one of its facets, of one moment: their
    /// derivatives along the outward normal times the measure of the facet and a factor.
    /// `products`: those of the gradient opposite the facet with all gradients.
    #[inline(always)]
    fn flux<const N: usize>(
        &self,
        derivatives: &Derivatives,
        products: &[f64; 4],
        factor: f64,
    ) -> [f64; N] {
        let scale = (-(D as f64)) * factor;
        std::array::from_fn(|i| {
            let sum = |sum, k: usize| sum + derivatives[i][k] * products[k];
            scale * (1..=D).fold(derivatives[i][0] * products[0], sum)
        })
    }
}
