//! The size of rounding errors in the figures of a solution, below which a figure says nothing.

use super::errors::Errors;
use crate::algebra::Inequality;
use crate::assemble::Discretisation;
use crate::inequality::{Solution, positive_diagonal, stiffness_diagonal};
use crate::parallel::vectors::map_chunks;
use crate::real::maximum;

/// Rounding errors of a solve in the energy norm, in units of machine epsilon, where the discrete space contains the
/// solution: up to five times less is observed.
const ROUNDINGS: f64 = 8.0;
/// What each cell along a line adds to them, and each cell in one direction for quadratics.
const PER_CELL: f64 = 0.25;

/// What each cell in one direction adds to those of discontinuous quadratics but in the energy norm: rounding of the
/// penalty, of the same sign in all cells, does not cancel in smooth functions. Up to 0.6 of it is observed.
const OF_PENALTY: f64 = 1.0 / 6.0;

/// Rounding errors in the figures of a solution: a figure that is no larger is noise, and has no order.
///
/// Let `n` be the number of cells to the power `1/D`, `L` the diameter of the domain, `c` the load without Dirichlet
/// data, `k` the diagonal of the matrix without an over-penalty, and `U` the largest value: of the `|u_i|`, or that of
/// the load, `n^2 (sum c_i^2 / k_i) / sum |c_i|`, where values vanish but for rounding; plus the rounding of the constants
/// of bodies, in double precision, over machine epsilon. A solve amplifies machine epsilon by `a`: 8, on a line and for
/// quadratics `8 + n/4`. For discontinuous quadratics the maximum, L2, H1 and forces have the factor `1 + n/6` besides.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Rounding {
    /// In errors of the solution: `a eps U (sum k_i)^(1/2)` in the broken energy norm; in the norm of the scheme
    /// `eps U (sum d_i)^(1/2) / 4` besides, `d` the diagonal of the matrix, because jumps of rounded values are rounded
    /// once; `a eps n U / 16` in the maximum, `L^(D/2)` times that in L2, `16 / L` times that again in H1.
    pub error: Errors,
    /// In energies: `a eps (E^2 + U sum |c_i|)`, `E` the energy norm of the solution.
    pub energy: f64,
    /// In contact forces, whose rounding errors have random signs: `a eps (U (sum k_i^2)^(1/2) + sum |c_i|) / 8`.
    pub force: f64,
}

impl<const D: usize> Discretisation<'_, D> {
    /// Rounding errors in the figures of a solution of this energy norm, on a mesh of so many cells; none where they are
    /// not finite. All parts of a mesh call it.
    pub(crate) fn rounding(
        &self,
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
        (cells, energy_norm): (usize, f64),
    ) -> Option<Rounding> {
        let (u, epsilon) = (&solution.values, solution.precision.epsilon());
        let mut load = inequality.load.clone();
        for term in inequality.dirichlet_energy.iter().flat_map(|data| &data.terms) {
            load[term.unknown as usize] -= term.load;
        }
        let chunks = map_chunks(u.len(), |range| {
            let (mut largest, mut sums) = (0.0, [0.0; 5]);
            for i in range.filter(|&i| inequality.owns(i)) {
                let d = positive_diagonal(inequality, i);
                let k = stiffness_diagonal(inequality, i);
                largest = maximum(largest, u[i].abs());
                let terms = [d, k, k * k, load[i].abs(), load[i] * load[i] / k];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
            (largest, sums)
        });
        let (mut largest, mut sums) = ([0.0], [0.0; 5]);
        for (of_chunk, terms) in chunks {
            largest[0] = maximum(largest[0], of_chunk);
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        inequality.distribution().largest(&mut largest);
        inequality.distribution().sum(&mut sums);
        let [diagonal, stiffness, squares, force, load_energy] = sums;
        let dimension = D as f64;
        let (n, length) = ((cells as f64).powf(dimension.recip()), self.mesh().domain_diameter());
        let of_load = if force > 0.0 { n * n * load_energy / force } else { 0.0 };
        // values from which constants were taken have the rounding of these, in double precision
        let of_constants = self.space.body_constants.rounding() / epsilon;
        let value = maximum(largest[0], of_load) + of_constants;
        let per_cell = if D == 1 || self.space.degree > 1 { PER_CELL } else { 0.0 };
        let one = (ROUNDINGS + per_cell * n) * epsilon;
        let has_penalty = self.space.broken && self.space.degree > 1;
        let smooth = if has_penalty { 1.0 + OF_PENALTY * n } else { 1.0 };
        let max = smooth * one * n * value / 16.0;
        let l2 = max * length.powf(0.5 * dimension);
        let error = Errors {
            l2: Some(l2),
            h1: Some(16.0 * l2 / length),
            energy: Some(value * (one * stiffness.sqrt() + 0.25 * epsilon * diagonal.sqrt())),
            broken_energy: Some(one * value * stiffness.sqrt()),
            max: Some(max),
            ..Errors::default()
        };
        let energy = one * (energy_norm * energy_norm + value * force);
        let force = smooth * one * (value * squares.sqrt() + force) / 8.0;
        let is_finite = [l2 / length, energy, force, diagonal].iter().all(|x| x.is_finite());
        is_finite.then_some(Rounding { error, energy, force })
    }
}
