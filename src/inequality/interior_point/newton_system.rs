//! The linear systems of the interior point method: `A + D` with a nonnegative diagonal `D`.

use crate::algebra::{Inequality, PenalisedMatrix, Submatrix};
use crate::inequality::certificate::positive_diagonal;
use crate::linear::direct::{CondensedFactors, StaticCondensation};
use crate::linear::direct::{FactorError, Factors, SymbolicFactor};
use crate::real::Real;

/// A vector of the mixed system: entries for the unknowns, and for the jump multipliers if these are unknowns of the
/// system (else empty). The values of a point are differences from the reference of the [`NewtonSystem`].
#[derive(Clone, Debug)]
pub(crate) struct MixedVector {
    pub values: Vec<f64>,
    pub jump_multipliers: Vec<f64>,
}

/// The matrix `A` of an inequality on all unknowns that are not fixed, to which a nonnegative
/// diagonal `D` is added for each Newton step. Slacks and dual variables are eliminated: `D_ii` is
/// the sum, over the bounds of unknown `i`, of the dual variable divided by the slack.
pub(crate) struct NewtonSystem<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    condensation: Option<&'h StaticCondensation<'a, T>>,
    /// The values that are subtracted from those of a point; zeros before [`NewtonSystem::with_reference`].
    reference: Vec<f64>,
    /// `K` times the reference; empty before [`NewtonSystem::with_reference`].
    reference_stiffness: Vec<f64>,
    /// `g - M u` for the reference `u`; empty if jump multipliers are no unknowns.
    reference_data: Vec<f64>,
    /// The unknowns that are not fixed, ascending.
    free: Vec<u32>,
    /// Whether an unknown is not fixed.
    is_free: Vec<bool>,
    /// Set by the first factorisation of a symmetric assembled matrix.
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
        let analysis = SymbolicFactor::new(&matrix, None)?;
        Ok(Self { matrix, analysis })
    }
}

/// Factors of `A + D`.
pub(crate) enum NewtonFactors<T> {
    /// Factors of the assembled matrix.
    Assembled(Factors<T>),
    /// Factors of the penalised matrix by static condensation.
    Condensed(Box<CondensedFactors<T>>),
}

impl<'h, 'a, T: Real> NewtonSystem<'h, 'a, T> {
    /// The system of an inequality. If a static condensation of the penalised matrix of the inequality is given, jump
    /// multipliers are unknowns, and the condensation solves the linear systems.
    pub fn new(
        inequality: &'a Inequality<T>,
        condensation: Option<&'h StaticCondensation<'a, T>>,
    ) -> Self {
        let free = inequality.free_unknowns();
        let mut is_free = vec![false; inequality.size()];
        free.iter().for_each(|&i| is_free[i as usize] = true);
        let penalised = inequality.penalised.as_ref().filter(|_| condensation.is_some());
        let data = penalised.map(|p| p.jump_data.iter().map(|g| g.to_f64()).collect());
        Self {
            inequality,
            condensation,
            reference: vec![0.0; inequality.size()],
            reference_stiffness: Vec::new(),
            reference_data: data.unwrap_or_default(),
            free,
            is_free,
            lower_triangle: None,
        }
    }

    /// Sets the reference; no change if jump multipliers are no unknowns.
    ///
    /// A slack that is inversely proportional to a large penalty is far below the rounding of the value. If the
    /// reference consists of bounds, the values of a point are slacks, and jumps of slacks are as accurate as the
    /// slacks.
    #[must_use]
    pub fn with_reference(mut self, reference: Vec<f64>) -> Self {
        let Some(penalised) = self.penalised() else { return self };
        let value = |i: usize| reference[i];
        let stiffness = (0..reference.len()).map(|i| penalised.stiffness(i, value)).collect();
        let data = |jump| penalised.jump_residual(jump, value, 0.0);
        let data = (0..penalised.n_jumps()).map(data).collect();
        (self.reference_stiffness, self.reference_data) = (stiffness, data);
        self.reference = reference;
        self
    }

    /// The reference value of unknown `i`.
    pub fn reference(&self, i: usize) -> f64 {
        self.reference[i]
    }

