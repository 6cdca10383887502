//! Linear systems with a matrix plus a nonnegative diagonal, multiplied out or factored.

use super::certificate::positive_diagonal;
use super::hybrid::{Hybrid, HybridFactors};
use super::linear::{FactorError, Factors};
use crate::algebra::Inequality;
use crate::real::Real;

/// Values, and the forces of jumps where the matrix is kept factored (else none).
#[derive(Clone)]
pub(super) struct Pair {
    pub values: Vec<f64>,
    pub forces: Vec<f64>,
}

/// The matrix of an inequality, to be shifted.
pub(super) struct Shifted<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    hybrid: Option<&'h Hybrid<'a, T>>,
    free: Vec<u32>,
    is_free: Vec<bool>,
}

/// The factors of the matrix with a shift.
pub(super) enum ShiftedFactors<T> {
    Assembled(Factors<T>),
    Hybrid(HybridFactors<T>),
}

impl<'h, 'a, T: Real> Shifted<'h, 'a, T> {
    /// The matrix on all unknowns that are not given.
    pub fn new(inequality: &'a Inequality<T>, hybrid: Option<&'h Hybrid<'a, T>>) -> Self {
        let is_free: Vec<bool> =
            inequality.bounds.iter().map(|bound| bound.only_value().is_none()).collect();
        let free = (0..is_free.len()).filter(|&i| is_free[i]).map(|i| i as u32).collect();
        Self { inequality, hybrid, free, is_free }
    }

    /// The unknowns that are not given.
    pub fn free(&self) -> &[u32] {
        &self.free
    }

    /// The stiffness of an unknown by itself: without penalties where they are kept apart.
    pub fn stiffness(&self, i: usize) -> f64 {
        let own = self.inequality.factored.as_ref().map_or(0.0, |f| f.diagonal(i));
        if own > 0.0 { own } else { positive_diagonal(self.inequality, i) }
    }

    /// Factors of the matrix plus a diagonal.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(&self, shift: &[f64]) -> Result<ShiftedFactors<T>, FactorError> {
        if let Some(hybrid) = self.hybrid {
            return hybrid.factor_shifted(&self.is_free, shift).map(ShiftedFactors::Hybrid);
        }
        let mut matrix = self.inequality.matrix.clone();
        for &i in &self.free {
            let i = i as usize;
            let start = matrix.row_starts[i] as usize;
            if shift[i] > 0.0 {
                let place = matrix.row(i).0.binary_search(&(i as u32));
                let place = place.map_err(|_| FactorError::NotPositive)?;
                matrix.values[start + place] += T::lit(shift[i]);
            }
        }
        let factors = Factors::new(&matrix, self.inequality.symmetric, &self.free)?;
        Ok(ShiftedFactors::Assembled(factors))
    }

    /// Solves in place; zero where unknowns are given.
    pub fn solve(&self, factors: &ShiftedFactors<T>, right: &mut Pair) {
        match (factors, self.hybrid) {
            (ShiftedFactors::Hybrid(factors), Some(hybrid)) => {
                hybrid.solve(factors, &self.is_free, &mut right.values, &mut right.forces);
            }
            (ShiftedFactors::Assembled(factors), _) => {
                let free = || self.free.iter().map(|&i| i as usize);
                let mut x: Vec<T> = free().map(|i| T::lit(right.values[i])).collect();
                factors.solve_in_place(&mut x, 1);
                right.values.fill(0.0);
                free().zip(x).for_each(|(i, x)| right.values[i] = x.to_f64());
            }
            (ShiftedFactors::Hybrid(_), None) => unreachable!("made by this matrix"),
        }
    }

    /// What is missing to `A u = b` at `at`: `b - A u`, and by how much jumps and forces disagree.
    /// Returns the size of energies there.
    pub fn deficit(&self, at: &Pair, out: &mut Pair) -> f64 {
        let Inequality { load, factored, .. } = self.inequality;
        let value = |i: usize| at.values[i];
        let (load, energy) = match factored {
            Some(factored) if self.hybrid.is_some() => {
                let force = |jump: usize| at.forces[jump];
                factored.residual_with_forces(value, force, &mut out.values);
                for (jump, out) in out.forces.iter_mut().enumerate() {
                    *out = factored.mismatch(jump, value, at.forces[jump]);
                }
                (&factored.load, factored.energy(value, force))
            }
            _ => {
                self.inequality.residual_of(&value, &mut out.values);
                let terms = at.values.iter().zip(load);
                (load, terms.map(|(x, b)| (x * b.to_f64()).abs()).sum())
            }
        };
        let loads = load.iter().enumerate();
        let own: f64 = loads.map(|(i, b)| b.to_f64().powi(2) / self.stiffness(i)).sum();
        if energy + own > 0.0 { energy + own } else { 1.0 }
    }
}
