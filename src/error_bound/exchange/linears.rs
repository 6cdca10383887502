//! Exchange for linears: one flux of each facet, one multiplier of each cell.

use super::{ExchangeStep, FacetOfCell, ROUNDING, decrease, visit_steps};
use crate::algebra::Contact;
use crate::assemble::cut_simplices::in_space;
use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;
use crate::error_bound::PrimalDualPair;
use crate::error_bound::contact_forces::NodeForce;
use crate::error_bound::flux::Flux;
use crate::measure::Counts;
use crate::mesh::{BoundaryCondition, HalfFacet, Neighbours};
use crate::parallel::vectors::{collect, indices};
use crate::quadrature::Rule;
use crate::real::Point;

/// Most visits of each facet. The matrix of the least-squares problem is the mass matrix of fluxes, whose condition
/// does not grow with the number of cells.
const SWEEPS: usize = 4;

/// The degree of the rule for distances from obstacles that are no constants.
const DEGREE: usize = 2;

/// The data of a cell that the exchange needs.
struct CellOfLinears<const D: usize> {
    /// The number of the cell.
    number: usize,
    /// The values at the centre of the fluxes that leave through one facet each.
    at_centre: [Point<D>; 4],
    /// The mean of the square of such a flux less its value at the centre.
    variance: f64,
    /// The volume over the coefficient.
    weight: f64,
    /// The flux at the centre less the gradient of the function times the coefficient.
    difference: Point<D>,
    /// The sum of the fluxes through the facets.
    sum: f64,
    /// The mean distances of the function from the lower and the upper obstacle; if they are given.
    gaps: [Option<f64>; 2],
    /// The integral of the multiplier.
    multiplier: f64,
}

impl<const D: usize> CellOfLinears<D> {
    /// Half of the derivative of the square of the mismatch by the flux through a facet, and half of the second
    /// derivative.
    fn slopes(&self, facet: usize) -> [f64; 2] {
        let flux = &self.at_centre[facet];
        [
            self.weight * (flux.dot(&self.difference) + self.variance * self.sum),
            self.weight * (flux.norm_squared() + self.variance),
        ]
    }

    /// The contribution of the cell to the square of the bound.
    fn square(&self) -> f64 {
        let mismatch = self.difference.norm_squared() + self.variance * self.sum * self.sum;
        let gap = self.gap(self.multiplier.signum()).unwrap_or(0.0);
        self.weight * mismatch + 2.0 * self.multiplier.abs() * gap
    }

    /// The mean distance from the obstacle that presses with this sign.
    fn gap(&self, sign: f64) -> Option<f64> {
        self.gaps[usize::from(sign < 0.0)]
    }

    /// Adds to the flux through a facet what the multiplier gives.
    fn add(&mut self, facet: usize, exchange: f64, flux: &mut Flux<D>) {
        flux.add_through(self.number, facet, exchange);
        self.difference += self.at_centre[facet] * exchange;
        self.sum += exchange;
        self.multiplier -= exchange;
    }
}

