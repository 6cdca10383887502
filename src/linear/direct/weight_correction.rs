//! Solutions with the true weights by factors with reduced ones.
//!
//! With the inverse `N` of the stiffness on the free unknowns the jump multipliers of
//! `K u + M^T p = r`, `M u - S^-1 p = t` satisfy `F p = M N r - t`, `F = S^-1 + M N M^T`. Weights that are reduced by
//! a factor `c` give `F' = c S^-1 + M N M^T`. On multipliers that do work on free unknowns `M N M^T` exceeds `c S^-1`
//! by far, on all others, those with `M^T p = 0` on the free unknowns, `M N M^T` is zero. All eigenvalues of `F'^-1 F`
//! are therefore close to one or equal to `1/c`, unless a positive diagonal is added to `K`, which spreads them
//! between these values. Conjugate gradients for `F`, preconditioned by `F'`, end after a few steps. Every iterate
//! satisfies the first equation, with that diagonal where the factors have it.

use super::static_condensation::{CondensedFactors, StaticCondensation};
use crate::real::Real;

/// Largest number of steps.
const MAX_STEPS: usize = 12;

/// Relative tolerance of jump multipliers in the norm of `F`; machine epsilon in scalars with fewer digits.
const TOLERANCE: f64 = 1e-12;

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).fold(0.0, |s, (x, y)| s + x * y)
}

/// Adds `factor * y` to `x`.
fn axpy(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x += factor * y);
}

/// Replaces `x` by `y + factor * x`.
fn xpby(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x = y + factor * *x);
}

impl<T: Real> StaticCondensation<'_, T> {
    /// Solves `K u + M^T p = r` on the free unknowns and `M u - S^-1 p = t`. Replaces `r` by `u`, which
    /// is zero on fixed unknowns, and `t` by the jump multipliers `p`. Returns the energy
    /// `u.K u + p.(S^-1 p) = u.r - p.t`.
    pub fn solve(
        &self,
        factors: &CondensedFactors<T>,
        is_free: &[bool],
        r: &mut [f64],
        t: &mut [f64],
    ) -> f64 {
        if factors.weight_divisor == 1.0 {
            return self.solve_reduced(factors, is_free, r, t);
        }
        let (load, data) = (r.to_vec(), t.to_vec());
        self.solve_reduced(factors, is_free, r, t);
        self.correct_weights(factors, is_free, r, t);
        dot(r, &load) - dot(t, &data)
    }

    /// Replaces the solution `u`, `p` with reduced weights by the solution with the true weights. The error that is left after
    /// [`MAX_STEPS`] steps, or where a step is not finite, is part of the residual from which the caller computes its
    /// next correction; the caller stops by the energy of its corrections.
    fn correct_weights(
        &self,
        factors: &CondensedFactors<T>,
        is_free: &[bool],
        u: &mut [f64],
        p: &mut [f64],
    ) {
        let weight = |k: usize| self.penalised.weights[k].to_f64();
        // the residual `M u - S^-1 p - t`: with the reduced weights `M u - c S^-1 p - t` is zero
        let excess = |(k, p): (usize, &f64)| (factors.weight_divisor - 1.0) * p / weight(k);
        let mut residual: Vec<f64> = p.iter().enumerate().map(excess).collect();
        let mut image = vec![0.0; p.len()];
        // the preconditioned residual, as values and as jump multipliers
        let (mut z_u, mut z_p) = (vec![0.0; u.len()], vec![0.0; p.len()]);
        let (mut direction_u, mut direction_p) = (z_u.clone(), z_p.clone());
        let mut last = f64::INFINITY;
        let tolerance = TOLERANCE.max(T::EPSILON).powi(2) / factors.weight_divisor;
        for _ in 0..MAX_STEPS {
            z_u.fill(0.0);
            z_p.iter_mut().zip(&residual).for_each(|(y, r)| *y = -r);
            self.solve_reduced(factors, is_free, &mut z_u, &mut z_p);
            let product = dot(&residual, &z_p);
            let jump_energy: f64 = p.iter().enumerate().map(|(k, p)| p * p / weight(k)).sum();
            // false for NaN
            let is_large = product > tolerance * jump_energy;
            if !is_large {
                break;
            }
            xpby(&mut direction_u, product / last, &z_u);
            xpby(&mut direction_p, product / last, &z_p);
            for (k, out) in image.iter_mut().enumerate() {
                *out = direction_p[k] / weight(k) - self.penalised.jump(k, |i| direction_u[i]);
            }
            let length = product / dot(&direction_p, &image);
            if !(length > 0.0 && length.is_finite()) {
                break;
            }
            axpy(u, length, &direction_u);
            axpy(p, length, &direction_p);
            axpy(&mut residual, -length, &image);
            last = product;
        }
    }
}
