//! The linear systems of the interior point method: `A + D` with a nonnegative diagonal `D`.

use crate::algebra::Inequality;
use crate::algebra::Submatrix;
use crate::inequality::certificate::positive_diagonal;
use crate::linear::direct::EliminationOrder;
use crate::linear::direct::{CondensedFactors, StaticCondensation};
use crate::linear::direct::{FactorError, Factors, SymbolicFactor};
use crate::real::Real;

/// A vector of the mixed system: values of the unknowns, and jump multipliers where the matrix is a
/// [`PenalisedMatrix`](crate::algebra::PenalisedMatrix) (else none).
#[derive(Clone, Debug)]
pub(crate) struct MixedVector {
    pub values: Vec<f64>,
    pub jump_multipliers: Vec<f64>,
}

/// The matrix `A` of an inequality on all unknowns that are not fixed, to which a barrier diagonal `D`
/// is added. Slack and dual variables are eliminated: `D_ii` is the sum of dual variable over slack of
/// the bounds of unknown `i`.
pub(crate) struct BarrierSystem<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    condensation: Option<&'h StaticCondensation<'a, T>>,
    free: Vec<u32>,
    is_free: Vec<bool>,
    lower_triangle: Option<LowerTriangle<T>>,
}

/// The lower triangle of a symmetric `A` and the symbolic analysis of its factors, which are the same
/// for every `D`.
struct LowerTriangle<T> {
    matrix: Submatrix<T>,
    analysis: SymbolicFactor,
}

impl<T: Real> LowerTriangle<T> {
    fn new(inequality: &Inequality<T>, free: &[u32]) -> Result<Self, FactorError> {
        let matrix = Submatrix::lower_triangle(&inequality.matrix, free);
        let order =
            EliminationOrder::for_inequality(inequality)?.restricted_to(free, inequality.size());
        let analysis = SymbolicFactor::new(&matrix, Some(order))?;
        Ok(Self { matrix, analysis })
    }
}

/// Factors of `A + D`.
pub(crate) enum BarrierFactors<T> {
    /// Of the assembled matrix.
    Assembled(Factors<T>),
    /// Of the penalised matrix by static condensation.
    Condensed(CondensedFactors<T>),
}

impl<'h, 'a, T: Real> BarrierSystem<'h, 'a, T> {
    /// The system of an inequality, solved by static condensation where one is given.
    pub fn new(
        inequality: &'a Inequality<T>,
        condensation: Option<&'h StaticCondensation<'a, T>>,
    ) -> Self {
        let free = inequality.free_unknowns();
        let mut is_free = vec![false; inequality.size()];
        free.iter().for_each(|&i| is_free[i as usize] = true);
        Self { inequality, condensation, free, is_free, lower_triangle: None }
    }

    /// The unknowns that are not fixed.
    pub fn free(&self) -> &[u32] {
        &self.free
    }

    /// The diagonal entry of an unknown as a scale: of the stiffness `K` without penalties where the
    /// matrix is penalised and the entry is positive, else of `A`.
    pub fn diagonal_scale(&self, i: usize) -> f64 {
        let stiffness = self.inequality.penalised.as_ref().map_or(0.0, |f| f.stiffness_diagonal(i));
        if stiffness > 0.0 { stiffness } else { positive_diagonal(self.inequality, i) }
    }

    /// Factors `A + D`.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(&mut self, diagonal: &[f64]) -> Result<BarrierFactors<T>, FactorError> {
        if let Some(condensation) = self.condensation {
            return condensation
                .factor_shifted(&self.is_free, diagonal)
                .map(BarrierFactors::Condensed);
        }
        let factors = if self.inequality.symmetric {
            let triangle = match &mut self.lower_triangle {
                Some(triangle) => triangle,
                none => none.insert(LowerTriangle::new(self.inequality, &self.free)?),
            };
            let mut matrix = triangle.matrix.clone();
            add_diagonal(&mut matrix, &self.free, diagonal)?;
            Factors::cholesky(&mut matrix, &triangle.analysis)?
        } else {
            let mut matrix = Submatrix::new(&self.inequality.matrix, &self.free);
            add_diagonal(&mut matrix, &self.free, diagonal)?;
            Factors::lu(&matrix)?
        };
        Ok(BarrierFactors::Assembled(factors))
    }

    /// Solves in place; fixed unknowns become zero.
    pub fn solve(&self, factors: &BarrierFactors<T>, right: &mut MixedVector) {
        match (factors, self.condensation) {
            (BarrierFactors::Condensed(factors), Some(condensation)) => {
                let MixedVector { values, jump_multipliers } = right;
                condensation.solve(factors, &self.is_free, values, jump_multipliers);
            }
            (BarrierFactors::Assembled(factors), _) => {
                let free = || self.free.iter().map(|&i| i as usize);
                let mut x: Vec<T> = free().map(|i| T::lit(right.values[i])).collect();
                factors.solve_in_place(&mut x, 1);
                right.values.fill(0.0);
                free().zip(x).for_each(|(i, x)| right.values[i] = x.to_f64());
            }
            (BarrierFactors::Condensed(_), None) => {
                unreachable!("condensed factors come from a condensation")
            }
        }
    }

    /// Computes the residual `b - A u` and, where jump multipliers `p` are unknowns, `g - M u + p / s`.
    /// Returns the energy at the point plus `sum b_i^2 / d_i`, a positive scale for complementarity.
    pub fn residual(&self, point: &MixedVector, residual: &mut MixedVector) -> f64 {
        let Inequality { load, penalised, .. } = self.inequality;
        let value = |i: usize| point.values[i];
        let (load, energy) = match penalised {
            Some(penalised) if self.condensation.is_some() => {
                let multiplier = |jump: usize| point.jump_multipliers[jump];
                penalised.residual_with_jump_multipliers(value, multiplier, &mut residual.values);
                for (jump, out) in residual.jump_multipliers.iter_mut().enumerate() {
                    *out = penalised.jump_residual(jump, value, multiplier(jump));
                }
                (&penalised.load, penalised.energy(value, multiplier))
            }
            _ => {
                self.inequality.residual_of(&value, &mut residual.values);
                let terms = point.values.iter().zip(load);
                (load, terms.map(|(x, b)| (x * b.to_f64()).abs()).sum())
            }
        };
        let loads = load.iter().enumerate();
        let of_load: f64 = loads.map(|(i, b)| b.to_f64().powi(2) / self.diagonal_scale(i)).sum();
        if energy + of_load > 0.0 { energy + of_load } else { 1.0 }
    }
}

/// Adds `D` to the diagonal; an error if a row with a positive `D_ii` stores no diagonal entry.
fn add_diagonal<T: Real>(
    matrix: &mut Submatrix<T>,
    free: &[u32],
    diagonal: &[f64],
) -> Result<(), FactorError> {
    for (k, &i) in free.iter().enumerate().filter(|(_, i)| diagonal[**i as usize] > 0.0) {
        let (columns, values) = matrix.row_mut(k);
        let position = columns.binary_search(&(k as u32)).map_err(|_| FactorError::NotPositive)?;
        values[position] += T::lit(diagonal[i as usize]);
    }
    Ok(())
}
