//! The flux of a pair in a cell, and what it leaves of the load.

use crate::arrays::map_entries;
use crate::assemble::space::Space;
use crate::error_bound::PrimalDualPair;
use crate::real::Point;

/// The flux in a cell: `q = sum_j lambda_j (s_j x - o_j) / (D |K|)` with one term, without `lambda_j`, where
/// the density is constant on facets.
pub(super) struct CellFlux<const D: usize> {
    /// Number of terms: one, or that of the vertices.
    pub n: usize,
    /// `sum_F c_Fj`.
    pub sums: [f64; 4],
    /// `sum_F c_Fj a_F`.
    pub origins: [Point<D>; 4],
    /// `1 / (D |K|)`.
    pub per_volume: f64,
    /// `D |K| div q`: at the vertices; constant for one term.
    pub divergence: [f64; 4],
}

impl<const D: usize> CellFlux<D> {
    /// The factors of the terms at a point.
    pub fn shares<'p>(&self, point: &'p [f64; 4]) -> &'p [f64] {
        if self.n == 1 { &[1.0] } else { &point[..=D] }
    }
    /// The value at a point, by barycentric coordinates and in space.
    pub fn at(&self, point: &[f64; 4], x: &Point<D>) -> Point<D> {
        if self.n == 1 {
            return (x * self.sums[0] - self.origins[0]) * self.per_volume;
        }
        let mut q = Point::zeros();
        for (k, share) in point.iter().enumerate().take(self.n) {
            q += (x * self.sums[k] - self.origins[k]) * *share;
        }
        q * self.per_volume
    }
    /// The means of the squares of the norms of constants less the flux with one term, by the corners of the cell.
    pub fn mean_squares_of_differences(
        &self,
        constants: [Point<D>; 2],
        corners: &[Point<D>; 4],
    ) -> [f64; 2] {
        let d = D as f64;
        let corners = &corners[..=D];
        let middle = corners.iter().sum::<Point<D>>() / (d + 1.0);
        let squares: f64 = corners.iter().map(|x| (x - middle).norm_squared()).sum();
        let slope = self.sums[0] * self.per_volume;
        let at_middle = (middle * self.sums[0] - self.origins[0]) * self.per_volume;
        let of_slope = slope * slope * squares / ((d + 1.0) * (d + 2.0));
        map_entries(constants, |constant| (constant - at_middle).norm_squared() + of_slope)
    }
    /// What the flux leaves of a load, by the means of the load less a constant times each factor of a
    /// term, and the square of its norm.
    pub fn left_of_load(
        &self,
        volume: f64,
        means: &[f64; 4],
        square: f64,
        constant: f64,
    ) -> LeftOfLoad {
        if self.n == 1 {
            let mean = -self.sums[0] / volume - means[0] - constant;
            let rest = (square - volume * means[0] * means[0]).max(0.0);
            return LeftOfLoad { mean, values: [mean; 4], variation: 0.0, rest };
        }
        let d = D as f64;
        let sum: f64 = means.iter().sum();
        let projection = means.map(|m| (d + 1.0) * ((d + 2.0) * m - sum));
        let products: f64 = projection.iter().zip(means).take(self.n).map(|(p, m)| p * m).sum();
        let mut values = [0.0; 4];
        for k in 0..self.n {
            values[k] = -self.divergence[k] * self.per_volume - projection[k] - constant;
        }
        let mean = values.iter().sum::<f64>() / (d + 1.0);
        let squares: f64 = values[..self.n].iter().map(|v| (v - mean).powi(2)).sum();
        let variation = volume * squares / ((d + 1.0) * (d + 2.0));
        LeftOfLoad { mean, values, variation, rest: (square - volume * products).max(0.0) }
    }
}

/// The part of the load that the flux of a cell leaves.
pub(super) struct LeftOfLoad {
    /// Its mean.
    pub mean: f64,
    /// Its projection on the linear functions, at the vertices; the mean where the flux has one term.
    pub values: [f64; 4],
    /// The square of the norm of the projection less the mean.
    pub variation: f64,
    /// The square of the norm of the rest.
    pub rest: f64,
}

impl<const D: usize> Space<'_, D> {
    /// The flux of a pair in a cell.
    #[inline(always)]
    pub(super) fn flux_in(
        &self,
        pair: &PrimalDualPair<D>,
        cell: usize,
        volume: f64,
    ) -> CellFlux<D> {
        let numbers = pair.flux.of_cell(cell);
        let n = if pair.flux.degree() > 0 { D + 1 } else { 1 };
        let per_volume = 1.0 / (D as f64 * volume);
        let (mut sums, mut origins) = ([0.0; 4], [Point::<D>::zeros(); 4]);
        for (&v, numbers) in self.mesh.cell(cell).iter().zip(numbers.chunks_exact(n)) {
            let opposite = self.mesh.vertices()[v as usize];
            for (k, number) in numbers.iter().enumerate() {
                sums[k] += number;
                origins[k] += opposite * *number;
            }
        }
        let inner: f64 = (0..D + 1).map(|j| pair.flux.inner(cell, j)).sum();
        let divergence = match n {
            1 => [D as f64 * sums[0]; 4],
            _ => sums.map(|sum| (D + 1) as f64 * sum - inner),
        };
        CellFlux { n, sums, origins, per_volume, divergence }
    }
}
