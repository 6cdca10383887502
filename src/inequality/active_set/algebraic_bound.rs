//! A computed bound on the energy norm of the algebraic error of an inexact iterate.

use super::iterate::Iterate;
use super::preconditioned_solver::PreconditionedSolver;
use crate::algebra::{any_part, sum_over_parts};
use crate::inequality::Outcome;
use crate::inequality::validation::diagnose_loss_of_positivity;
use crate::linear::direct::FactorError;
use crate::linear::krylov::EIGENVALUE_TO_RITZ_VALUE;
use crate::parallel::vectors::{dot, zeros};
use crate::real::Real;

/// The threshold of strong activity divided by the estimate of the energy norm of the error.
const THRESHOLD_FACTOR: f64 = 4.0;

/// Number of thresholds tried before no unknown counts as strongly active.
const MAX_THRESHOLDS: usize = 3;

impl<T: Real> PreconditionedSolver<'_, T> {
    /// Projects the values onto their bounds and returns a bound on the energy norm of their error, divided by the
    /// energy norm of the iterate in place of that of the solution. `None` if the preconditioner cannot be set up for
    /// the unknowns on which the error may be nonzero, or rounding makes the square of the bound negative.
    ///
    /// Changes the fixed unknowns of the preconditioner, which must be set again before the next linear system.
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
    ///
    /// # Errors
    /// The outcome of [`diagnose_loss_of_positivity`] if the preconditioner finds the symmetric part of the matrix not
    /// to be positive definite on the unknowns on which the error may be nonzero.
    pub(crate) fn error_bound(
        &mut self,
        iterate: &mut Iterate<'_, T>,
    ) -> Result<Option<f64>, Outcome> {
        if iterate.project_onto_bounds() {
            iterate.compute_residual();
        }
        let sqrt_eigenvalue = (EIGENVALUE_TO_RITZ_VALUE * self.smallest_ritz_value).sqrt();
        let mut threshold = THRESHOLD_FACTOR * self.residual_norm / sqrt_eigenvalue;
        for _ in 0..MAX_THRESHOLDS {
            let Some(norm) = self.norm_of_unbalanced_residual(iterate, threshold)? else {
                return Ok(None);
            };
            let bound = norm / sqrt_eigenvalue;
            if bound <= threshold {
                return Ok(Some(bound / iterate.energy_norm));
            }
            threshold = THRESHOLD_FACTOR * bound;
        }
        let norm = self.norm_of_unbalanced_residual(iterate, f64::INFINITY)?;
        Ok(norm.map(|norm| norm / sqrt_eigenvalue / iterate.energy_norm))
    }

    /// The preconditioned norm `(r . B r)^(1/2)` of the unbalanced residual `r`, with all fixed and strongly active
    /// unknowns eliminated; see [`PreconditionedSolver::error_bound`]. `None` if the preconditioner cannot be set up
    /// for the other unknowns, or `r . B r` is negative.
    ///
    /// # Errors
    /// See [`PreconditionedSolver::error_bound`].
    fn norm_of_unbalanced_residual(
        &mut self,
        iterate: &Iterate<'_, T>,
        threshold: f64,
    ) -> Result<Option<f64>, Outcome> {
        let distribution = iterate.inequality.distribution();
        // every linear system overwrites the residual first
        self.residual.fill(T::lit(0.0));
        let mut eliminated = vec![false; iterate.values.len()];
        for (i, bound) in iterate.inequality.bounds.iter().enumerate() {
            if !iterate.inequality.owns(i) {
                eliminated[i] = true;
                continue;
            }
            let residual = iterate.residual[i];
            let multiplier = iterate.multiplier(i).unwrap_or(f64::NEG_INFINITY);
            let is_fixed = bound.fixed_value().is_some();
            if !is_fixed && multiplier < 0.0 {
                self.residual[i] = T::lit(residual);
            }
            let is_strongly_active = multiplier > threshold * iterate.diagonal[i].sqrt();
            eliminated[i] = is_fixed || is_strongly_active;
        }
        if any_part(distribution, eliminated != self.eliminated) {
            match self.preconditioner.set_fixed(&eliminated) {
                Ok(()) => self.eliminated = eliminated,
                Err(FactorError::NotPositive) => {
                    return diagnose_loss_of_positivity(iterate.inequality).map_or(Ok(None), Err);
                }
                Err(_) => return Ok(None),
            }
        }
        let mut preconditioned = zeros(self.residual.len());
        self.preconditioner.apply(&self.residual, &mut preconditioned);
        let squared = sum_over_parts(distribution, dot(&self.residual, &mut preconditioned));
        Ok((squared >= 0.0).then(|| squared.sqrt()))
    }
}
