//! Exchange for linears: one flux of each facet, one multiplier of each cell.

use super::{ROUNDING, Step};
use crate::assemble::cut_simplices::in_space;
use crate::assemble::space::{Place, Space};
use crate::error_bound::PrimalDualPair;
use crate::error_bound::contact::NodeForce;
use crate::mesh::{BoundaryPart, Neighbours};
use crate::quadrature::Rule;
use crate::real::{Point, Real};

/// Visits of each facet. The matrix of the least-squares problem is the mass matrix of fluxes, whose condition
/// does not grow with the number of cells.
const SWEEPS: usize = 4;

/// The degree of the rule for distances from obstacles that are no constants.
const DEGREE: usize = 2;

/// What the exchange needs of a cell.
struct CellInContact<const D: usize> {
    /// The number of the cell.
    number: usize,
    /// The centre less the vertices.
    arms: [Point<f64, D>; 4],
    /// The mean of the square of the distance from the centre.
    variance: f64,
    /// `1 / (D |K|)`.
    per_volume: f64,
    /// The coefficient.
    alpha: f64,
    /// The gradient of the function, times the coefficient.
    gradient: Point<f64, D>,
    /// The mean distances of the function from the lower and the upper obstacle; if they are given.
    gaps: [Option<f64>; 2],
    /// The integral of the multiplier.
    multiplier: f64,
}

impl<const D: usize> CellInContact<D> {
    /// Half of the derivative of the square of the mismatch by the flux through a facet, at these fluxes, and half of
    /// the second derivative.
    fn slopes(&self, flux: &[f64], facet: usize) -> [f64; 2] {
        let (mut at_centre, mut sum) = (Point::zeros(), 0.0);
        for (flux, arm) in flux.iter().zip(&self.arms) {
            at_centre += arm * *flux;
            sum += flux;
        }
        let (arm, d) = (&self.arms[facet], D as f64);
        let difference = at_centre * self.per_volume - self.gradient;
        let variance = self.variance * self.per_volume / d;
        [
            (arm.dot(&difference) / d + variance * sum) / self.alpha,
            (arm.norm_squared() * self.per_volume / d + variance) / self.alpha,
        ]
    }

    /// The mean distance from the obstacle that presses with this sign.
    fn gap(&self, sign: f64) -> Option<f64> {
        self.gaps[usize::from(sign < 0.0)]
    }
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The integrals of multipliers of obstacles over cells: of a shared unknown each cell has the part that its
    /// flux balances, by volume around a vertex and half on the two sides of a facet.
    pub(in crate::error_bound) fn multipliers_by_cell(
        &self,
        residual: &[f64],
        forces: &[NodeForce],
    ) -> Vec<f64> {
        let n = self.per_cell();
        let mut multipliers = self.multipliers_of_obstacles(residual, forces);
        if self.broken {
            return multipliers.chunks_exact(n).map(|m| m.iter().sum()).collect();
        }
        for (cell, local) in self.facets_of(BoundaryPart::Dirichlet) {
            self.nodes_on(local).for_each(|i| multipliers[self.dofs.of(cell, i)] = 0.0);
        }
        let largest = multipliers.iter().fold(0.0, |largest: f64, m| largest.max(m.abs()));
        let is_rounding = |m: &&mut f64| m.abs() <= ROUNDING * largest;
        multipliers.iter_mut().filter(is_rounding).for_each(|m| *m = 0.0);
        let by_volume = self.is_conforming_linear();
        let n_cells = self.mesh.n_cells();
        let part =
            |cell: usize| if by_volume { self.mesh.geometry(cell).volume.to_f64() } else { 1.0 };
        let mut parts = vec![0.0; multipliers.len()];
        let presses = |cell: usize| (0..n).any(|i| multipliers[self.dofs.of(cell, i)] != 0.0);
        let mut of_cells = vec![0.0; n_cells];
        for cell in (0..n_cells).filter(|&cell| presses(cell)) {
            of_cells[cell] = part(cell);
            (0..n).for_each(|i| parts[self.dofs.of(cell, i)] += of_cells[cell]);
        }
        for (cell, of_cell) in of_cells.iter_mut().enumerate().filter(|(_, part)| **part > 0.0) {
            let unknowns = (0..n).map(|i| self.dofs.of(cell, i));
            *of_cell *= unknowns.map(|i| multipliers[i] / parts[i]).sum::<f64>();
        }
        of_cells
    }

