//! The iterate of the active set method: values, contact states, residual, and the best values so far.

use std::borrow::Cow;

use super::contact_state::{prescribed_value, starting_states};
use crate::algebra::{Contact, Inequality, any_part};
use crate::inequality::certificate::violations::certify_with_rounding;
use crate::inequality::certificate::{self, positive_diagonal};
use crate::inequality::{Outcome, Solution};
use crate::parallel::vectors::{collect, for_each_chunk, for_each_chunk_of_two, sum_chunks};
use crate::real::Real;

/// The largest certificate that is attributed to rounding, divided by machine epsilon.
const ROUNDING: f64 = 128.0;

/// The values and contact states of a step, and the best values of all steps.
pub(crate) struct Iterate<'a, T: Real> {
    pub inequality: &'a Inequality<T>,
    pub values: Vec<T>,
    /// The jump multipliers, if a linear solver has determined them beside the values
    /// ([`PenalisedMatrix`](crate::algebra::PenalisedMatrix)); else empty.
    pub jump_multipliers: Vec<T>,
    pub states: Vec<Contact>,
    /// Whether an unknown is eliminated from the linear system: fixed, active, or one that another part of the mesh
    /// owns, whose state is known there alone.
    pub eliminated: Vec<bool>,
    /// `b - A u`; with jump multipliers `p`, `c - K u - M^T p`.
    pub residual: Vec<f64>,
    /// Whether `residual` is that of the present values.
    pub residual_is_current: bool,
    /// The diagonal of the matrix, positive; see [`positive_diagonal`].
    pub diagonal: Vec<f64>,
    /// The energy norm of the values at the last evaluation, one before the first; see
    /// [`Evaluation::energy_norm`](super::evaluation::Evaluation::energy_norm).
    pub energy_norm: f64,
    /// Number of linear systems with a new active set, and of steps of the interior point method.
    pub outer: usize,
    /// Number of iterations of the linear solver.
    pub linear: usize,
    /// The load of the assembled matrix.
    assembled_load: Cow<'a, [T]>,
    best: BestIterate<T>,
}

/// The iterate with the smallest merit; see
/// [`Evaluation::merit`](super::evaluation::Evaluation::merit).
struct BestIterate<T> {
    merit: f64,
    values: Vec<T>,
    states: Vec<Contact>,
    jump_multipliers: Vec<T>,
}

impl<'a, T: Real> Iterate<'a, T> {
    /// The admissible values nearest to `guess`, or to zero if `guess` has another length, with the contact states of the
    /// inequality's start and the values that these prescribe. Unknowns that another part of the mesh owns are inactive.
    pub fn new(inequality: &'a Inequality<T>, guess: &[T]) -> Self {
        let bounds = &inequality.bounds;
        let n = bounds.len();
        let value = |i: usize| if guess.len() == n { guess[i] } else { T::lit(0.0) };
        let values: Vec<T> = collect(n, |i| bounds[i].nearest(value(i)));
        let mut states = starting_states(inequality);
        for_each_chunk(&mut states, |range, states| {
            let ghosts = states.iter_mut().zip(range).filter(|(_, i)| !inequality.owns(*i));
            ghosts.for_each(|(state, _)| *state = Contact::Inactive);
        });
        let best = BestIterate {
            merit: f64::INFINITY,
            values: Vec::new(),
            states: states.clone(),
            jump_multipliers: Vec::new(),
        };
        let mut iterate = Self {
            inequality,
            values,
            jump_multipliers: Vec::new(),
            states,
            eliminated: vec![false; n],
            residual: vec![0.0; n],
            residual_is_current: false,
            diagonal: collect(n, |i| positive_diagonal(inequality, i)),
            energy_norm: 1.0,
            outer: 0,
            linear: 0,
            assembled_load: inequality.assembled_load(),
            best,
        };
        iterate.set_prescribed_values();
        // a solution without any evaluation has the values that its states prescribe
        iterate.best.values.clone_from(&iterate.values);
        iterate
    }

    /// Replaces values, jump multipliers and contact states.
    pub fn replace(&mut self, values: Vec<T>, jump_multipliers: Vec<T>, states: Vec<Contact>) {
        (self.values, self.jump_multipliers, self.states) = (values, jump_multipliers, states);
        self.set_prescribed_values();
    }

    /// Sets every fixed or active unknown to its prescribed value, exactly, and marks it as eliminated.
    fn set_prescribed_values(&mut self) {
        let Self { inequality, values, states, eliminated, .. } = &mut *self;
        for_each_chunk_of_two(values, eliminated, 1, |range, values, eliminated| {
            for (i, (value, eliminated)) in range.zip(values.iter_mut().zip(eliminated)) {
                let prescribed = prescribed_value(&inequality.bounds[i], states[i]);
                *eliminated = prescribed.is_some() || !inequality.owns(i);
                *value = prescribed.unwrap_or(*value);
            }
        });
        self.residual_is_current = false;
        self.inequality.distribution().update(&mut self.values);
    }

