//! A bound on the error of an inexact iterate, and the solution made of it.

use super::active_set::inexact::{Inexact, MOST_ITERATIONS};
use super::{Outcome, Solution};
use crate::algebra::{Contact, SparseMatrix};
use crate::linear::krylov::{ConjugateGradients, StoppingRule};
use crate::linear::precondition::{AnyPreconditioner, Preconditioner};
use crate::parallel::vectors::{dot, pseudorandom_signs, zeros};
use crate::real::Real;

/// The smallest eigenvalue is taken to be at least this share of the smallest Ritz value, which lies
/// above it and has come down to it after a few iterations.
const RITZ: f64 = 0.9;

/// How many times what the error seems to be it may be for contact to be held.
const HELD: f64 = 4.0;

/// Numbers that are tried before no contact is held.
const TRIALS: usize = 3;

/// The share of an error to which a system is solved for the smallest Ritz value alone.
const SOUNDED: f64 = 1e-6;

impl<T: Real> Inexact<'_, T> {
    /// Finds the smallest eigenvalue of the preconditioned symmetric part of a matrix that is not
    /// symmetric, on which the bound on the error rests: by conjugate gradients, which come near it
    /// where minimal residuals do not. `None` if the preconditioner does not fit, another outcome if
    /// the part is not positive definite.
    pub(crate) fn sound(
        &mut self,
        part: &SparseMatrix<T>,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Option<Outcome> {
        let n = self.values.len();
        let mut force = zeros(n);
        // forces without structure, so that no direction is left out
        let free = (0..n).filter(|&i| !self.fixed[i]);
        for (i, is_positive) in free.zip(pseudorandom_signs()) {
            force[i] = if is_positive { self.diagonal[i] } else { -self.diagonal[i] };
        }
        let stop = StoppingRule { norm: 0.0, reduction: SOUNDED, max_iterations: MOST_ITERATIONS };
        let iterate = (&mut zeros(n)[..], &mut force[..]);
        let run = ConjugateGradients::new(part).solve(&self.fixed, preconditioner, iterate, stop);
        self.linear += run.iterations;
        self.judge_run(&run)
    }

    /// The solution, with a bound on its energy error if it converged.
    pub(crate) fn into_solution(
        mut self,
        outcome: Outcome,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Solution<T> {
        let is_good = outcome == Outcome::Converged;
        let bound = is_good.then(|| self.error_bound(preconditioner)).flatten();
        Solution {
            values: self.values,
            contact: self.state,
            outcome,
            outer: self.outer,
            linear: self.linear,
            linear_solver: preconditioner.name(),
            algebraic_bound: bound,
            jump_multipliers: Vec::new(),
        }
    }

    /// A bound on the energy norm of the error over that of the solution, after moving every value
    /// into its bounds.
    ///
    /// For admissible `u` and multipliers `m` of the right sign that vanish off contact, the square
    /// of the energy error `e` is `e . A e <= e . r`, `r = b + m - A u`, and so at most
    /// `r . inv(S) r`, `S` the symmetric part of `A`. Wrong multipliers go into `r`.
    ///
    /// The inverse is that on the unknowns where `e` need not vanish. Let those in contact whose
    /// multiplier exceeds a number `M` times the root of their diagonal entry be held. If the bound for
    /// the problem with these held is at most `M`, none of their multipliers changes its sign between
    /// `u` and the solution of that problem, which is then the solution. Else `M` is raised, and in the
    /// end none is held.
    ///
    /// The inverse is at most the preconditioner over the smallest eigenvalue of the preconditioned
    /// `S`. For that stands nine tenths of the smallest Ritz value met on the way: the one part that is
    /// an estimate.
    fn error_bound(&mut self, preconditioner: &mut AnyPreconditioner<'_, T>) -> Option<f64> {
        let bounds = &self.inequality.bounds;
        let mut is_moved = false;
        for (value, bound) in self.values.iter_mut().zip(bounds) {
            let nearest = bound.nearest(*value);
            is_moved |= nearest != *value;
            *value = nearest;
        }
        if is_moved {
            self.renew_residual();
        }
        let share = (RITZ * self.lowest).sqrt();
        let mut most = HELD * self.norm / share;
        for _ in 0..TRIALS {
            let error = self.norm_with(most, preconditioner)? / share;
            if error <= most {
                return Some(error / self.energy);
            }
            most = HELD * error;
        }
        Some(self.norm_with(f64::INFINITY, preconditioner)? / share / self.energy)
    }

    /// The preconditioned norm of what no multiplier explains, where those unknowns in contact are
    /// held whose multiplier exceeds a number times the root of their diagonal entry.
    fn norm_with(
        &mut self,
        held: f64,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Option<f64> {
        let mut unexplained = self.residual.clone();
        let mut is_changed = false;
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let multiplier = match self.state[i] {
                Contact::Inactive => f64::NEG_INFINITY,
                Contact::Lower => -self.residual[i].to_f64(),
                Contact::Upper => self.residual[i].to_f64(),
            };
            let is_given = bound.fixed_value().is_some();
            if is_given || multiplier >= 0.0 {
                unexplained[i] = T::lit(0.0);
            }
            let is_held = is_given || multiplier > held * self.diagonal[i].to_f64().sqrt();
            is_changed |= self.fixed[i] != is_held;
            self.fixed[i] = is_held;
        }
        if is_changed {
            preconditioner.set_fixed(&self.fixed).ok()?;
        }
        let mut z = zeros(self.values.len());
        preconditioner.apply(&unexplained, &mut z);
        Some(dot(&unexplained, &mut z).max(0.0).sqrt())
    }
}
