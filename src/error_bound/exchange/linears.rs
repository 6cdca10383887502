//! Exchange for linears: one flux of each facet, one multiplier of each cell.

use std::convert::Infallible;

use super::{ExchangeStep, FacetOfCell, ROUNDING};
use crate::algebra::Contact;
use crate::arrays::array_of;
use crate::assemble::cut_simplices::in_space;
use crate::assemble::shared_rows::places::for_each_place;
use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;
use crate::error_bound::PrimalDualPair;
use crate::error_bound::contact_forces::NodeForce;
use crate::measure::Counts;
use crate::mesh::{BoundaryCondition, HalfFacet, Neighbours};
use crate::parallel::vectors::{collect, for_each_chunk, for_each_chunk_of_groups, largest, zeros};
use crate::quadrature::Rule;
use crate::real::Point;

/// The visits of each facet.
const SWEEPS: usize = 4;

/// The degree of the rule for distances from obstacles that are no constants.
const DEGREE: usize = 2;

/// The data of a cell that the exchange needs.
struct CellOfLinears<const D: usize> {
    /// The flux through each facet.
    flux: [f64; 4],
    /// The values at the centre of the fluxes that leave through one facet, with the integral one there.
    at_centre: [Point<D>; 4],
    /// The mean square of the flux through one facet, with the integral one there, less its value at the centre.
    variance: f64,
    /// The volume over the coefficient.
    weight: f64,
    /// The flux at the centre less the gradient of the function times the coefficient.
    difference: Point<D>,
    /// The mean distances of the function from the lower and the upper obstacle; infinite where none is given. A distance
    /// that is not finite exchanges nothing.
    gaps: [f64; 2],
    /// The integral of the multiplier.
    multiplier: f64,
}

impl<const D: usize> CellOfLinears<D> {
    /// Half of the derivative of the square of the mismatch by the flux through a facet, and half of the second derivative.
    fn slopes(&self, facet: usize) -> [f64; 2] {
        let at_centre = &self.at_centre[facet];
        [
            self.weight * (at_centre.dot(&self.difference) + self.variance * self.sum()),
            self.weight * (at_centre.norm_squared() + self.variance),
        ]
    }

    /// The sum of the fluxes through the facets.
    fn sum(&self) -> f64 {
        self.flux.iter().sum()
    }

    /// The mean distance from the obstacle that presses with this sign.
    fn gap(&self, sign: f64) -> Option<f64> {
        Some(self.gaps[usize::from(sign < 0.0)]).filter(|gap| gap.is_finite())
    }

    /// Adds to the flux through a facet what the multiplier gives.
    fn add(&mut self, facet: usize, exchange: f64) {
        self.flux[facet] += exchange;
        self.difference += self.at_centre[facet] * exchange;
        self.multiplier -= exchange;
    }
}

