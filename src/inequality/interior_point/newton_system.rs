//! The linear systems of the interior point method and of the proximal point method: `A + D` with a nonnegative diagonal
//! `D`.

use crate::algebra::Inequality;
use crate::inequality::certificate::{positive_diagonal, stiffness_diagonal};
use crate::linear::direct::{
    DirectSystem, FactorError, MixedVector, SymbolicFactor, SystemFactors,
};
use crate::real::Real;

/// The matrix `A` of an inequality on all unknowns that are not fixed, to which a nonnegative
/// diagonal `D` is added for each Newton step. Slacks and dual variables are eliminated: `D_ii` is
/// the sum, over the bounds of unknown `i`, of the dual variable divided by the slack.
pub(crate) struct NewtonSystem<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    system: &'h DirectSystem<'a, T>,
    /// Whether an unknown is not fixed.
    is_free: Vec<bool>,
    /// The symbolic analysis of the factors of a symmetric assembled `A`, the same for every `D`.
    symbolic: Option<SymbolicFactor>,
}

impl<'h, 'a, T: Real> NewtonSystem<'h, 'a, T> {
    /// The system of an inequality, by its matrix for solves with factors.
    pub fn new(inequality: &'a Inequality<T>, system: &'h DirectSystem<'a, T>) -> Self {
        let is_free = inequality.bounds.iter().map(|bound| bound.fixed_value().is_none()).collect();
        Self { inequality, system, is_free, symbolic: None }
    }

    /// A positive scale for unknown `i`: the diagonal entry of the stiffness `K` without penalties where it is positive,
    /// else the scale of [`positive_diagonal`].
    pub fn diagonal_scale(&self, i: usize) -> f64 {
        let stiffness = stiffness_diagonal(self.inequality, i);
        if stiffness > 0.0 { stiffness } else { positive_diagonal(self.inequality, i) }
    }

    /// Factors `A + D`; `diagonal` contains `D_ii` for every unknown.
    pub fn factor(&mut self, diagonal: &[f64]) -> Result<SystemFactors<T>, FactorError> {
        self.system.factor(&self.is_free, diagonal, &mut self.symbolic)
    }

    /// [`NewtonSystem::factor`]. If the matrix is singular to working precision because the forces on a body that bounds
    /// alone hold are rounding beside its stiffness, the diagonal of `A` is added at its unknowns with bounds: the body
    /// stays where it is.
    pub fn factor_held(&mut self, diagonal: &mut [f64]) -> Result<SystemFactors<T>, FactorError> {
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
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            if self.is_free[i] && bound.is_inequality() {
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
        let values = bounds.iter().map(|bound| bound.fixed_value().map_or(0.0, T::to_f64));
        let jump_multipliers = vec![0.0; self.system.n_jumps()];
        let mut point = MixedVector { values: values.collect(), jump_multipliers };
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
    pub fn solve(&self, factors: &SystemFactors<T>, right: &mut MixedVector) {
        self.system.solve(factors, &self.is_free, right);
    }

    /// The residual `b - A u`, with jump multipliers that of both equations: [`DirectSystem::residual`].
    pub fn residual(&self, point: &MixedVector) -> MixedVector {
        self.system.residual(|i| point.values[i], |jump| point.jump_multipliers[jump])
    }

    /// The energy `w . K w` of a change of the values by `w`, without the penalties of a penalised matrix.
    pub fn stiffness_energy(&self, w: &[f64]) -> f64 {
        let moved = (0..w.len()).filter(|&i| w[i] != 0.0);
        moved.map(|i| w[i] * self.system.stiffness(i, |j| w[j])).sum()
    }

    /// The energy `w . A w`; a penalty by its jumps.
    pub fn energy(&self, w: &[f64]) -> f64 {
        let penalty = self.inequality.penalised.as_ref().map_or(0.0, |penalised| {
            let weights = penalised.weights.iter().enumerate();
            weights.map(|(k, s)| s.to_f64() * penalised.jump(k, |i| w[i]).powi(2)).sum()
        });
        self.stiffness_energy(w) + penalty
    }
}
