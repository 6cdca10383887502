//! Exchange for quadratics: fluxes of degree one, multipliers linear in cells.
//!
//! In the notation of [`quadratics`](crate::error_bound::quadratics) the divergence at vertex `j` of a cell depends on
//! the `c_Fj` of that vertex and on the sum of all `c_FF`. A number added to `c_Fj` on one side of a facet and taken
//! from its counterpart on the other side changes the multipliers of the two cells at vertex `j` alone; a number
//! added to `c_AA` and taken from `c_BB` changes that of the cell at `A` and `B`.

use std::f64::consts::PI;

use super::ROUNDING;
use crate::assemble::space::{Place, Space};
use crate::error_bound::PrimalDualPair;
use crate::error_bound::quadratics::{CellLoads, vertices_of};
use crate::error_bound::terms::limit;
use crate::mesh::{BoundaryPart, Neighbour, Neighbours};
use crate::quadrature::Rule;
use crate::real::{Point, Real, point_f64};

/// Visits of each number: the mass matrix of fluxes has a condition that does not grow with the number of cells.
const SWEEPS: usize = 8;

/// The degree of products of two fluxes.
const DEGREE: usize = 4;

/// A cell of the exchange, but for the products of its fluxes.
struct CellInContact {
    /// The number of the cell.
    number: usize,
    /// The multiplier at the vertices.
    multiplier: [f64; 4],
    /// The integrals of the distances of the function from the lower and the upper obstacle times barycentric
    /// coordinates.
    gaps: [[f64; 4]; 2],
    /// Products of the gradient of the function with the fluxes.
    gradient: [f64; 16],
    /// By how much the divergence at a vertex grows with a density there.
    divergence: f64,
    /// Whether each of the two obstacles is given.
    is_given: [bool; 2],
    /// The square of the energy norm of the function.
    energy: f64,
    /// The factor of the norm of a function without mean in the inequality of Payne and Weinberger, over the root of
    /// the coefficient and of `(D + 1) (D + 2)` over the volume: by it the values of a linear function
    /// at the vertices count.
    variation: f64,
    /// Whether the multiplier has one sign in the cell: otherwise its variation counts besides, and grows with numbers
    /// that make the mismatch smaller.
    has_one_sign: bool,
}

impl CellInContact {
    /// The sign of the multiplier in the mean.
    fn mean(&self) -> f64 {
        self.multiplier.iter().sum()
    }
    /// How far the multiplier at a vertex may fall, times its sign.
    fn room(&self, sign: f64, vertex: usize) -> f64 {
        (sign * self.multiplier[vertex]).max(0.0) / self.divergence
    }
    /// The integral of distance and barycentric coordinate by which the complementarity grows with a density.
    fn gap(&self, sign: f64, vertex: usize) -> f64 {
        self.divergence * self.gaps[usize::from(sign < 0.0)][vertex]
    }
}

/// The cells of the exchange.
struct Cells<'f, const D: usize> {
    cells: Vec<CellInContact>,
    /// By cell the products of its fluxes with each other.
    products: Vec<f64>,
    flux: &'f mut [f64],
}

