//! Which cells count for the solver: what the flux leaves of the load there is its error, elsewhere a force of an
//! obstacle.

use super::algebra::{CoarserCells, Unbalanced, dual_norm};
use super::terms::CellTerms;
use crate::memory::in_large_pages;
use crate::real::Real;

/// Forces away from contact below this share of the square of a bound are left as they are.
const NEGLIGIBLE: f64 = 0.01;

/// The parts of the square of a bound that depend on which cells count for the solver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    /// Those with this ratio or more.
    pub least_ratio: f64,
    /// The square of mismatch and oscillation.
    pub with_oscillation: f64,
    /// The square of the distance of the discrete function from the midpoint, with half of the oscillation.
    pub from_midpoint: f64,
    /// Twice the complementarity of obstacles.
    pub obstacle: f64,
    /// The part of the solver.
    pub algebra: f64,
    /// Whether the solver left nothing.
    pub is_balanced: bool,
}

impl Choice {
    /// The choice of all cells with this ratio or more, with the constant of [`dual_norm`].
    fn new<T: Real, const D: usize>(
        least_ratio: f64,
        terms: &[Vec<CellTerms>],
        coarser: &[CoarserCells<'_, T, D>],
        constant: f64,
    ) -> Self {
        let (mut with_oscillation, mut from_midpoint, mut obstacle) = (0.0, 0.0, 0.0);
        let of_solver = |terms: &CellTerms| {
            let volume = terms.volume;
            let is_left = terms.ratio >= least_ratio;
            with_oscillation += terms.with_oscillation[usize::from(is_left)];
            from_midpoint += terms.from_midpoint[usize::from(is_left)];
            obstacle += if is_left { 0.0 } else { terms.obstacle };
            let integral = if is_left { terms.unbalanced * volume } else { 0.0 };
            Unbalanced { integral, volume, least_coefficient: terms.least_coefficient }
        };
        let n_cells = terms.iter().map(Vec::len).sum();
        let mut unbalanced: Vec<Unbalanced> = in_large_pages(Vec::with_capacity(n_cells));
        unbalanced.extend(terms.iter().flatten().map(of_solver));
        let is_balanced = unbalanced.iter().all(|cell| cell.integral == 0.0);
        let algebra = dual_norm(unbalanced, coarser, constant);
        Self { least_ratio, with_oscillation, from_midpoint, obstacle, algebra, is_balanced }
    }

    /// That of all cells in which no obstacle presses, which needs no coarser meshes; the part of the solver is that
    /// for the constant one.
    pub fn without_obstacles(terms: &[Vec<CellTerms>]) -> Self {
        Self::new::<f64, 1>(f64::INFINITY, terms, &[], 1.0)
    }

    /// The choice with the least bound: any choice gives one. Without coarser meshes only cells count for the
    /// solver in which no obstacle presses; solves on a sequence of meshes may be inexact, so that other choices are
    /// tried there.
    pub fn best<T: Real, const D: usize>(
        cells: &[Vec<CellTerms>],
        coarser: &[CoarserCells<'_, T, D>],
        constant: f64,
    ) -> Self {
        let of_ratio = |least_ratio| Self::new(least_ratio, cells, coarser, constant);
        let mut best = of_ratio(f64::INFINITY);
        let away: f64 = cells.iter().flatten().filter(|t| t.ratio >= 1.0).map(|t| t.obstacle).sum();
        if !coarser.is_empty() && away > NEGLIGIBLE * best.square() {
            for least_ratio in [100.0, 10.0, 1.0] {
                let other = of_ratio(least_ratio);
                best = if other.square() < best.square() { other } else { best };
            }
        }
        best
    }

    /// The square of mismatch, oscillation and the part of the solver.
    pub fn flux_square(&self) -> f64 {
        (self.with_oscillation.sqrt() + self.algebra).powi(2)
    }

    /// The square of the bound without contact.
    pub fn square(&self) -> f64 {
        self.flux_square() + self.obstacle
    }

    /// The bound on the error of the discrete function, with this part of contact: the radius of the ball around the
    /// midpoint that contains the solution, and the distance of the discrete function from the midpoint.
    pub fn of_discrete(&self, contact: f64) -> f64 {
        let radius = 0.5 * (self.flux_square() + 2.0 * (self.obstacle + contact)).sqrt();
        radius + self.from_midpoint.sqrt() + 0.5 * self.algebra
    }

    /// What a cell adds to the square of the bound, without the part of the solver.
    pub fn square_of(&self, terms: &CellTerms) -> f64 {
        match terms.ratio >= self.least_ratio {
            true => terms.with_oscillation[1] + terms.contact,
            false => terms.with_oscillation[0] + terms.obstacle + terms.contact,
        }
    }
}
