//! The linear systems of the interior point method and of the proximal point method: `A + D` with a nonnegative diagonal
//! `D`.

use crate::algebra::{Inequality, PenalisedMatrix, SparseMatrix};
use crate::inequality::certificate::positive_diagonal;
use crate::linear::direct::{
    FactorError, Factors, MatrixFactors, StaticCondensation, SymbolicFactor, add_to_diagonal,
    symbolic_factor,
};
use crate::real::Real;

/// A vector of the mixed system: entries for the unknowns, and for the jump multipliers of a penalised matrix (else
/// empty).
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
    /// The unknowns that are not fixed, ascending.
    free: Vec<u32>,
    /// Whether an unknown is not fixed.
    is_free: Vec<bool>,
    /// The lower triangle of a symmetric assembled `A` and the symbolic analysis of its factors, which are the same for
    /// every `D`; set by the first factorisation.
    lower_triangle: Option<(SparseMatrix<T>, SymbolicFactor)>,
}

impl<'h, 'a, T: Real> NewtonSystem<'h, 'a, T> {
    /// The system of an inequality. If its matrix is penalised, jump multipliers are unknowns, and its static
    /// condensation, which must be given, solves the linear systems.
    pub fn new(
        inequality: &'a Inequality<T>,
        condensation: Option<&'h StaticCondensation<'a, T>>,
    ) -> Self {
        debug_assert_eq!(inequality.penalised.is_some(), condensation.is_some());
        let free = inequality.free_unknowns();
        let mut is_free = vec![false; inequality.size()];
        free.iter().for_each(|&i| is_free[i as usize] = true);
        Self { inequality, condensation, free, is_free, lower_triangle: None }
    }

    /// The zero vector of the mixed system.
    pub fn zeros(&self) -> MixedVector {
        let penalised = self.inequality.penalised.as_ref();
        let n_jumps = penalised.map_or(0, |penalised| penalised.n_jumps());
        MixedVector {
            values: vec![0.0; self.inequality.size()],
            jump_multipliers: vec![0.0; n_jumps],
        }
    }

    /// A positive scale for unknown `i`: the diagonal entry of the stiffness `K` without penalties
    /// where the matrix is penalised and this entry is positive, else the scale of
    /// [`positive_diagonal`].
    pub fn diagonal_scale(&self, i: usize) -> f64 {
        let stiffness = self.inequality.penalised.as_ref().map_or(0.0, |f| f.stiffness_diagonal(i));
        if stiffness > 0.0 { stiffness } else { positive_diagonal(self.inequality, i) }
    }

    /// Factors `A + D`; `diagonal` contains `D_ii` for every unknown.
    pub fn factor(&mut self, diagonal: &[f64]) -> Result<MatrixFactors<T>, FactorError> {
        if let Some(condensation) = self.condensation {
            return condensation
                .factor(&self.is_free, diagonal)
                .map(|factors| MatrixFactors::Condensed(Box::new(factors)));
        }
        let factors = if self.inequality.symmetric {
            let (triangle, analysis) = match &mut self.lower_triangle {
                Some(known) => known,
                none => {
                    let triangle = self.inequality.matrix.lower_triangle(&self.free);
                    let analysis = symbolic_factor(&triangle)?;
                    none.insert((triangle, analysis))
                }
            };
            let mut matrix = triangle.clone();
            add_to_diagonal(&mut matrix, &self.free, diagonal)?;
            Factors::cholesky(&mut matrix, analysis)?
        } else {
            let mut matrix = self.inequality.matrix.submatrix(&self.free);
            add_to_diagonal(&mut matrix, &self.free, diagonal)?;
            Factors::lu(&matrix)?
        };
        Ok(MatrixFactors::Assembled(factors))
    }

