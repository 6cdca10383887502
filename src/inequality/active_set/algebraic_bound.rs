//! A computed bound on the energy norm of the algebraic error of an inexact iterate.

use super::inexact_iterate::{InexactIterate, MAX_ITERATIONS};
use crate::algebra::{Contact, SparseMatrix};
use crate::inequality::Outcome;
use crate::linear::krylov::{ConjugateGradients, StoppingRule};
use crate::linear::precondition::AnyPreconditioner;
use crate::linear::precondition::Preconditioner;
use crate::parallel::vectors::{dot, pseudorandom_signs, zeros};
use crate::real::Real;

/// Assumed lower bound on the smallest eigenvalue over the smallest Ritz value. The Ritz value is above
/// the eigenvalue and close to it after a few iterations.
const EIGENVALUE_OVER_RITZ_VALUE: f64 = 0.9;

/// Factor between an estimate of the error and the threshold of strong activity.
const THRESHOLD_FACTOR: f64 = 4.0;

/// Number of thresholds tried before no unknown counts as strongly active.
const MAX_THRESHOLDS: usize = 3;

/// Relative tolerance of the linear system that is solved for its Ritz values alone.
const EIGENVALUE_RUN_TOL: f64 = 1e-6;

impl<T: Real> InexactIterate<'_, T> {
    /// Estimates the smallest eigenvalue of the preconditioned symmetric part of a matrix that is not
    /// symmetric, by the Ritz values of conjugate gradients; those of minimal residuals are no estimate.
    /// `None` if the preconditioner is unsuitable, another outcome than converged if the symmetric part
    /// is not positive definite.
    pub(crate) fn estimate_lowest_eigenvalue(
        &mut self,
        symmetric_part: &SparseMatrix<T>,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Option<Outcome> {
        let n = self.values.len();
        let mut load = zeros(n);
        // pseudo-random signs, so that every eigenvector has a component
        let inactive = (0..n).filter(|&i| !self.eliminated[i]);
        for (i, is_positive) in inactive.zip(pseudorandom_signs()) {
            load[i] = if is_positive { self.diagonal[i] } else { -self.diagonal[i] };
        }
        let stop = StoppingRule {
            norm: 0.0,
            reduction: EIGENVALUE_RUN_TOL,
            max_iterations: MAX_ITERATIONS,
        };
        let system = (&mut zeros(n)[..], &mut load[..]);
        let mut method = ConjugateGradients::new(symmetric_part);
        let run = method.solve(&self.eliminated, preconditioner, system, stop);
        self.linear += run.iterations;
        self.outcome_of(&run)
    }

    /// Projects the values onto their bounds and returns a bound on the energy norm of their error over
    /// that of the solution.
    ///
    /// For admissible `u` and multipliers `m` of the right sign that vanish where `u` is inactive, the
    /// energy error `e` satisfies `e . A e <= e . r <= (e . A e)^(1/2) (r . inv(S) r)^(1/2)` with
    /// `r = b + m - A u` and the symmetric part `S` of `A`. Multipliers of the wrong sign belong to `r`.
    ///
    /// `inv(S)` is the inverse on the unknowns where `e` may be nonzero. Call an active unknown strongly
    /// active if its multiplier exceeds a threshold times the root of its diagonal entry, and consider
    /// the problem in which all strongly active unknowns keep their values. If the error bound of that
    /// problem is at most the threshold, none of their multipliers changes its sign between `u` and its
    /// solution, which is therefore the solution of the inequality. Otherwise the threshold is raised,
    /// and in the end no unknown counts as strongly active.
    ///
    /// `inv(S)` is at most the preconditioner over the smallest eigenvalue of the preconditioned `S`.
    /// The eigenvalue is replaced by nine tenths of the smallest Ritz value: the only estimate.
    pub(crate) fn error_bound(
        &mut self,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Option<f64> {
        let bounds = &self.inequality.bounds;
        let mut is_changed = false;
        for (value, bound) in self.values.iter_mut().zip(bounds) {
            let nearest = bound.nearest(*value);
            is_changed |= nearest != *value;
            *value = nearest;
        }
        if is_changed {
            self.recompute_residual();
        }
        let root = (EIGENVALUE_OVER_RITZ_VALUE * self.lowest_ritz_value).sqrt();
        let mut threshold = THRESHOLD_FACTOR * self.residual_norm / root;
        for _ in 0..MAX_THRESHOLDS {
            let error = self.unexplained_norm(threshold, preconditioner)? / root;
            if error <= threshold {
                return Some(error / self.energy);
            }
            threshold = THRESHOLD_FACTOR * error;
        }
        Some(self.unexplained_norm(f64::INFINITY, preconditioner)? / root / self.energy)
    }

    /// The preconditioned norm of the part of the residual that no multiplier of the right sign balances,
    /// with all strongly active unknowns eliminated.
    fn unexplained_norm(
        &mut self,
        threshold: f64,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Option<f64> {
        let mut unexplained = self.residual.clone();
        let mut is_changed = false;
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let multiplier = match self.states[i] {
                Contact::Inactive => f64::NEG_INFINITY,
                Contact::Lower => -self.residual[i].to_f64(),
                Contact::Upper => self.residual[i].to_f64(),
            };
            let is_fixed = bound.fixed_value().is_some();
            if is_fixed || multiplier >= 0.0 {
                unexplained[i] = T::lit(0.0);
            }
            let is_strongly_active = multiplier > threshold * self.diagonal[i].to_f64().sqrt();
            let is_eliminated = is_fixed || is_strongly_active;
            is_changed |= self.eliminated[i] != is_eliminated;
            self.eliminated[i] = is_eliminated;
        }
        if is_changed {
            preconditioner.set_fixed(&self.eliminated).ok()?;
        }
        let mut z = zeros(self.values.len());
        preconditioner.apply(&unexplained, &mut z);
        Some(dot(&unexplained, &mut z).max(0.0).sqrt())
    }
}