    /// Exchanges multipliers for flux of linears.
    pub(in crate::error_bound) fn exchange_linears(
        &self,
        function: &PrimalDualPair,
        multipliers: &[f64],
        neighbours: &Neighbours,
        flux: &mut [f64],
    ) {
        let largest = multipliers.iter().fold(0.0, |largest: f64, m| largest.max(m.abs()));
        let presses = |cell: usize| multipliers[cell].abs() > ROUNDING * largest;
        let (numbers, steps) = self.cells_of_exchange(presses, neighbours);
        let rule = Rule::new(D, DEGREE);
        let in_contact = |&cell: &usize| {
            let multiplier = if presses(cell) { multipliers[cell] } else { 0.0 };
            self.linear_in_contact(cell, function, multiplier, &rule)
        };
        let mut cells: Vec<CellInContact<D>> = numbers.iter().map(in_contact).collect();
        for step in (0..SWEEPS).flat_map(|_| &steps) {
            match *step {
                Step::Between(at) => exchange_between(&mut cells, at, flux),
                Step::WithDirichlet((k, local)) => {
                    exchange_with_dirichlet(&mut cells[k], local, flux);
                }
                Step::Inside(_) => {}
            }
        }
    }

    fn linear_in_contact(
        &self,
        number: usize,
        function: &PrimalDualPair,
        multiplier: f64,
        rule: &Rule,
    ) -> CellInContact<D> {
        let volume = self.mesh.geometry(number).volume.to_f64();
        let alpha = self.alpha(number).to_f64();
        let admissible = self.admissible_in(function, number);
        let corners = self.mesh.corners(number);
        let centre: Point<f64, D> = corners[..=D].iter().map(|x| x / (D + 1) as f64).sum();
        let mut arms = [Point::zeros(); 4];
        (0..=D).for_each(|k| arms[k] = centre - corners[k]);
        let squares: f64 = arms.iter().map(|arm| arm.norm_squared()).sum();
        let gap = |k: usize| {
            let bound = admissible.bounds[k]?;
            let distance =
                |value: f64, x: &Point<f64, D>| ([1.0, -1.0][k] * (value - bound.at(x))).max(0.0);
            if bound.constant().is_some() {
                let at_corners = (0..=D).map(|k| distance(admissible.values[k], &corners[k]));
                return Some(at_corners.sum::<f64>() / (D + 1) as f64);
            }
            let at_point = |point: &[f64; 4]| {
                let value = admissible.values.iter().zip(point).map(|(v, b)| v * b).sum();
                distance(value, &in_space(point, &corners))
            };
            Some(rule.iter().map(|(point, weight)| weight * at_point(point)).sum())
        };
        CellInContact {
            number,
            arms,
            variance: squares / ((D + 1) * (D + 2)) as f64,
            per_volume: 1.0 / (D as f64 * volume),
            alpha,
            gradient: admissible.gradient * alpha,
            gaps: [gap(0), gap(1)],
            multiplier,
        }
    }
}

/// Exchanges the multipliers of two cells for the flux through their facet.
fn exchange_between<const D: usize>(
    cells: &mut [CellInContact<D>],
    [(here, local), (there, across)]: [Place; 2],
    flux: &mut [f64],
) {
    let [of_here, of_there] = [here, there].map(|k| cells[k].multiplier);
    let sign = (of_here + of_there).signum();
    let gaps = cells[here].gap(sign).zip(cells[there].gap(sign));
    let Some((gap_here, gap_there)) = gaps.filter(|_| of_here * of_there >= 0.0) else { return };
    let start = |k: usize| cells[k].number * (D + 1);
    let fluxes = |k: usize| &flux[start(k)..start(k) + D + 1];
    let [slope, curvature] = cells[here].slopes(fluxes(here), local);
    let [slope_there, curvature_there] = cells[there].slopes(fluxes(there), across);
    let of_gaps = sign * (gap_there - gap_here);
    let least = -(slope - slope_there + of_gaps) / (curvature + curvature_there);
    let (a, b) = (-of_there, of_here);
    let exchange = least.max(a.min(b)).min(a.max(b));
    if exchange.is_finite() {
        let places = [start(here) + local, start(there) + across];
        flux[places[0]] += exchange;
        flux[places[1]] -= exchange;
        cells[here].multiplier -= exchange;
        cells[there].multiplier += exchange;
    }
}

/// Exchanges the multiplier of a cell for the flux through a Dirichlet facet.
fn exchange_with_dirichlet<const D: usize>(
    cell: &mut CellInContact<D>,
    local: usize,
    flux: &mut [f64],
) {
    let fluxes = &mut flux[cell.number * (D + 1)..][..D + 1];
    let sign = cell.multiplier.signum();
    let Some(gap) = cell.gap(sign) else { return };
    let [slope, curvature] = cell.slopes(fluxes, local);
    let least = -(sign * slope - gap) / curvature;
    let exchange = sign * least.min(sign * cell.multiplier);
    if exchange.is_finite() {
        fluxes[local] += exchange;
        cell.multiplier -= exchange;
    }
}