    /// [`NewtonSystem::factor`]. If the matrix is singular to working precision because the forces on a body that bounds
    /// alone hold are rounding beside its stiffness, the diagonal of `A` is added at its unknowns with bounds: the body
    /// stays where it is.
    pub fn factor_held(&mut self, diagonal: &mut [f64]) -> Result<MatrixFactors<T>, FactorError> {
        let Inequality { kernel, bounds, .. } = self.inequality;
        let bounded = |body: &'a [(u32, T)]| {
            let unknowns = body.iter().map(|&(i, _)| i as usize);
            unknowns.filter(|&i| bounds[i].is_inequality() && bounds[i].fixed_value().is_none())
        };
        let mut factors = self.factor(diagonal);
        for _ in kernel {
            if factors.as_ref().err() != Some(&FactorError::Singular) {
                break;
            }
            let share = |body: &&'a Vec<(u32, T)>| {
                bounded(body).map(|i| diagonal[i] / self.diagonal_scale(i)).fold(0.0, f64::max)
            };
            let held = kernel.iter().filter(|body| bounded(body).next().is_some());
            let Some(loosest) = held.min_by(|a, b| share(a).total_cmp(&share(b))) else { break };
            bounded(loosest).for_each(|i| diagonal[i] += self.diagonal_scale(i));
            factors = self.factor(diagonal);
        }
        factors
    }

    /// The solution without bounds, and true. A body that bounds alone hold has no such solution: then the solution of
    /// `(A + D) u = b + D l`, where `D` is the diagonal of `A` at unknowns with bounds and `l` the admissible value nearest
    /// to zero, and false.
    pub fn solve_without_bounds(&mut self) -> Result<(MixedVector, bool), FactorError> {
        let mut diagonal = vec![0.0; self.inequality.size()];
        if self.inequality.kernel.is_empty() {
            match self.solve_shifted(&diagonal) {
                Err(FactorError::Singular) => {}
                found => return found.map(|point| (point, true)),
            }
        }
        for &i in &self.free {
            let i = i as usize;
            if self.inequality.bounds[i].is_inequality() {
                diagonal[i] = self.diagonal_scale(i);
            }
        }
        self.solve_shifted(&diagonal).map(|point| (point, false))
    }

    /// The solution of `(A + D) u = b + D l` without bounds on the unknowns that are not fixed, `l` the admissible values
    /// nearest to zero.
    fn solve_shifted(&mut self, diagonal: &[f64]) -> Result<MixedVector, FactorError> {
        let factors = self.factor(diagonal)?;
        let bounds = &self.inequality.bounds;
        let mut point = self.zeros();
        for (x, bound) in point.values.iter_mut().zip(bounds) {
            *x = bound.fixed_value().map_or(0.0, T::to_f64);
        }
        let mut right = self.residual(&point);
        for (i, bound) in bounds.iter().enumerate() {
            right.values[i] += diagonal[i] * bound.nearest(T::lit(0.0)).to_f64();
        }
        self.solve(&factors, &mut right);
        let MixedVector { values, jump_multipliers } = right;
        point.values.iter_mut().zip(values).for_each(|(x, change)| *x += change);
        point.jump_multipliers = jump_multipliers;
        Ok(point)
    }

    /// Replaces a right-hand side by the solution, with zeros for fixed unknowns. `factors` must
    /// come from [`NewtonSystem::factor`] of this system.
    pub fn solve(&self, factors: &MatrixFactors<T>, right: &mut MixedVector) {
        match (factors, self.condensation) {
            (MatrixFactors::Condensed(factors), Some(condensation)) => {
                let MixedVector { values, jump_multipliers } = right;
                condensation.solve(factors, &self.is_free, values, jump_multipliers);
            }
            (MatrixFactors::Assembled(factors), _) => {
                let free = || self.free.iter().map(|&i| i as usize);
                let mut x: Vec<T> = free().map(|i| T::lit(right.values[i])).collect();
                factors.solve_in_place(&mut x, 1);
                right.values.fill(0.0);
                free().zip(x).for_each(|(i, x)| right.values[i] = x.to_f64());
            }
            (MatrixFactors::Condensed(_), None) => {
                unreachable!("condensed factors come from a condensation")
            }
        }
    }

    /// The residual `b - A u`; with jump multipliers `p`, `c - K u - M^T p` and `g - M u + p / s` in the
    /// notation of [`PenalisedMatrix`], `s` the weight of a jump.
    pub fn residual(&self, point: &MixedVector) -> MixedVector {
        let mut residual = self.zeros();
        let value = |i: usize| point.values[i];
        let Some(penalised) = &self.inequality.penalised else {
            self.inequality.residual_of(value, &mut residual.values);
            return residual;
        };
        let multiplier = |jump: usize| point.jump_multipliers[jump];
        let out = &mut residual.values;
        penalised.residual_with_jump_multipliers(&self.inequality.load, value, multiplier, out);
        for (jump, out) in residual.jump_multipliers.iter_mut().enumerate() {
            *out = penalised.jump_residual(jump, value, multiplier(jump));
        }
        residual
    }

    /// The energy `w . K w` of a change of the values by `w`, without the penalties of a penalised matrix.
    pub fn stiffness_energy(&self, w: &[f64]) -> f64 {
        let value = |i: usize| w[i];
        let image = |i: usize| match &self.inequality.penalised {
            Some(penalised) => penalised.stiffness(i, value),
            None => {
                let (columns, entries) = self.inequality.matrix.row(i);
                let terms = columns.iter().zip(entries);
                terms.map(|(&j, a)| a.to_f64() * value(j as usize)).sum()
            }
        };
        (0..w.len()).filter(|&i| w[i] != 0.0).map(|i| w[i] * image(i)).sum()
    }

    /// The energy `w . A w`; a penalty by its jumps.
    pub fn energy(&self, w: &[f64]) -> f64 {
        let jumps = |penalised: &PenalisedMatrix<T>| {
            let multipliers = penalised.weights.iter().enumerate();
            let energy = multipliers.map(|(k, s)| s.to_f64() * penalised.jump(k, |i| w[i]).powi(2));
            energy.sum::<f64>()
        };
        self.stiffness_energy(w) + self.inequality.penalised.as_ref().map_or(0.0, jumps)
    }
}
