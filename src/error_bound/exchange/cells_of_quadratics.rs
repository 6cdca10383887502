//! Cells of an exchange with fluxes of degree one: their numbers, and what the square of the mismatch is as a
//! polynomial in these.

use std::f64::consts::PI;

use crate::assemble::space::Space;
use crate::error_bound::PrimalDualPair;
use crate::error_bound::flux::Flux;
use crate::quadrature::Rule;
use crate::real::Point;

/// The degree of products of two fluxes.
const DEGREE: usize = 4;

/// A cell of the exchange, but for the products of its fluxes.
pub(super) struct CellOfQuadratics {
    /// The number of the cell.
    pub number: usize,
    /// The multiplier at the vertices.
    pub multiplier: [f64; 4],
    /// The integrals of the distances of the function from the lower and the upper obstacle times barycentric
    /// coordinates.
    pub gaps: [[f64; 4]; 2],
    /// Products of the gradient of the function with the fluxes.
    pub gradient: [f64; 16],
    /// The derivative of the divergence at a vertex by a density at that vertex.
    pub divergence: f64,
    /// Whether each of the two obstacles is given.
    pub is_given: [bool; 2],
    /// The square of the energy norm of the function.
    pub energy: f64,
    /// What a linear function without mean counts for by the inequality of Payne and Weinberger, over the root of the
    /// sum of the squares of its values at the vertices: `h_K / pi (|K| / (alpha (D + 1) (D + 2)))^1/2`.
    pub variation: f64,
    /// Whether the multiplier has one sign in the cell: otherwise its variation counts besides, and grows with numbers
    /// that make the mismatch smaller.
    pub has_one_sign: bool,
}

impl CellOfQuadratics {
    /// The multiplier in the mean, times the number of vertices.
    pub fn sum(&self) -> f64 {
        self.multiplier.iter().sum()
    }
    /// How far the multiplier at a vertex may fall, times its sign.
    pub fn room(&self, sign: f64, vertex: usize) -> f64 {
        (sign * self.multiplier[vertex]).max(0.0) / self.divergence
    }
    /// The integral of distance and barycentric coordinate by which the complementarity grows with a density.
    pub fn gap(&self, sign: f64, vertex: usize) -> f64 {
        self.divergence * self.gaps[usize::from(sign < 0.0)][vertex]
    }
}

/// The cells of the exchange.
pub(super) struct CellsOfQuadratics<'f, const D: usize> {
    pub cells: Vec<CellOfQuadratics>,
    /// By cell the products of its fluxes with each other.
    products: Vec<f64>,
    pub flux: &'f mut Flux<D>,
}

impl<const D: usize> CellsOfQuadratics<'_, D> {
    /// The number of fluxes of a cell.
    pub const N: usize = (D + 1) * (D + 1);

    /// Half of the derivative of the square of the mismatch of a cell by one of its numbers.
    fn slope(&self, k: usize, number: usize) -> f64 {
        let row = &self.products[(k * Self::N + number) * Self::N..][..Self::N];
        let flux = self.flux.of_cell(self.cells[k].number);
        let products = row.iter().zip(flux).map(|(p, c)| p * c);
        products.sum::<f64>() - self.cells[k].gradient[number]
    }
    /// The square of the mismatch of a cell.
    pub fn mismatch(&self, k: usize) -> f64 {
        let flux = self.flux.of_cell(self.cells[k].number);
        let of_cell = &self.cells[k];
        let term =
            |(number, c): (usize, &f64)| c * (self.slope(k, number) - of_cell.gradient[number]);
        (flux.iter().enumerate().map(term).sum::<f64>() + of_cell.energy).max(0.0)
    }

    /// The part of a cell in the square of the bound: mismatch and complementarity.
    pub fn square(&self, k: usize) -> f64 {
        let cell = &self.cells[k];
        let gaps = &cell.gaps[usize::from(cell.sum() < 0.0)];
        let complementarity: f64 = cell.multiplier.iter().zip(gaps).map(|(m, gap)| m * gap).sum();
        self.mismatch(k) + 2.0 * complementarity.abs()
    }

    /// The square of the mismatch and twice a linear term by a change of numbers, each given by its cell, its number
    /// in the cell and a sign: half of the derivative, and half of the second derivative.
    pub fn slopes(&self, terms: &[(usize, usize, f64)], linear: f64) -> [f64; 2] {
        let product = |k: usize, row: usize, column: usize| {
            self.products[(k * Self::N + row) * Self::N + column]
        };
        let (mut slope, mut curvature) = (linear, 0.0);
        for (i, &(k, row, sign)) in terms.iter().enumerate() {
            slope += sign * self.slope(k, row);
            curvature += product(k, row, row);
            for &(_, column, of_other) in terms[..i].iter().filter(|(other, ..)| *other == k) {
                curvature += 2.0 * sign * of_other * product(k, row, column);
            }
        }
        [slope, curvature]
    }

    /// Adds to a number of a cell that changes the divergence at one vertex.
    pub fn add(&mut self, k: usize, number: usize, vertex: usize, exchange: f64) {
        let cell = &mut self.cells[k];
        self.flux.of_cell_mut(cell.number)[number] += exchange;
        cell.multiplier[vertex] -= cell.divergence * exchange;
    }
}