    /// The penalised matrix, if jump multipliers are unknowns.
    fn penalised(&self) -> Option<&'a PenalisedMatrix<T>> {
        self.inequality.penalised.as_ref().filter(|_| self.condensation.is_some())
    }

    /// See [`StaticCondensation::has_null_directions`]; false without a condensation.
    pub fn has_null_directions(&self) -> bool {
        self.condensation.is_some_and(|c| c.has_null_directions())
    }

    /// The unknowns that are not fixed.
    pub fn free(&self) -> &[u32] {
        &self.free
    }

    /// A positive scale for unknown `i`: the diagonal entry of the stiffness `K` without penalties
    /// where the matrix is penalised and this entry is positive, else the scale of
    /// [`positive_diagonal`].
    pub fn diagonal_scale(&self, i: usize) -> f64 {
        let stiffness = self.inequality.penalised.as_ref().map_or(0.0, |f| f.stiffness_diagonal(i));
        if stiffness > 0.0 { stiffness } else { positive_diagonal(self.inequality, i) }
    }

    /// Factors `A + D`; `diagonal` contains `D_ii` for every unknown.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(&mut self, diagonal: &[f64]) -> Result<NewtonFactors<T>, FactorError> {
        if let Some(condensation) = self.condensation {
            return condensation
                .factor_shifted(&self.is_free, diagonal)
                .map(|factors| NewtonFactors::Condensed(Box::new(factors)));
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
        Ok(NewtonFactors::Assembled(factors))
    }

    /// Replaces a right-hand side by the solution, with zeros for fixed unknowns. `factors` must
    /// come from [`NewtonSystem::factor`] of this system.
    pub fn solve(&self, factors: &NewtonFactors<T>, right: &mut MixedVector) {
        match (factors, self.condensation) {
            (NewtonFactors::Condensed(factors), Some(condensation)) => {
                let MixedVector { values, jump_multipliers } = right;
                condensation.solve(factors, &self.is_free, values, jump_multipliers);
            }
            (NewtonFactors::Assembled(factors), _) => {
                let free = || self.free.iter().map(|&i| i as usize);
                let mut x: Vec<T> = free().map(|i| T::lit(right.values[i])).collect();
                factors.solve_in_place(&mut x, 1);
                right.values.fill(0.0);
                free().zip(x).for_each(|(i, x)| right.values[i] = x.to_f64());
            }
            (NewtonFactors::Condensed(_), None) => {
                unreachable!("condensed factors come from a condensation")
            }
        }
    }

    /// Computes the residual `b - A u`; if jump multipliers `p` are unknowns, `c - K u - M^T p` and `g - M u + p / s`
    /// in the notation of [`PenalisedMatrix`], `s` the weight of a jump.
    ///
    /// Returns a positive energy scale for the sum of all complementarity products: `sum |u_i b_i| + sum b_i^2 / d_i`
    /// with the diagonal scales `d`; if jump multipliers are unknowns, `sum c_i^2 / d_i` plus
    /// [`PenalisedMatrix::energy`]; one if all terms are zero.
    pub fn residual(&self, point: &MixedVector, residual: &mut MixedVector) -> f64 {
        let load = &self.inequality.load;
        let value = |i: usize| point.values[i];
        let energy = match self.penalised() {
            Some(penalised) => {
                let multiplier = |jump: usize| point.jump_multipliers[jump];
                let out = &mut residual.values;
                penalised.residual_with_jump_multipliers(load, value, multiplier, out);
                for (r, stiffness) in residual.values.iter_mut().zip(&self.reference_stiffness) {
                    *r -= stiffness;
                }
                for (jump, out) in residual.jump_multipliers.iter_mut().enumerate() {
                    let weight = penalised.weights[jump].to_f64();
                    let data = self.reference_data[jump] - penalised.jump(jump, value);
                    *out = data + multiplier(jump) / weight;
                }
                let value = |i: usize| self.reference[i] + point.values[i];
                penalised.energy(load, value, multiplier)
            }
            None => {
                self.inequality.residual_of(&value, &mut residual.values);
                let terms = point.values.iter().zip(load);
                terms.map(|(x, b)| (x * b.to_f64()).abs()).sum()
            }
        };
        let loads = load.iter().enumerate();
        let of_load: f64 = loads.map(|(i, b)| b.to_f64().powi(2) / self.diagonal_scale(i)).sum();
        // a scale that is not a number is returned as such
        if energy + of_load <= 0.0 { 1.0 } else { energy + of_load }
    }
}

/// Adds `D` to the diagonal of the submatrix on the unknowns `free`.
///
/// # Errors
/// [`FactorError::NotPositive`] if a row with a positive `D_ii` stores no diagonal entry.
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