impl<const D: usize> Space<'_, D> {
    /// The multipliers of obstacles by cell and unknown of the cell: of a shared unknown each cell has the share that its
    /// flux balances, by volume around a vertex and half on the two sides of a facet, if the cell's obstacle gives the
    /// active bound. The multipliers of inactive unknowns are set to zero: the residual of an inactive unknown is an
    /// algebraic error.
    pub(in crate::error_bound) fn multipliers_by_cell(
        &self,
        (residual, obstacles): (&[f64], &ActiveObstacles),
        contact: &[Contact],
        forces: &[NodeForce],
    ) -> Vec<f64> {
        let (n, n_cells) = (self.per_cell(), self.mesh.n_cells());
        let mut multipliers = self.multipliers_of_obstacles(residual, forces);
        for_each_chunk(&mut multipliers, |range, multipliers| {
            for (i, multiplier) in range.zip(multipliers) {
                if contact.get(i) == Some(&Contact::Inactive) {
                    *multiplier = 0.0;
                }
            }
        });
        if self.broken {
            return multipliers;
        }
        for (cell, local) in self.facets_of(BoundaryCondition::Dirichlet) {
            self.nodes_on(local).for_each(|i| multipliers[self.dofs.of(cell, i)] = 0.0);
        }
        let largest = largest(multipliers.len(), |i| multipliers[i].abs());
        for_each_chunk(&mut multipliers, |_, multipliers| {
            let is_rounding = |m: &&mut f64| m.abs() <= ROUNDING * largest;
            multipliers.iter_mut().filter(is_rounding).for_each(|m| *m = 0.0);
        });
        let by_volume = self.is_conforming_linear();
        let weight = |cell: usize| if by_volume { self.mesh.geometry(cell).volume } else { 1.0 };
        let pressing = |cell: usize, i: usize| {
            let unknown = self.dofs.of(cell, i);
            (multipliers[unknown] != 0.0 && obstacles.act_in(cell, i)).then_some(unknown)
        };
        let mut weights = vec![0.0; multipliers.len()];
        let Ok(()) =
            for_each_place::<D, _, Infallible>(&self.dofs, &mut weights, |sum, (cell, i)| {
                if pressing(cell, i).is_some() {
                    *sum += weight(cell);
                }
                Ok(())
            });
        let mut by_cell = zeros(n_cells * n);
        for_each_chunk_of_groups(&mut by_cell, n, |range, by_cell| {
            for (cell, shares) in (range.start / n..).zip(by_cell.chunks_exact_mut(n)) {
                // the volumes of cells without a share are not computed
                if (0..n).any(|i| pressing(cell, i).is_some()) {
                    let weight = weight(cell);
                    for (i, share) in shares.iter_mut().enumerate() {
                        *share =
                            pressing(cell, i).map_or(0.0, |k| weight * multipliers[k] / weights[k]);
                    }
                }
            }
        });
        by_cell
    }

    /// Exchanges multipliers for flux of linears, in and between the cells that count. Multipliers
    /// that are rounding beside `largest`, the largest one before facets took any, are not exchanged.
    pub(in crate::error_bound) fn exchange_linears(
        &self,
        pair: &mut PrimalDualPair<D>,
        (multipliers, largest): (&[f64], f64),
        (neighbours, counts): (&Neighbours, Counts<'_>),
    ) {
        let presses = |cell: usize| counts(cell) && multipliers[cell].abs() > ROUNDING * largest;
        let (numbers, steps) = self.cells_of_exchange(&presses, (neighbours, counts), false);
        let rule = Rule::new(D, DEGREE);
        let mut cells = collect(numbers.len(), |k| {
            let number = numbers[k] as usize;
            let multiplier = if presses(number) { multipliers[number] } else { 0.0 };
            self.cell_of_linears(number, pair, multiplier, &rule)
        });
        steps.visit(SWEEPS, &mut cells, |cells, _, step| match step {
            ExchangeStep::Between(at) => exchange_between(cells, at.map(FacetOfCell::half)),
            ExchangeStep::WithDirichlet(FacetOfCell { cell, local }) => {
                exchange_with_dirichlet(&mut cells[cell as usize], local.into())
            }
            ExchangeStep::Inside(_) => {}
        });
        pair.flux.replace_in(&numbers, |k| &cells[k].flux);
    }

    fn cell_of_linears(
        &self,
        number: usize,
        pair: &PrimalDualPair<D>,
        multiplier: f64,
        rule: &Rule,
    ) -> CellOfLinears<D> {
        let volume = self.mesh.geometry(number).volume;
        let alpha = self.alpha(number);
        let admissible = self.admissible_in(pair, number);
        let flux = pair.flux.of_cell(number);
        let corners = self.mesh.corners(number);
        let isotropic = self.isotropic_corners(number);
        let centre: Point<D> = isotropic[..=D].iter().map(|x| x / (D + 1) as f64).sum();
        let squares: f64 = isotropic[..=D].iter().map(|x| (centre - x).norm_squared()).sum();
        let per_volume = 1.0 / (D as f64 * volume);
        let gap = |k: usize| {
            let Some(bound) = admissible.bounds[k] else { return f64::INFINITY };
            let distance = |value: f64, x: &Point<D>| {
                ([1.0, -1.0][k] * (value - self.at(bound, number, x))).max(0.0)
            };
            if bound.constant().is_some() {
                let at_corners = (0..D + 1).map(|k| distance(admissible.values[k], &corners[k]));
                return at_corners.sum::<f64>() / (D + 1) as f64;
            }
            let at_point = |point: &[f64; 4]| {
                let value = admissible.values.iter().zip(point).map(|(v, b)| v * b).sum();
                distance(value, &in_space(point, &corners))
            };
            rule.iter().map(|(point, weight)| weight * at_point(point)).sum()
        };
        let mut cell = CellOfLinears {
            flux: array_of(|k| flux.get(k).copied().unwrap_or(0.0)),
            at_centre: array_of(|k| (centre - isotropic[k]) * per_volume),
            variance: squares * per_volume * per_volume / ((D + 1) * (D + 2)) as f64,
            weight: volume / alpha,
            difference: -self.isotropic_gradient(number, &admissible.gradient) * alpha,
            gaps: [gap(0), gap(1)],
            multiplier,
        };
        for facet in 0..=D {
            cell.difference += cell.at_centre[facet] * cell.flux[facet];
        }
        cell
    }
}

/// Exchanges the multipliers of two cells for the flux through their facet.
fn exchange_between<const D: usize>(
    cells: &mut [CellOfLinears<D>],
    [(here, facet_here), (there, facet_there)]: [HalfFacet; 2],
) {
    let [of_here, of_there] = [&cells[here], &cells[there]];
    let sign = (of_here.multiplier + of_there.multiplier).signum();
    let gaps = of_here.gap(sign).zip(of_there.gap(sign));
    let gaps = gaps.filter(|_| of_here.multiplier * of_there.multiplier >= 0.0);
    let Some((gap_here, gap_there)) = gaps else { return };
    let [slope, curvature] = of_here.slopes(facet_here);
    let [slope_there, curvature_there] = of_there.slopes(facet_there);
    let slope = slope - slope_there + sign * (gap_there - gap_here);
    let curvature = curvature + curvature_there;
    let (a, b) = (-of_there.multiplier, of_here.multiplier);
    let exchange = (-slope / curvature).max(a.min(b)).min(a.max(b));
    if exchange.is_finite() {
        cells[here].add(facet_here, exchange);
        cells[there].add(facet_there, -exchange);
    }
}

/// Exchanges the multiplier of a cell for the flux through a Dirichlet facet.
fn exchange_with_dirichlet<const D: usize>(cell: &mut CellOfLinears<D>, local: usize) {
    let sign = cell.multiplier.signum();
    let Some(gap) = cell.gap(sign) else { return };
    let [slope, curvature] = cell.slopes(local);
    let slope = slope - sign * gap;
    let exchange = sign * (-sign * slope / curvature).min(sign * cell.multiplier);
    if exchange.is_finite() {
        cell.add(local, exchange);
    }
}
