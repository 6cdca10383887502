//! The coarsest level of a multigrid method, solved with factors on its free unknowns.

use super::level::Level;
use crate::algebra::SparseMatrix;
use crate::linear::direct::{FactorError, Factors};
use crate::linear::precondition::coarse_level::MAX_COARSEST_FACTORED;
use crate::real::Real;

/// The factors of the coarsest level on its free unknowns; without factors the level is smoothed.
pub(super) struct CoarsestSolver<T> {
    /// The free unknowns at the time of the factorisation.
    free: Vec<u32>,
    factors: Option<Factors<T>>,
    /// Workspace: right-hand side and solution on the free unknowns.
    values: Vec<T>,
    /// The divisor of the matrices of all levels.
    scale: f64,
}

impl<T: Real> CoarsestSolver<T> {
    /// The solver without factors.
    pub fn new(scale: f64) -> Self {
        Self { free: Vec::new(), factors: None, values: Vec::new(), scale }
    }

    /// Whether there are factors.
    pub fn has_factors(&self) -> bool {
        self.factors.is_some()
    }

    /// Factors the coarsest level, or updates the smoother of the level if it has more than
    /// [`MAX_COARSEST_FACTORED`] free unknowns. Factors of the same matrix on the same unknowns are kept.
    ///
    /// # Errors
    /// [`FactorError`] if the matrix is not positive definite.
    pub fn update(&mut self, level: &mut Level<'_, T>) -> Result<(), FactorError> {
        let free = (0..level.fixed.len() as u32).filter(|&i| !level.fixed[i as usize]);
        let free: Vec<u32> = free.collect();
        if free.len() > MAX_COARSEST_FACTORED {
            self.factors = None;
            return level.update_smoother(self.scale);
        }
        // The smoother is discarded, because its rows are not updated while factors are used.
        level.smoother = None;
        if self.factors.is_none() || free != self.free || !level.outdated.is_empty() {
            self.factors = None;
            self.factors = Some(factor(level, &free)?);
            self.free = free;
            level.outdated.clear();
        }
        Ok(())
    }

    /// Sets `x` to the solution with the factors on free unknowns, and to zero on fixed ones. The right-hand side is
    /// that of a level whose matrix is divided by the scale.
    pub fn solve(&mut self, right_side: &[f32], x: &mut [f32]) {
        let Some(factors) = &self.factors else { return };
        self.values.clear();
        self.values.extend(self.free.iter().map(|&i| T::lit(f64::from(right_side[i as usize]))));
        factors.solve_in_place(&mut self.values, 1);
        x.fill(0.0);
        for (&i, value) in self.free.iter().zip(&self.values) {
            x[i as usize] = (value.to_f64() * self.scale) as f32;
        }
    }
}

/// The Cholesky factor of a level on the unknowns `free`. Truncated functions can be linearly dependent; if the matrix
/// after truncation has no Cholesky factor, its diagonal is multiplied by `1 + sqrt(eps)`, `eps` machine epsilon.
///
/// # Errors
/// See [`FactorError`].
fn factor<T: Real>(level: &Level<'_, T>, free: &[u32]) -> Result<Factors<T>, FactorError> {
    match Factors::new(&level.matrix, true, free) {
        Err(FactorError::NotPositive | FactorError::Singular)
            if !level.recomputed_rows.is_empty() =>
        {
            let mut matrix = SparseMatrix::clone(&level.matrix);
            for i in 0..matrix.size() {
                let (columns, values) = matrix.row_mut(i);
                if let Ok(k) = columns.binary_search(&(i as u32)) {
                    values[k] *= T::lit(1.0 + T::EPSILON.sqrt());
                }
            }
            Factors::new(&matrix, true, free)
        }
        factors => factors,
    }
}