impl<const D: usize> Space<'_, D> {
    /// The integrals of multipliers of obstacles over cells: of a shared unknown each cell has the share that its
    /// flux balances, by volume around a vertex and half on the two sides of a facet, if the cell's obstacle gives the
    /// active bound. The multipliers of inactive
    /// unknowns are set to zero: the residual of an inactive unknown is an algebraic error.
    pub(in crate::error_bound) fn multipliers_by_cell(
        &self,
        (residual, obstacles): (&[f64], &ActiveObstacles),
        contact: &[Contact],
        forces: &[NodeForce],
    ) -> Vec<f64> {
        let n = self.per_cell();
        let mut multipliers = self.multipliers_of_obstacles(residual, forces);
        let states = multipliers.iter_mut().zip(contact);
        states.filter(|(_, state)| **state == Contact::Inactive).for_each(|(m, _)| *m = 0.0);
        if self.broken {
            return multipliers.chunks_exact(n).map(|m| m.iter().sum()).collect();
        }
        for (cell, local) in self.facets_of(BoundaryCondition::Dirichlet) {
            self.nodes_on(local).for_each(|i| multipliers[self.dofs.of(cell, i)] = 0.0);
        }
        let largest = multipliers.iter().fold(0.0, |largest: f64, m| largest.max(m.abs()));
        let is_rounding = |m: &&mut f64| m.abs() <= ROUNDING * largest;
        multipliers.iter_mut().filter(is_rounding).for_each(|m| *m = 0.0);
        let by_volume = self.is_conforming_linear();
        let n_cells = self.mesh.n_cells();
        let weight = |cell: usize| if by_volume { self.mesh.geometry(cell).volume } else { 1.0 };
        let mut weights = vec![0.0; multipliers.len()];
        let pressing = |cell: usize| {
            let acting = (0..n).filter(move |&i| obstacles.act_in(cell, i));
            acting.map(move |i| self.dofs.of(cell, i)).filter(|&i| multipliers[i] != 0.0)
        };
        let mut of_cells = vec![0.0; n_cells];
        let with_share = indices(n_cells, |cell| pressing(cell).next().is_some());
        let with_share = || with_share.iter().map(|&cell| cell as usize);
        for cell in with_share() {
            of_cells[cell] = weight(cell);
            pressing(cell).for_each(|i| weights[i] += of_cells[cell]);
        }
        for cell in with_share() {
            of_cells[cell] *= pressing(cell).map(|i| multipliers[i] / weights[i]).sum::<f64>();
        }
        of_cells
    }

    /// Exchanges multipliers for flux of linears, in and between the cells that count.
    pub(in crate::error_bound) fn exchange_linears(
        &self,
        function: &PrimalDualPair<D>,
        multipliers: &[f64],
        (neighbours, counts): (&Neighbours, Counts<'_>),
        flux: &mut Flux<D>,
    ) {
        let largest = multipliers.iter().fold(0.0, |largest: f64, m| largest.max(m.abs()));
        let presses = |cell: usize| counts(cell) && multipliers[cell].abs() > ROUNDING * largest;
        let (numbers, steps) = self.cells_of_exchange(&presses, (neighbours, counts), false);
        let rule = Rule::new(D, DEGREE);
        let before = &*flux;
        let mut cells = collect(numbers.len(), |k| {
            let number = numbers[k];
            let multiplier = if presses(number) { multipliers[number] } else { 0.0 };
            let mut cell = self.cell_of_linears(number, function, multiplier, &rule);
            for (flux, at_centre) in before.of_cell(number).iter().zip(&cell.at_centre) {
                cell.difference += at_centre * *flux;
                cell.sum += flux;
            }
            cell
        });
        let square: f64 = cells.iter().map(CellOfLinears::square).sum();
        visit_steps(&steps, (cells.len(), square), SWEEPS, |step| match step {
            ExchangeStep::Between(at) => {
                exchange_between(&mut cells, at.map(FacetOfCell::half), flux)
            }
            ExchangeStep::WithDirichlet(facet) => {
                let (k, local) = facet.half();
                exchange_with_dirichlet(&mut cells[k], local, flux)
            }
            ExchangeStep::Inside(_) => 0.0,
        });
    }

    fn cell_of_linears(
        &self,
        number: usize,
        function: &PrimalDualPair<D>,
        multiplier: f64,
        rule: &Rule,
    ) -> CellOfLinears<D> {
        let volume = self.mesh.geometry(number).volume;
        let alpha = self.alpha(number);
        let admissible = self.admissible_in(function, number);
        let corners = self.mesh.corners(number);
        let centre: Point<D> = corners[..=D].iter().map(|x| x / (D + 1) as f64).sum();
        let squares: f64 = corners[..=D].iter().map(|x| (centre - x).norm_squared()).sum();
        let per_volume = 1.0 / (D as f64 * volume);
        let mut at_centre = [Point::zeros(); 4];
        (0..D + 1).for_each(|k| at_centre[k] = (centre - corners[k]) * per_volume);
        let gap = |k: usize| {
            let bound = admissible.bounds[k]?;
            let distance = |value: f64, x: &Point<D>| {
                ([1.0, -1.0][k] * (value - self.at(bound, number, x))).max(0.0)
            };
            if bound.constant().is_some() {
                let at_corners = (0..D + 1).map(|k| distance(admissible.values[k], &corners[k]));
                return Some(at_corners.sum::<f64>() / (D + 1) as f64);
            }
            let at_point = |point: &[f64; 4]| {
                let value = admissible.values.iter().zip(point).map(|(v, b)| v * b).sum();
                distance(value, &in_space(point, &corners))
            };
            Some(rule.iter().map(|(point, weight)| weight * at_point(point)).sum())
        };
        CellOfLinears {
            number,
            at_centre,
            variance: squares * per_volume * per_volume / ((D + 1) * (D + 2)) as f64,
            weight: volume / alpha,
            difference: -admissible.gradient * alpha,
            sum: 0.0,
            gaps: [gap(0), gap(1)],
            multiplier,
        }
    }
}

/// Exchanges the multipliers of two cells for the flux through their facet. The result is by how much the square of the
/// bound falls.
fn exchange_between<const D: usize>(
    cells: &mut [CellOfLinears<D>],
    [(here, facet_here), (there, facet_there)]: [HalfFacet; 2],
    flux: &mut Flux<D>,
) -> f64 {
    let [of_here, of_there] = [&cells[here], &cells[there]];
    let sign = (of_here.multiplier + of_there.multiplier).signum();
    let gaps = of_here.gap(sign).zip(of_there.gap(sign));
    let gaps = gaps.filter(|_| of_here.multiplier * of_there.multiplier >= 0.0);
    let Some((gap_here, gap_there)) = gaps else { return 0.0 };
    let [slope, curvature] = of_here.slopes(facet_here);
    let [slope_there, curvature_there] = of_there.slopes(facet_there);
    let slope = slope - slope_there + sign * (gap_there - gap_here);
    let curvature = curvature + curvature_there;
    let (a, b) = (-of_there.multiplier, of_here.multiplier);
    let exchange = (-slope / curvature).max(a.min(b)).min(a.max(b));
    if !exchange.is_finite() {
        return 0.0;
    }
    cells[here].add(facet_here, exchange, flux);
    cells[there].add(facet_there, -exchange, flux);
    decrease([slope, curvature], exchange)
}

/// Exchanges the multiplier of a cell for the flux through a Dirichlet facet. The result is by how much the square of
/// the bound falls.
fn exchange_with_dirichlet<const D: usize>(
    cell: &mut CellOfLinears<D>,
    local: usize,
    flux: &mut Flux<D>,
) -> f64 {
    let sign = cell.multiplier.signum();
    let Some(gap) = cell.gap(sign) else { return 0.0 };
    let [slope, curvature] = cell.slopes(local);
    let slope = slope - sign * gap;
    let exchange = sign * (-sign * slope / curvature).min(sign * cell.multiplier);
    if !exchange.is_finite() {
        return 0.0;
    }
    cell.add(local, exchange, flux);
    decrease([slope, curvature], exchange)
}
