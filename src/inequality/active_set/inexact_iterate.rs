//! The iterate of the inexact active set method: values, contact states, residual.

use super::contact_state::{prescribed_value, starting_states};
use super::state_history::{fingerprint, state_key};
use crate::algebra::{Contact, Inequality};
use crate::inequality::Outcome;
use crate::inequality::initial_guess::InitialGuess;
use crate::linear::krylov::KrylovMethod;
use crate::linear::krylov::{KrylovRun, StopReason, StoppingRule};
use crate::linear::precondition::Preconditioner;
use crate::parallel::vectors::{for_each_chunk, zeros};
use crate::real::Real;

/// Estimated condition number of the preconditioned matrix (largest Ritz value divided by the
/// smallest) above which the preconditioner counts as unsuitable: the preconditioned norm of a
/// residual is then no measure of the error, and factors are better.
const MAX_CONDITION: f64 = 1e4;

/// Largest number of iterations for one linear system.
pub(crate) const MAX_ITERATIONS: usize = 500;

/// The values and contact states of a step of the active set method, and the history of the run.
pub(crate) struct InexactIterate<'a, T> {
    pub inequality: &'a Inequality<T>,
    pub values: Vec<T>,
    pub states: Vec<Contact>,
    /// Whether an unknown is eliminated from the linear system: fixed or active.
    pub eliminated: Vec<bool>,
    /// The diagonal of the matrix.
    pub diagonal: Vec<T>,
    /// `b - A u`; zero on eliminated unknowns while a linear system is solved.
    pub residual: Vec<T>,
    /// The fingerprint of the current active set; see [`fingerprint`].
    fingerprint: u128,
    /// The fingerprints of all active sets that have occurred.
    seen: Vec<u128>,
    /// Number of linear systems with a new active set.
    pub outer: usize,
    /// Number of iterations of the linear solver.
    pub linear: usize,
    /// Smallest Ritz value of all linear systems so far, at most one.
    pub smallest_ritz_value: f64,
    /// Energy norm of the iterate at its last evaluation; see
    /// [`KktEvaluation`](super::kkt_evaluation::KktEvaluation).
    pub energy_norm: f64,
    /// Preconditioned norm of the residual at the end of the last linear system.
    pub residual_norm: f64,
}

impl<'a, T: Real> InexactIterate<'a, T> {
    /// The values of the guess projected onto the bounds, with the contact states of the inequality's
    /// start.
    pub fn new(inequality: &'a Inequality<T>, guess: &InitialGuess<T>) -> Self {
        let Inequality { bounds, matrix, start, .. } = inequality;
        let n = inequality.size();
        let states = starting_states(bounds, start);
        let guess = guess.values.as_deref().filter(|values| values.len() == n);
        let values =
            (0..n).map(|i| bounds[i].nearest(guess.map_or(T::lit(0.0), |v| v[i]))).collect();
        let fingerprint = fingerprint(&states);
        let mut iterate = Self {
            inequality,
            values,
            states,
            eliminated: vec![false; n],
            diagonal: matrix.diagonal(),
            residual: zeros(n),
            fingerprint,
            seen: vec![fingerprint],
            outer: 0,
            linear: 0,
            smallest_ritz_value: 1.0,
            energy_norm: 1.0,
            residual_norm: f64::INFINITY,
        };
        iterate.set_prescribed_values();
        iterate
    }