impl<const D: usize> Cells<'_, D> {
    /// The number of fluxes of a cell.
    const N: usize = (D + 1) * (D + 1);

    /// Half of the derivative of the square of the mismatch of a cell by one of its numbers.
    fn slope(&self, k: usize, number: usize) -> f64 {
        let row = &self.products[(k * Self::N + number) * Self::N..][..Self::N];
        let flux = &self.flux[self.cells[k].number * Self::N..][..Self::N];
        let products = row.iter().zip(flux).map(|(p, c)| p * c);
        products.sum::<f64>() - self.cells[k].gradient[number]
    }
    /// The square of the mismatch of a cell.
    fn mismatch(&self, k: usize) -> f64 {
        let flux = &self.flux[self.cells[k].number * Self::N..][..Self::N];
        let of_cell = &self.cells[k];
        let term =
            |(number, c): (usize, &f64)| c * (self.slope(k, number) - of_cell.gradient[number]);
        (flux.iter().enumerate().map(term).sum::<f64>() + of_cell.energy).max(0.0)
    }

    /// Moves the multiplier of a cell towards its mean, until it has one sign, by numbers inside the cell: if that costs
    /// less than what it has of the other sign counts for.
    fn make_sign_definite(&mut self, k: usize) {
        let cell = &self.cells[k];
        let mean = cell.mean() / (D + 1) as f64;
        let share = limit(mean, &cell.multiplier[..=D]);
        if share == 1.0 {
            self.cells[k].has_one_sign = true;
            return;
        }
        let squares: f64 = cell.multiplier[..=D].iter().map(|m| (m - mean).powi(2)).sum();
        let of_variation = (1.0 - share) * cell.variation * squares.sqrt();
        let limit = (self.mismatch(k).sqrt() + of_variation).powi(2);
        let changes = cell.multiplier.map(|m| (1.0 - share) * (m - mean) / cell.divergence);
        (0..=D).for_each(|j| self.add(k, j * (D + 2), j, changes[j]));
        if self.mismatch(k) > limit {
            (0..=D).for_each(|j| self.add(k, j * (D + 2), j, -changes[j]));
        } else {
            self.cells[k].has_one_sign = true;
        }
    }

    fn product(&self, k: usize, row: usize, column: usize) -> f64 {
        self.products[(k * Self::N + row) * Self::N + column]
    }
    fn add(&mut self, k: usize, number: usize, vertex: usize, exchange: f64) {
        let cell = &mut self.cells[k];
        self.flux[cell.number * Self::N + number] += exchange;
        cell.multiplier[vertex] -= cell.divergence * exchange;
    }

    /// Exchanges multipliers of two cells at a vertex of their facet, by its numbers in the two cells.
    fn exchange_between(&mut self, at: [Place; 2], vertex: [usize; 2]) {
        let [here, there] = at.map(|(k, _)| &self.cells[k]);
        let sign = (here.mean() + there.mean()).signum();
        let obstacle = usize::from(sign < 0.0);
        let takes_part = |cell: &CellInContact| cell.has_one_sign && cell.is_given[obstacle];
        if here.mean() * there.mean() < 0.0 || !takes_part(here) || !takes_part(there) {
            return;
        }
        let number = [0, 1].map(|s| at[s].1 * (D + 1) + vertex[s]);
        let slope = self.slope(at[0].0, number[0]) - self.slope(at[1].0, number[1]);
        let curvature: f64 = (0..2).map(|s| self.product(at[s].0, number[s], number[s])).sum();
        let of_gaps = sign * (there.gap(sign, vertex[1]) - here.gap(sign, vertex[0]));
        let least = sign * -(slope + of_gaps) / curvature;
        let exchange =
            sign * least.max(-there.room(sign, vertex[1])).min(here.room(sign, vertex[0]));
        if exchange.is_finite() {
            self.add(at[0].0, number[0], vertex[0], exchange);
            self.add(at[1].0, number[1], vertex[1], -exchange);
        }
    }

    /// Exchanges the multiplier of a cell at a vertex of a Dirichlet facet.
    fn exchange_with_dirichlet(&mut self, (k, local): Place, vertex: usize) {
        let cell = &self.cells[k];
        let sign = cell.mean().signum();
        if !(cell.has_one_sign && cell.is_given[usize::from(sign < 0.0)]) {
            return;
        }
        let number = local * (D + 1) + vertex;
        let slope = self.slope(k, number) - sign * cell.gap(sign, vertex);
        let least = sign * -slope / self.product(k, number, number);
        let exchange = sign * least.min(cell.room(sign, vertex));
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
        let sign = cell.mean().signum();
        let number = [a, b].map(|v| v * (D + 2));
        let slope = self.slope(k, number[0]) - self.slope(k, number[1]);
        let curvature = self.product(k, number[0], number[0])
            + self.product(k, number[1], number[1])
            - 2.0 * self.product(k, number[0], number[1]);
        let of_gaps = sign * (cell.gap(sign, b) - cell.gap(sign, a));
        let least = sign * -(slope + of_gaps) / curvature;
        let exchange = sign * least.max(-cell.room(sign, b)).min(cell.room(sign, a));
        if exchange.is_finite() {
            self.add(k, number[0], a, exchange);
            self.add(k, number[1], b, -exchange);
        }
    }
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// Exchanges multipliers for flux of quadratics.
    pub(in crate::error_bound) fn exchange_quadratics(
        &self,
        function: &PrimalDualPair,
        loads: &CellLoads,
        neighbours: &Neighbours,
        flux: &mut [f64],
    ) {
        let multipliers = self.linear_multipliers(loads);
        let strength = |cell: usize| {
            multipliers[cell][..=D].iter().fold(0.0, |most: f64, m| most.max(m.abs()))
        };
        let largest = (0..multipliers.len()).map(strength).fold(0.0, f64::max);
        let presses = |cell: usize| strength(cell) > ROUNDING * largest;
        let (numbers, places) = self.cells_of_exchange(presses, neighbours);
        let rule = Rule::new(D, DEGREE);
        let square = (D + 1) * (D + 1);
        let mut products = vec![0.0; numbers.len() * square * square];
        let in_contact = |(&number, products): (&usize, &mut [f64])| {
            let multiplier = if presses(number) { multipliers[number] } else { [0.0; 4] };
            self.quadratic_in_contact(number, function, multiplier, (&rule, products))
        };
        let cells: Vec<CellInContact> = numbers
            .iter()
            .zip(products.chunks_exact_mut(square * square))
            .map(in_contact)
            .collect();
        let n_cells = cells.len();
        let mut cells = Cells::<D> { cells, products, flux };
        (0..n_cells).for_each(|k| cells.make_sign_definite(k));
        for _ in 0..SWEEPS {
            for here in 0..n_cells {
                let cell = cells.cells[here].number;
                for local in 0..=D {
                    match neighbours.across(cell, local) {
                        Neighbour::Cell { cell: other, local: across } => {
                            let (other, across) = (other as usize, usize::from(across));
                            let there = places[other] as usize;
                            if other < cell || there >= n_cells {
                                continue;
                            }
                            let at = [(here, local), (there, across)];
                            for j in vertices_of::<D>(local) {
                                let vertex = self.mesh.cell(cell)[j];
                                let of_other = self.mesh.cell(other).iter();
                                let Some(m) = of_other.clone().position(|&v| v == vertex) else {
                                    continue;
                                };
                                cells.exchange_between(at, [j, m]);
                            }
                        }
                        Neighbour::Boundary(BoundaryPart::Dirichlet) => {
                            for j in vertices_of::<D>(local) {
                                cells.exchange_with_dirichlet((here, local), j);
                            }
                        }
                        Neighbour::Boundary(_) => {}
                    }
                }
                for a in 0..=D {
                    (a + 1..=D).for_each(|b| cells.exchange_inside(here, [a, b]));
                }
            }
        }
    }

    /// The multipliers of obstacles, projected on linear functions, at the vertices of cells.
    fn linear_multipliers(&self, loads: &CellLoads) -> Vec<[f64; 4]> {
        let (n, d) = (self.per_cell(), D as f64);
        let of_cell = |cell: usize| {
            let volume = self.mesh.geometry(cell).volume.to_f64();
            let (values, given) = (&loads.values[cell * n..], &loads.given[cell * n..]);
            let mut means = [0.0; 4];
            for (i, functional) in loads.functionals.iter().enumerate() {
                let multiplier = (values[i] - given[i]) / volume;
                for (mean, products) in means.iter_mut().zip(functional) {
                    *mean += multiplier * products.iter().sum::<f64>();
                }
            }
            let sum: f64 = means.iter().sum();
            let value = |k: usize| (d + 1.0) * ((d + 2.0) * means[k] - sum);
            std::array::from_fn(|k| if k <= D { value(k) } else { 0.0 })
        };
        (0..self.mesh.n_cells()).map(of_cell).collect()
    }

    fn quadratic_in_contact(
        &self,
        number: usize,
        function: &PrimalDualPair,
        multiplier: [f64; 4],
        (rule, products): (&Rule, &mut [f64]),
    ) -> CellInContact {
        let n = (D + 1) * (D + 1);
        let volume = self.mesh.geometry(number).volume.to_f64();
        let per_volume = 1.0 / (D as f64 * volume);
        let alpha = self.alpha(number).to_f64();
        let admissible = self.admissible_in(function, number);
        let mut corners = [Point::<f64, D>::zeros(); 4];
        for (corner, &v) in corners.iter_mut().zip(self.mesh.cell(number)) {
            *corner = point_f64(&self.mesh.vertices()[v as usize]);
        }
        let mut gaps = [[0.0; 4]; 2];
        let (mut of_gradient, mut energy) = ([0.0; 16], 0.0);
        for (point, weight) in rule.iter() {
            let x = self.cell_point(point, number);
            let weight = weight * volume;
            let (value, gradient) = admissible.at(point, &x);
            energy += weight * alpha * gradient.norm_squared();
            for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
                let distance = admissible.bounds[k].map_or(0.0, |psi| sign * (value - psi.at(&x)));
                (0..=D).for_each(|j| gaps[k][j] += weight * point[j] * distance);
            }
            let mut fluxes = [Point::<f64, D>::zeros(); 16];
            for (facet, corner) in corners.iter().enumerate().take(D + 1) {
                let along = (x - corner) * per_volume;
                (0..=D).for_each(|j| fluxes[facet * (D + 1) + j] = along * point[j]);
            }
            for a in 0..n {
                of_gradient[a] += weight * gradient.dot(&fluxes[a]);
                for b in 0..n {
                    products[a * n + b] += weight / alpha * fluxes[a].dot(&fluxes[b]);
                }
            }
        }
        CellInContact {
            number,
            multiplier,
            gaps,
            gradient: of_gradient,
            divergence: (D + 1) as f64 * per_volume,
            is_given: admissible.bounds.map(|bound| bound.is_some()),
            energy,
            variation: admissible.diameter / PI
                * (volume / (alpha * ((D + 1) * (D + 2)) as f64)).sqrt(),
            has_one_sign: false,
        }
    }
}
