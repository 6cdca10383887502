//! The point from which a run starts.

use super::InteriorIterate;
use super::bound_pairs::BoundPair;
use super::newton_system::{MixedVector, NewtonSystem};
use crate::algebra::{Bound, Inequality};
use crate::linear::direct::FactorError;
use crate::real::Real;

impl<'h, 'a, T: Real> InteriorIterate<'h, 'a, T> {
    /// The solution without bounds, slacks that are at least its largest violation of a bound, and dual variables with
    /// which all products of slack and dual variable are equal, and in the sum the energy of moving this solution onto
    /// the bounds that it violates.
    ///
    /// A body that bounds alone hold has no such solution. It starts from the solution of `(A + D) u = b + D l`, where
    /// `D` is the diagonal of `A` at unknowns with bounds and `l` the admissible value nearest to zero, with slacks that
    /// are at least the largest distance of `u` from `l`.
    ///
    /// # Errors
    /// See [`NewtonSystem::factor`].
    pub fn start(
        inequality: &'a Inequality<T>,
        system: NewtonSystem<'h, 'a, T>,
    ) -> Result<Self, FactorError> {
        let point = system.zeros();
        let pairs = BoundPair::of(inequality);
        let mut iterate = Self { inequality, system, point, pairs, systems: 1 };
        let is_held = inequality.kernel.is_empty();
        let free = vec![0.0; inequality.size()];
        let is_regular = is_held
            && match iterate.solve_with(&free) {
                Ok(()) => true,
                Err(FactorError::Singular) => false,
                Err(error) => return Err(error),
            };
        if !is_regular {
            let mut diagonal = free;
            for pair in &iterate.pairs {
                diagonal[pair.unknown] = iterate.system.diagonal_scale(pair.unknown);
            }
            iterate.solve_with(&diagonal)?;
        }
        iterate.set_pairs(is_regular);
        Ok(iterate)
    }

    /// The admissible value nearest to `x`.
    fn nearest(bound: &Bound<T>, x: f64) -> f64 {
        bound.nearest(T::lit(x)).to_f64()
    }

    /// Sets the point to the solution of `(A + D) u = b + D l` on the unknowns that are not fixed; see
    /// [`InteriorIterate::start`].
    fn solve_with(&mut self, diagonal: &[f64]) -> Result<(), FactorError> {
        let Self { inequality, system, point, .. } = self;
        let factors = system.factor(diagonal)?;
        *point = system.zeros();
        for (x, bound) in point.values.iter_mut().zip(&inequality.bounds) {
            *x = bound.fixed_value().map_or(0.0, T::to_f64);
        }
        let mut right = system.residual(point);
        for (i, bound) in inequality.bounds.iter().enumerate() {
            right.values[i] += diagonal[i] * Self::nearest(bound, 0.0);
        }
        system.solve(&factors, &mut right);
        let MixedVector { values, jump_multipliers } = right;
        point.values.iter_mut().zip(values).for_each(|(x, change)| *x += change);
        point.jump_multipliers = jump_multipliers;
        Ok(())
    }

    /// Sets slacks and dual variables from the values; `is_regular` if these are the solution without bounds.
    fn set_pairs(&mut self, is_regular: bool) {
        let Self { inequality, system, point, pairs, .. } = self;
        let bounds = inequality.bounds.iter().zip(&point.values);
        // towards the admissible values nearest to the present ones, or to zero
        let change = |(bound, &x): (&Bound<T>, &f64)| match bound.is_inequality() {
            true => Self::nearest(bound, if is_regular { x } else { 0.0 }) - x,
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