    /// Changes contact states to admissible ones and sets the values that they prescribe. The residual of a symmetric
    /// matrix without jump multipliers is updated by the columns of the matrix that belong to these unknowns.
    pub fn change_states(&mut self, changes: &[(u32, Contact)]) {
        let inequality = self.inequality;
        // changes in other parts are not known here
        let is_updated =
            inequality.symmetric && self.jump_multipliers.is_empty() && !inequality.is_in_parts();
        self.residual_is_current &= is_updated;
        for &(i, contact) in changes {
            let i = i as usize;
            self.states[i] = contact;
            let prescribed = prescribed_value(&self.inequality.bounds[i], contact);
            self.eliminated[i] = prescribed.is_some() || !self.inequality.owns(i);
            let Some(value) = prescribed else { continue };
            let change = (value - self.values[i]).to_f64();
            self.values[i] = value;
            if self.residual_is_current {
                // the column is the row
                let (columns, entries) = self.inequality.matrix.row(i);
                for (&j, a) in columns.iter().zip(entries) {
                    self.residual[j as usize] -= a.to_f64() * change;
                }
            }
        }
        inequality.distribution().update(&mut self.values);
    }

    /// Computes the residual from the values and the jump multipliers.
    pub fn compute_residual_with_jump_multipliers(&mut self) {
        let Self { inequality, values, jump_multipliers, residual, .. } = self;
        certificate::residual(inequality, values, jump_multipliers, residual);
    }

    /// Computes the residual from the values.
    pub fn compute_residual(&mut self) {
        self.inequality.residual_f64(&self.values, &mut self.residual);
        self.residual_is_current = true;
    }

    /// Replaces the values by the nearest admissible ones; returns whether one changed.
    pub fn project_onto_bounds(&mut self) -> bool {
        let bounds = &self.inequality.bounds;
        let n_changed = sum_chunks(&mut self.values, 1, |range, values| {
            let mut n_changed = 0.0;
            for (value, bound) in values.iter_mut().zip(&bounds[range]) {
                let nearest = bound.nearest(*value);
                n_changed += f64::from(u8::from(nearest != *value));
                *value = nearest;
            }
            n_changed
        });
        let distribution = self.inequality.distribution();
        distribution.update(&mut self.values);
        let is_changed = any_part(distribution, n_changed > 0.0);
        self.residual_is_current &= !is_changed;
        is_changed
    }

    /// Keeps the iterate as the best one if its merit is the smallest so far.
    pub fn keep_if_best(&mut self, merit: f64) {
        if merit < self.best.merit {
            self.best.merit = merit;
            let Self { values, states, best, .. } = self;
            for_each_chunk_of_two(&mut best.values, &mut best.states, 1, |range, to, to_states| {
                to.copy_from_slice(&values[range.clone()]);
                to_states.copy_from_slice(&states[range]);
            });
            best.jump_multipliers.clone_from(&self.jump_multipliers);
        }
    }

    /// Forgets the merit of the best iterate: the next one is the best.
    pub fn forget_best(&mut self) {
        self.best.merit = f64::INFINITY;
    }

    /// The values and jump multipliers of the best iterate.
    pub fn best_values(&self) -> (&[T], &[T]) {
        (&self.best.values, &self.best.jump_multipliers)
    }

    /// Sums of the absolute values of the terms of row `i` of `b - A u`: terms of unknowns that are not eliminated,
    /// then terms of eliminated ones and of the load.
    pub fn residual_term_magnitudes(&self, i: usize) -> [f64; 2] {
        let (columns, entries) = self.inequality.matrix.row(i);
        let (mut free, mut eliminated) = (0.0, self.assembled_load[i].to_f64().abs());
        for (&j, a) in columns.iter().zip(entries) {
            let j = j as usize;
            let term = (a.to_f64() * self.values[j].to_f64()).abs();
            *(if self.eliminated[j] { &mut eliminated } else { &mut free }) += term;
        }
        [free, eliminated]
    }

    /// The solution: the present iterate if it converged, else the best one.
    pub fn into_solution(self, outcome: Outcome) -> Solution<T> {
        let (values, contact, jump_multipliers) = if outcome == Outcome::Converged {
            (self.values, self.states, self.jump_multipliers)
        } else {
            (self.best.values, self.best.states, self.best.jump_multipliers)
        };
        Solution::new(values, contact, outcome).jump_multipliers(jump_multipliers)
    }

    /// The largest of the numbers of the values' certificate ([`Certificate`]).
    pub fn certificate(&self) -> f64 {
        certify_with_rounding(self.inequality, &self.values, &self.jump_multipliers).0.largest()
    }

    /// The outcome of a solve that ended with `outcome`. After an iteration limit, a cycle, a stall or a singular matrix
    /// it follows from the certificate of the best iterate: [`Outcome::Converged`] within its limit, and the best iterate
    /// then replaces the present one; [`Outcome::Stalled`] within the rounding that large penalties amplify; else
    /// `outcome`, also if there is no best iterate.
    pub fn outcome_of_best(&mut self, outcome: Outcome) -> Outcome {
        let is_without_solution = matches!(
            outcome,
            Outcome::IterationLimit | Outcome::Cycling | Outcome::Stalled | Outcome::Singular
        );
        if !is_without_solution || self.best.merit.is_infinite() {
            return outcome;
        }
        let (best, jump_multipliers) = self.best_values();
        let (certificate, amplification) =
            certify_with_rounding(self.inequality, best, jump_multipliers);
        let rounding = ROUNDING * T::EPSILON * amplification.max(1.0);
        match certificate.largest() {
            largest if largest <= T::CERTIFICATE_LIMIT => {
                self.restore_best();
                Outcome::Converged
            }
            largest if largest <= rounding => Outcome::Stalled,
            _ => outcome,
        }
    }

    /// Replaces the iterate by the best one. The residual is then not current.
    fn restore_best(&mut self) {
        let BestIterate { values, states, jump_multipliers, .. } = &self.best;
        let (values, jumps) = (values.clone(), jump_multipliers.clone());
        self.replace(values, jumps, states.clone());
    }
}
