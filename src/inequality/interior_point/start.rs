//! The point from which a run starts.

use super::InteriorIterate;
use super::bound_pairs::BoundPair;
use super::newton_system::NewtonSystem;
use crate::algebra::{Bound, Inequality};
use crate::linear::direct::FactorError;
use crate::real::Real;

impl<'h, 'a, T: Real> InteriorIterate<'h, 'a, T> {
    /// The solution without bounds, slacks that are at least its largest violation of a bound, and dual variables with
    /// which all products of slack and dual variable are equal, and in the sum the energy of moving this solution onto
    /// the bounds that it violates.
    ///
    /// A body that bounds alone hold starts from the shifted solution of [`NewtonSystem::solve_without_bounds`], with
    /// slacks that are at least its largest distance from the admissible value nearest to zero.
    pub fn start(
        inequality: &'a Inequality<T>,
        mut system: NewtonSystem<'h, 'a, T>,
    ) -> Result<Self, FactorError> {
        let (point, is_regular) = system.solve_without_bounds()?;
        let pairs = BoundPair::of(inequality);
        let mut iterate = Self { inequality, system, point, pairs, systems: 1, best: None };
        iterate.set_pairs(is_regular);
        Ok(iterate)
    }

    /// Sets slacks and dual variables from the values; `is_regular` if these are the solution without bounds.
    fn set_pairs(&mut self, is_regular: bool) {
        let Self { inequality, system, point, pairs, .. } = self;
        let bounds = inequality.bounds.iter().zip(&point.values);
        // towards the admissible values nearest to the present ones, or to zero
        let change = |(bound, &x): (&Bound<T>, &f64)| match bound.is_inequality() {
            true => bound.nearest(T::lit(if is_regular { x } else { 0.0 })).to_f64() - x,
            false => 0.0,
        };
        let change: Vec<f64> = bounds.map(change).collect();
        let least = change.iter().fold(0.0_f64, |largest, change| largest.max(change.abs()));
        let sum = match is_regular {
            true => system.stiffness_energy(&change),
            false => pairs.iter().map(|p| system.diagonal_scale(p.unknown) * least * least).sum(),
        };
        let product = sum / pairs.len().max(1) as f64;
        for pair in pairs {
            pair.slack = pair.gap(point.values[pair.unknown]).max(least);
            pair.dual = product / pair.slack;
        }
    }
}
