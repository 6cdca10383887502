//! Exchange for quadratics: fluxes of degree one, multipliers linear in cells.
//!
//! In the notation of [`quadratics`](crate::error_bound::quadratics) the divergence at vertex `j` of a cell depends on
//! the `c_Fj` of that vertex and on the sum of all `c_FF`. A number added to `c_Fj` on one side of a facet and taken
//! from its counterpart on the other side changes the multipliers of the two cells at vertex `j` alone; a number
//! added to `c_AA` and taken from `c_BB` changes the multiplier of the cell at the vertices `A` and `B` alone.

use super::cells_of_quadratics::{CellOfQuadratics, CellsOfQuadratics};
use super::{ExchangeStep, FacetOfCell, ROUNDING};
use crate::arrays::{array_of, map_entries};
use crate::assemble::space::Space;
use crate::error_bound::PrimalDualPair;
use crate::error_bound::flux::{Flux, share_of_one_sign};
use crate::error_bound::quadratics::{CellLoads, vertices_of};
use crate::mesh::{HalfFacet, Mesh, Neighbours};
use crate::parallel::vectors::{collect, for_each_chunk, largest};

/// The visits of each facet.
const SWEEPS: usize = 8;

impl<const D: usize> CellsOfQuadratics<'_, D> {
    /// Moves the multiplier of a cell towards its mean until the multiplier has one sign. Numbers inside the cell keep
    /// the balance. The multiplier stays as it is if the mismatch would grow by more than the multiplier of the other sign
    /// counts for.
    fn make_sign_definite(&mut self, k: usize) {
        let cell = &self.cells[k];
        let mean = cell.sum() / (D + 1) as f64;
        let share = share_of_one_sign(mean, &cell.multiplier[..=D]);
        if share == 1.0 {
            self.cells[k].has_one_sign = true;
            return;
        }
        let squares: f64 = cell.multiplier[..=D].iter().map(|m| (m - mean).powi(2)).sum();
        let of_variation = (1.0 - share) * cell.variation * squares.sqrt();
        let limit = (self.mismatch(k).sqrt() + of_variation).powi(2);
        let changes = cell.multiplier.map(|m| (1.0 - share) * (m - mean) / cell.divergence);
        (0..D + 1).for_each(|j| self.add(k, Flux::<D>::place(j, j), j, changes[j]));
        if self.mismatch(k) > limit {
            (0..D + 1).for_each(|j| self.add(k, Flux::<D>::place(j, j), j, -changes[j]));
        } else {
            self.cells[k].has_one_sign = true;
        }
    }

    /// Visits a step.
    fn visit(&mut self, mesh: &Mesh<D>, step: ExchangeStep) {
        match step {
            ExchangeStep::Between(facets) => {
                let at = facets.map(FacetOfCell::half);
                let [cell, other] = at.map(|(k, _)| mesh.cell(self.cells[k].number));
                let position = |v: u32| other.iter().position(|&w| w == v);
                let common =
                    vertices_of::<D>(at[0].1).filter_map(|j| Some([j, position(cell[j])?]));
                common.for_each(|vertex| self.exchange_between(at, vertex));
            }
            ExchangeStep::WithDirichlet(facet) => {
                let at = facet.half();
                vertices_of::<D>(at.1).for_each(|j| self.exchange_with_dirichlet(at, j));
            }
            ExchangeStep::Inside(k) => {
                let pairs = (0..D + 1).flat_map(|a| (a + 1..=D).map(move |b| [a, b]));
                pairs.for_each(|pair| self.exchange_inside(k as usize, pair));
            }
        }
    }

    /// Exchanges multipliers of two cells at a vertex of their facet, by its numbers in the two cells.
    fn exchange_between(&mut self, at: [HalfFacet; 2], vertex: [usize; 2]) {
        let [here, there] = at.map(|(k, _)| &self.cells[k]);
        let sign = (here.sum() + there.sum()).signum();
        let obstacle = usize::from(sign < 0.0);
        let exchanges = |cell: &CellOfQuadratics| cell.has_one_sign && cell.is_given[obstacle];
        if here.sum() * there.sum() < 0.0 || !exchanges(here) || !exchanges(there) {
            return;
        }
        let numbers = map_entries([0, 1], |s| {
            let ((k, local), vertex) = (at[s], vertex[s]);
            (k, Flux::<D>::place(local, vertex), vertex)
        });
        self.exchange_numbers(numbers, sign);
    }

    /// Exchanges multipliers of a sign for flux: adds to one number of the flux what it takes from another. Each number
    /// is given by its cell, its place in the cell and the vertex at which the number changes the divergence.
    fn exchange_numbers(&mut self, numbers: [(usize, usize, usize); 2], sign: f64) {
        let [(here, one, a), (there, other, b)] = numbers;
        let [of_here, of_there] = [&self.cells[here], &self.cells[there]];
        let of_gaps = sign * (of_there.gap(sign, b) - of_here.gap(sign, a));
        let [slope, curvature] = self.slopes(&[(here, one, 1.0), (there, other, -1.0)], of_gaps);
        let least = -sign * slope / curvature;
        let exchange = sign * least.max(-of_there.room(sign, b)).min(of_here.room(sign, a));
        if exchange.is_finite() {
            self.add(here, one, a, exchange);
            self.add(there, other, b, -exchange);
        }
    }

    /// Exchanges the multiplier of a cell at a vertex of a Dirichlet facet.
    fn exchange_with_dirichlet(&mut self, (k, local): HalfFacet, vertex: usize) {
        let cell = &self.cells[k];
        let sign = cell.sum().signum();
        if !(cell.has_one_sign && cell.is_given[usize::from(sign < 0.0)]) {
            return;
        }
        let number = Flux::<D>::place(local, vertex);
        let of_gap = -sign * cell.gap(sign, vertex);
        let [slope, curvature] = self.slopes(&[(k, number, 1.0)], of_gap);
        let exchange = sign * (-sign * slope / curvature).min(cell.room(sign, vertex));
        if exchange.is_finite() {
            self.add(k, number, vertex, exchange);
        }
    }

    /// Exchanges the multiplier of a cell between two of its vertices.
    fn exchange_inside(&mut self, k: usize, [a, b]: [usize; 2]) {
        let cell = &self.cells[k];
        if !cell.has_one_sign {
            return;
        }
        let sign = cell.sum().signum();
        self.exchange_numbers(map_entries([a, b], |v| (k, Flux::<D>::place(v, v), v)), sign);
    }
}

