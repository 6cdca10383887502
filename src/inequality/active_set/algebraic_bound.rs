//! A computed bound on the energy norm of the algebraic error of an inexact iterate.

use super::inexact_iterate::{InexactIterate, MAX_ITERATIONS};
use crate::algebra::{Contact, SparseMatrix};
use crate::inequality::Outcome;
use crate::linear::krylov::{ConjugateGradients, StoppingRule};
use crate::linear::precondition::AnyPreconditioner;
use crate::linear::precondition::Preconditioner;
use crate::parallel::vectors::{dot, pseudorandom_signs, zeros};
use crate::real::Real;

/// Assumed lower bound of the ratio of the smallest eigenvalue to the smallest Ritz value. The Ritz
/// value is above the eigenvalue and close to it after a few iterations.
const EIGENVALUE_TO_RITZ_VALUE: f64 = 0.9;

/// The threshold of strong activity divided by the estimate of the error.
const THRESHOLD_FACTOR: f64 = 4.0;

/// Number of thresholds tried before no unknown counts as strongly active.
const MAX_THRESHOLDS: usize = 3;

/// Relative tolerance of the linear system that is solved for its Ritz values alone.
const EIGENVALUE_RUN_TOL: f64 = 1e-6;

impl<T: Real> InexactIterate<'_, T> {
    /// Estimates the smallest eigenvalue of the preconditioned symmetric part of a matrix that is not
    /// symmetric, by the Ritz values of conjugate gradients for that part on the inactive unknowns;
    /// stores the smallest Ritz value in `smallest_ritz_value` if it is smaller than the stored one.
    ///
    /// The Ritz values of GMRES, which solves the systems with the matrix itself, do not estimate this
    /// eigenvalue: its Krylov space belongs to the whole matrix, so that they lie above the eigenvalue
    /// but need not come close to it.
    ///
    /// Returns [`Outcome::Converged`] for a usable estimate; `None` if the preconditioner is unsuitable
    /// or the iterations do not suffice; another outcome if the symmetric part is not positive definite
    /// or a number is not finite.
    pub(crate) fn estimate_smallest_eigenvalue(
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

    /// Projects the values onto their bounds and returns a bound on the energy norm of their error
    /// divided by the energy norm of the iterate, which stands for the energy norm of the solution.
    /// `None` if the preconditioner cannot be set up for an enlarged set of unknowns.
    ///
    /// Overwrites the residual, `eliminated` and the fixed unknowns of the preconditioner: no linear
    /// system can be solved afterwards without setting them again.
    ///
    /// Notation: `u` are the projected values, `u*` is the solution, `e = u* - u` the error,
    /// `S = (A + A^T) / 2` the symmetric part of `A`, and `||e||_A = (e . A e)^(1/2)` the energy norm,
    /// which equals `(e . S e)^(1/2)`. The vector `m` equals `A u - b` on fixed unknowns and on active
    /// unknowns whose multiplier has the right sign (`m_i >= 0` at a lower bound, `m_i <= 0` at an
    /// upper one), and zero on all others. The *unbalanced residual* `r = b + m - A u` is therefore
    /// the stored residual `b - A u` with zeros on these fixed and active unknowns; multipliers of
    /// the wrong sign remain in `r`.
    ///
    /// 1. *Proven:* `||e||_A^2 <= e . r <= ||e||_A (r . inv(S) r)^(1/2)`, since `u` and `u*` are
    ///    admissible and `e . m >= 0`. Here `inv(S)` is the inverse on the unknowns where `e` may be
    ///    nonzero.
    /// 2. Fewer such unknowns give a smaller bound. Call an active unknown strongly active if its
    ///    multiplier exceeds a threshold times `sqrt(d_i)`, `d_i` its diagonal entry, and consider
    ///    the problem in which all strongly active unknowns keep their values. If the bound on the
    ///    error `e` of that problem is at most the threshold, none of their multipliers changes its
    ///    sign between `u` and its solution, which is therefore the solution of the inequality.
    ///    *Proven for a symmetric `A`*, where `|(A e)_i| <= sqrt(d_i) ||e||_A`; *assumed for any
    ///    other*, where the skew-symmetric part of `A` may change a multiplier by more. Otherwise
    ///    the threshold is raised, and in the end no unknown counts as strongly active: then
    ///    nothing is assumed here.
    /// 3. *Proven:* `inv(S) <= B / lambda_min(B S)` for the preconditioner `B` on the same unknowns.
    ///    *Estimated:* `lambda_min(B S)` by [`EIGENVALUE_TO_RITZ_VALUE`] times the smallest Ritz value.
    ///    The Ritz values come from systems on the inactive unknowns, while the bound uses all unknowns
    ///    that are neither fixed nor strongly active, a larger set with a smaller eigenvalue at most:
    ///    that the factor covers this difference too is assumed.
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
        let sqrt_eigenvalue = (EIGENVALUE_TO_RITZ_VALUE * self.smallest_ritz_value).sqrt();
        let mut threshold = THRESHOLD_FACTOR * self.residual_norm / sqrt_eigenvalue;
        for _ in 0..MAX_THRESHOLDS {
            let error = self.unbalanced_norm(threshold, preconditioner)? / sqrt_eigenvalue;
            if error <= threshold {
                return Some(error / self.energy_norm);
            }
            threshold = THRESHOLD_FACTOR * error;
        }
        let norm = self.unbalanced_norm(f64::INFINITY, preconditioner)?;
        Some(norm / sqrt_eigenvalue / self.energy_norm)
    }

    /// The preconditioned norm `(r . B r)^(1/2)` of the unbalanced residual `r`, with all fixed and
    /// strongly active unknowns eliminated; see [`InexactIterate::error_bound`]. Sets `eliminated` and
    /// the fixed unknowns of the preconditioner; `None` if it rejects them.
    fn unbalanced_norm(
        &mut self,
        threshold: f64,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Option<f64> {
        let mut unbalanced = self.residual.clone();
        let mut is_changed = false;
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let multiplier = match self.states[i] {
                Contact::Inactive => f64::NEG_INFINITY,
                Contact::Lower => -self.residual[i].to_f64(),
                Contact::Upper => self.residual[i].to_f64(),
            };
            let is_fixed = bound.fixed_value().is_some();
            if is_fixed || multiplier >= 0.0 {
                unbalanced[i] = T::lit(0.0);
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
        preconditioner.apply(&unbalanced, &mut z);
        Some(dot(&unbalanced, &mut z).max(0.0).sqrt())
    }
}
