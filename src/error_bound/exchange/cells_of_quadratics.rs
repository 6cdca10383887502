//! Cells of an exchange with fluxes of degree one: their numbers, and what the square of the mismatch is as a
//! polynomial in these.

use std::f64::consts::PI;

use crate::arrays::array_of;
use crate::assemble::cut_simplices::in_space;
use crate::assemble::space::Space;
use crate::error_bound::PrimalDualPair;
use crate::error_bound::flux::Flux;
use crate::parallel::vectors::{collect, for_each_chunk_of_groups};
use crate::quadrature::Rule;
use crate::real::Point;

/// The degree of products of two fluxes.
const DEGREE: usize = 4;

/// A cell of the exchange, but for the products of its fluxes.
pub(super) struct CellOfQuadratics {
    /// The number of the cell.
    pub number: usize,
    /// The numbers that describe the flux in the cell, see [`Flux`].
    pub flux: [f64; 16],
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

/// Consecutive cells of an exchange with the products of their fluxes.
pub(super) struct CellsOfQuadratics<'c, const D: usize> {
    pub cells: &'c mut [CellOfQuadratics],
    /// By cell the products of its fluxes with each other.
    products: &'c [f64],
}

impl<'c, const D: usize> CellsOfQuadratics<'c, D> {
    /// The number of fluxes of a cell.
    const N: usize = (D + 1) * (D + 1);

    /// Cells of an exchange, of which `first` is the number of the first one; `products` are those of all its cells.
    pub fn new(cells: &'c mut [CellOfQuadratics], products: &'c [f64], first: usize) -> Self {
        Self { cells, products: &products[first * Self::N * Self::N..] }
    }

    /// Half of the derivative of the square of the mismatch of a cell by one of its numbers.
    fn slope(&self, k: usize, number: usize) -> f64 {
        let row = &self.products[(k * Self::N + number) * Self::N..][..Self::N];
        let products = row.iter().zip(&self.cells[k].flux).map(|(p, c)| p * c);
        products.sum::<f64>() - self.cells[k].gradient[number]
    }
    /// The square of the mismatch of a cell.
    pub fn mismatch(&self, k: usize) -> f64 {
        let of_cell = &self.cells[k];
        let term =
            |(number, c): (usize, &f64)| c * (self.slope(k, number) - of_cell.gradient[number]);
        let flux = of_cell.flux[..Self::N].iter();
        (flux.enumerate().map(term).sum::<f64>() + of_cell.energy).max(0.0)
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
        cell.flux[number] += exchange;
        cell.multiplier[vertex] -= cell.divergence * exchange;
    }
}

impl<const D: usize> Space<'_, D> {
    /// The cells of an exchange, by their numbers in the mesh, each with its multiplier and its numbers of the flux.
    pub(super) fn cells_of_quadratics(
        &self,
        numbers: &[u32],
        multiplier: impl Fn(usize) -> [f64; 4] + Sync,
        pair: &PrimalDualPair<D>,
    ) -> Vec<CellOfQuadratics> {
        let rule = Rule::new(D, DEGREE);
        collect(numbers.len(), |k| {
            let number = numbers[k] as usize;
            self.cell_of_quadratics(number, pair, multiplier(number), &rule)
        })
    }

    fn cell_of_quadratics(
        &self,
        number: usize,
        pair: &PrimalDualPair<D>,
        multiplier: [f64; 4],
        rule: &Rule,
    ) -> CellOfQuadratics {
        let n = CellsOfQuadratics::<D>::N;
        let volume = self.mesh.geometry(number).volume;
        let per_volume = 1.0 / (D as f64 * volume);
        let corners = self.isotropic_corners(number);
        let alpha = self.alpha(number);
        let admissible = self.admissible_in(pair, number);
        let flux = pair.flux.of_cell(number);
        let mut gaps = [[0.0; 4]; 2];
        let (mut of_gradient, mut energy) = ([0.0; 16], 0.0);
        for (point, weight) in rule.iter() {
            let x = self.cell_point(point, number);
            let weight = weight * volume;
            let (value, gradient) = admissible.at(point, &x);
            let gradient = self.isotropic_gradient(number, &gradient);
            energy += weight * alpha * gradient.norm_squared();
            for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
                let distance = admissible.bounds[k]
                    .map_or(0.0, |psi| sign * (value - self.at(psi, number, &x)));
                (0..D + 1).for_each(|j| gaps[k][j] += weight * point[j] * distance);
            }
            let fluxes = fluxes_at(point, &in_space(point, &corners), (&corners, per_volume));
            (0..n).for_each(|a| of_gradient[a] += weight * gradient.dot(&fluxes[a]));
        }
        CellOfQuadratics {
            number,
            flux: array_of(|i| flux.get(i).copied().unwrap_or(0.0)),
            multiplier,
            gaps,
            gradient: of_gradient,
            divergence: (D + 1) as f64 * per_volume,
            is_given: admissible.bounds.map(|bound| bound.is_some()),
            energy,
            variation: self.isotropic_diameter(number) / PI
                * (volume / (alpha * ((D + 1) * (D + 2)) as f64)).sqrt(),
            has_one_sign: false,
        }
    }

    /// For each cell of an exchange, by its number in the mesh, the products of its fluxes with each other.
    pub(super) fn products_of_fluxes(&self, numbers: &[u32]) -> Vec<f64> {
        let rule = Rule::new(D, DEGREE);
        let n = CellsOfQuadratics::<D>::N;
        let square = n * n;
        let mut products = vec![0.0; numbers.len() * square];
        for_each_chunk_of_groups(&mut products, square, |range, products| {
            let first = range.start / square;
            for (&number, products) in
                numbers[first..].iter().zip(products.chunks_exact_mut(square))
            {
                let number = number as usize;
                let (volume, alpha) = (self.mesh.geometry(number).volume, self.alpha(number));
                let corners = self.isotropic_corners(number);
                let geometry = (&corners, 1.0 / (D as f64 * volume));
                for (point, weight) in rule.iter() {
                    let fluxes = fluxes_at(point, &in_space(point, &corners), geometry);
                    for (a, products) in products.chunks_exact_mut(n).enumerate() {
                        for (product, of_other) in products.iter_mut().zip(&fluxes) {
                            *product += weight * volume / alpha * fluxes[a].dot(of_other);
                        }
                    }
                }
            }
        });
        products
    }
}

/// The fluxes `lambda_j phi_F` of a cell at a point, given by its barycentric coordinates and in space; of the cell by
/// its corners and `1 / (D |K|)`.
fn fluxes_at<const D: usize>(
    point: &[f64; 4],
    x: &Point<D>,
    (corners, per_volume): (&[Point<D>; 4], f64),
) -> [Point<D>; 16] {
    let mut fluxes = [Point::<D>::zeros(); 16];
    for (facet, corner) in corners.iter().enumerate().take(D + 1) {
        let along = (x - corner) * per_volume;
        (0..D + 1).for_each(|j| fluxes[Flux::<D>::place(facet, j)] = along * point[j]);
    }
    fluxes
}