impl<const D: usize> Space<'_, D> {
    /// Exchanges multipliers of quadratics for flux. `on_facets` are the parts of the multipliers that moved to facets. A
    /// multiplier that is rounding beside the largest one before that is not exchanged.
    pub(in crate::error_bound) fn exchange_quadratics(
        &self,
        pair: &mut PrimalDualPair<D>,
        (loads, on_facets): (&CellLoads, &[[f64; 4]]),
        neighbours: &Neighbours,
    ) {
        let mut multipliers = self.linear_multipliers(loads);
        let strength =
            |of_cell: &[f64; 4]| of_cell.iter().fold(0.0, |most: f64, m| most.max(m.abs()));
        let largest = largest(multipliers.len(), |cell| strength(&multipliers[cell]));
        for (cell, (multiplier, moved)) in multipliers.iter_mut().zip(on_facets).enumerate() {
            let volume = self.mesh.geometry(cell).volume;
            let moved = linear::<D>(&moved.map(|product| product / volume));
            multiplier.iter_mut().zip(moved).for_each(|(m, moved)| *m -= moved);
        }
        let presses = |cell: usize| strength(&multipliers[cell]) > ROUNDING * largest;
        let (numbers, steps) = self.cells_of_exchange(&presses, (neighbours, &|_| true), true);
        let multiplier = |cell: usize| if presses(cell) { multipliers[cell] } else { [0.0; 4] };
        let mut cells = self.cells_of_quadratics(&numbers, multiplier, pair);
        let products = self.products_of_fluxes(&numbers);
        for_each_chunk(&mut cells, |range, cells| {
            let mut cells = CellsOfQuadratics::<D>::new(cells, &products, range.start);
            (0..range.len()).for_each(|k| cells.make_sign_definite(k));
        });
        steps.visit(SWEEPS, &mut cells, |cells, first, step| {
            CellsOfQuadratics::new(cells, &products, first).visit(self.mesh, step);
        });
        pair.flux.replace_in(&numbers, |k| &cells[k].flux);
    }

    /// The multipliers of obstacles, projected on linear functions, at the vertices of cells.
    fn linear_multipliers(&self, loads: &CellLoads) -> Vec<[f64; 4]> {
        let n = self.per_cell();
        let of_cell = |cell: usize| {
            let volume = self.mesh.geometry(cell).volume;
            let (values, given) = (&loads.values[cell * n..], &loads.given[cell * n..]);
            let mut means = [0.0; 4];
            for (i, functional) in loads.functionals.iter().enumerate() {
                let multiplier = (values[i] - given[i]) / volume;
                for (mean, products) in means.iter_mut().zip(functional) {
                    *mean += multiplier * products.iter().sum::<f64>();
                }
            }
            linear::<D>(&means)
        };
        collect(self.mesh.n_cells(), of_cell)
    }
}

/// The linear function with these means of its products with barycentric coordinates, at the vertices of the cell.
fn linear<const D: usize>(means: &[f64; 4]) -> [f64; 4] {
    let (d, sum) = (D as f64, means[..=D].iter().sum::<f64>());
    let value = |k: usize| (d + 1.0) * ((d + 2.0) * means[k] - sum);
    array_of(|k| if k <= D { value(k) } else { 0.0 })
}