    /// Sets every fixed or active unknown to its prescribed value and marks it as eliminated.
    fn set_prescribed_values(&mut self) {
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let prescribed = prescribed_value(bound, self.states[i]);
            self.eliminated[i] = prescribed.is_some();
            if let Some(value) = prescribed {
                self.values[i] = value;
            }
        }
    }

    /// Corrects the values by one linear system on the inactive unknowns. Sets the residual to zero on
    /// eliminated unknowns, and adds to `linear`.
    pub fn solve_linear(
        &mut self,
        krylov: &mut KrylovMethod<'_, T>,
        preconditioner: &mut dyn Preconditioner<T>,
        stop: StoppingRule,
    ) -> KrylovRun {
        let eliminated = &self.eliminated;
        for_each_chunk(&mut self.residual, |range, r| {
            for (r, &eliminated) in r.iter_mut().zip(&eliminated[range]) {
                if eliminated {
                    *r = T::lit(0.0);
                }
            }
        });
        let iterate = (&mut self.values[..], &mut self.residual[..]);
        let run = krylov.solve(&self.eliminated, preconditioner, iterate, stop);
        self.linear += run.iterations;
        run
    }

    /// Updates `smallest_ritz_value` by a run of a Krylov method and returns the outcome of the run;
    /// `None` if the preconditioner is unsuitable or the iterations did not suffice.
    pub fn outcome_of(&mut self, run: &KrylovRun) -> Option<Outcome> {
        let is_symmetric = self.inequality.symmetric;
        let (low, high) = run.ritz.unwrap_or((1.0, 1.0));
        self.smallest_ritz_value = self.smallest_ritz_value.min(low);
        match run.reason {
            // the driver confirms by factors
            StopReason::NotPositive if !is_symmetric => Some(Outcome::NotCoercive),
            _ if high > MAX_CONDITION * low => None,
            StopReason::Converged => Some(Outcome::Converged),
            StopReason::NotPositive => Some(Outcome::NotCoercive),
            StopReason::NotFinite => Some(Outcome::NotFinite),
            StopReason::IterationLimit => None,
        }
    }

    /// Records the active set that follows from state changes, before [`InexactIterate::change_states`]
    /// makes them; true if it has occurred before. Without changes nothing is recorded: false.
    pub fn record(&mut self, changes: &[(u32, Contact)]) -> bool {
        if changes.is_empty() {
            return false;
        }
        for &(i, contact) in changes {
            let before = self.states[i as usize];
            self.fingerprint = self
                .fingerprint
                .wrapping_sub(state_key(i as usize, before))
                .wrapping_add(state_key(i as usize, contact));
        }
        let has_returned = self.seen.contains(&self.fingerprint);
        self.seen.push(self.fingerprint);
        has_returned
    }

    /// Changes contact states, sets the values that they prescribe and updates the residual.
    pub fn change_states(&mut self, changes: &[(u32, Contact)]) {
        let is_symmetric = self.inequality.symmetric;
        for &(i, contact) in changes {
            let i = i as usize;
            self.states[i] = contact;
            let prescribed = prescribed_value(&self.inequality.bounds[i], contact);
            self.eliminated[i] = prescribed.is_some();
            if let Some(value) = prescribed {
                let change = value - self.values[i];
                self.values[i] = value;
                // the column is the row if the matrix is symmetric
                if !is_symmetric {
                    continue;
                }
                let (columns, entries) = self.inequality.matrix.row(i);
                for (&j, &a) in columns.iter().zip(entries) {
                    self.residual[j as usize] -= a * change;
                }
            }
        }
        if !is_symmetric {
            self.recompute_residual();
        }
    }

    /// Recomputes the residual from the values.
    pub fn recompute_residual(&mut self) {
        let penalised = self.penalised_residual();
        let residual_entry = residual_at(self.inequality, &self.values, penalised.as_deref());
        for_each_chunk(&mut self.residual, |range, r| {
            range.zip(r).for_each(|(i, r)| *r = T::lit(residual_entry(i)));
        });
    }

    /// The residual `c - K u - M^T S (M u - g)` of a
    /// [`PenalisedMatrix`](crate::algebra::PenalisedMatrix), which has less rounding than the
    /// residual of the assembled matrix; `None` if the matrix is not penalised.
    pub fn penalised_residual(&self) -> Option<Vec<f64>> {
        let penalised = self.inequality.penalised.as_ref()?;
        let mut residual = vec![0.0; self.values.len()];
        penalised.residual(|i| self.values[i].to_f64(), &mut residual);
        Some(residual)
    }
}

/// The function that returns an entry of the residual in `f64`: the entry of `penalised` if given,
/// else of `b - A u`.
pub(crate) fn residual_at<'v, T: Real>(
    inequality: &'v Inequality<T>,
    values: &'v [T],
    penalised: Option<&'v [f64]>,
) -> impl Fn(usize) -> f64 + Sync + 'v {
    let Inequality { matrix, load, .. } = inequality;
    move |i| match penalised {
        Some(residual) => residual[i],
        None => load[i].to_f64() - matrix.row_dot_f64(i, values),
    }
}