impl<const D: usize> Space<'_, D> {
    /// The cells with these numbers.
    pub(super) fn cells_with_products<'f>(
        &self,
        numbers: &[usize],
        multiplier: impl Fn(usize) -> [f64; 4],
        function: &PrimalDualPair<D>,
        flux: &'f mut Flux<D>,
    ) -> CellsOfQuadratics<'f, D> {
        let rule = Rule::new(D, DEGREE);
        let square = CellsOfQuadratics::<D>::N * CellsOfQuadratics::<D>::N;
        let mut products = vec![0.0; numbers.len() * square];
        let cells = numbers.iter().zip(products.chunks_exact_mut(square)).map(
            |(&number, products): (&usize, &mut [f64])| {
                self.cell_of_quadratics(number, function, multiplier(number), (&rule, products))
            },
        );
        CellsOfQuadratics { cells: cells.collect(), products, flux }
    }

    fn cell_of_quadratics(
        &self,
        number: usize,
        function: &PrimalDualPair<D>,
        multiplier: [f64; 4],
        (rule, products): (&Rule, &mut [f64]),
    ) -> CellOfQuadratics {
        let n = (D + 1) * (D + 1);
        let volume = self.mesh.geometry(number).volume;
        let per_volume = 1.0 / (D as f64 * volume);
        let alpha = self.alpha(number);
        let admissible = self.admissible_in(function, number);
        let corners = self.mesh.corners(number);
        let mut gaps = [[0.0; 4]; 2];
        let (mut of_gradient, mut energy) = ([0.0; 16], 0.0);
        for (point, weight) in rule.iter() {
            let x = self.cell_point(point, number);
            let weight = weight * volume;
            let (value, gradient) = admissible.at(point, &x);
            energy += weight * alpha * gradient.norm_squared();
            for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
                let distance = admissible.bounds[k]
                    .map_or(0.0, |psi| sign * (value - self.at(psi, number, &x)));
                (0..D + 1).for_each(|j| gaps[k][j] += weight * point[j] * distance);
            }
            let mut fluxes = [Point::<D>::zeros(); 16];
            for (facet, corner) in corners.iter().enumerate().take(D + 1) {
                let along = (x - corner) * per_volume;
                (0..D + 1).for_each(|j| fluxes[Flux::<D>::place(facet, j)] = along * point[j]);
            }
            for a in 0..n {
                of_gradient[a] += weight * gradient.dot(&fluxes[a]);
                for b in 0..n {
                    products[a * n + b] += weight / alpha * fluxes[a].dot(&fluxes[b]);
                }
            }
        }
        CellOfQuadratics {
            number,
            multiplier,
            gaps,
            gradient: of_gradient,
            divergence: (D + 1) as f64 * per_volume,
            is_given: admissible.bounds.map(|bound| bound.is_some()),
            energy,
            variation: self.mesh.cell_diameter(number) / PI
                * (volume / (alpha * ((D + 1) * (D + 2)) as f64)).sqrt(),
            has_one_sign: false,
        }
    }
}
