//! The evaluation of the KKT conditions at an iterate: violations, merit, and the prediction of the
//! active set.

use super::contact_state::violated_bound;
use super::iterate::Iterate;
use super::linear_solver::LinearSolver;
use crate::algebra::{Contact, Distribution};
use crate::inequality::certificate::scales::Scales;
use crate::parallel::vectors::map_chunks;
use crate::real::Real;

/// The multiple of machine epsilon within which no unknown changes its state.
pub(super) const ROUNDING_BAND: f64 = 16.0;

/// The violations of the KKT conditions, their scales, and the active set that they predict.
#[derive(Default)]
pub(crate) struct Evaluation {
    /// The unknowns whose contact state changes, and the new states.
    pub state_changes: Vec<(u32, Contact)>,
    /// The number of state changes, those of other parts included.
    pub n_changes: usize,
    /// The square of the projected Jacobi step `u - P(u + r / d)`, `r = b - A u`, in the norm `(sum d_i v_i^2)^(1/2)`
    /// of the diagonal `d` of `A`: zero at the solution only. A division by the size of the iterate would favour
    /// iterates that are far too large.
    pub merit: f64,
    /// See [`Scales::max_norm`].
    pub max_norm: f64,
    /// See [`Scales::energy_norm`].
    pub energy_norm: f64,
    /// Largest violation of a bound by an inactive unknown; violations within rounding do not count.
    bound_violation: f64,
    /// Dual norm `(sum r_i^2 / d_i)^(1/2)` of the multipliers of wrong sign; rounding is not
    /// subtracted.
    multiplier_violation: f64,
}

impl Evaluation {
    /// Replaces sums and maxima by those over all parts; `state_changes` remain the changes in this part.
    fn add_other_parts(&mut self, distribution: &dyn Distribution) {
        let mut sums = [self.merit, self.multiplier_violation, self.n_changes as f64];
        distribution.sum(&mut sums);
        let mut largest = [self.bound_violation];
        distribution.largest(&mut largest);
        [self.merit, self.multiplier_violation] = [sums[0], sums[1]];
        (self.n_changes, self.bound_violation) = (sums[2] as usize, largest[0]);
    }

    /// The size above which the violation of a bound counts.
    pub fn bound_tolerance<T: Real>(&self) -> f64 {
        ROUNDING_BAND * T::EPSILON * self.max_norm
    }

    /// Whether merit and norms are finite.
    pub fn is_finite(&self) -> bool {
        self.merit.is_finite() && self.energy_norm.is_finite() && self.max_norm.is_finite()
    }

    /// Whether the largest violation of a bound is at most `tolerance` times the largest value, and
    /// the dual norm of the multipliers of wrong sign at most `tolerance` times the energy norm.
    pub fn holds_to(&self, tolerance: f64) -> bool {
        self.bound_violation <= tolerance * self.max_norm
            && self.multiplier_violation <= tolerance * self.energy_norm
    }
}

impl<T: Real> Iterate<'_, T> {
    /// Evaluates the KKT conditions of every unknown, and stores the energy norm. The residual must be
    /// current.
    ///
    /// An inactive unknown that violates a bound becomes active, an active unknown whose multiplier has the wrong sign
    /// becomes inactive, each only if the violation exceeds a tolerance proportional to [`ROUNDING_BAND`]: see
    /// [`ActiveSet`](super::ActiveSet).
    pub fn evaluate(&mut self, solver: &dyn LinearSolver<T>) -> Evaluation {
        let diagonal = |i: usize| self.diagonal[i];
        let Scales { max_norm, energy_norm } = Scales::of(
            self.inequality,
            (&self.values, &self.residual, &self.jump_multipliers),
            &diagonal,
            T::PRECISION,
        );
        let mut evaluation = Evaluation { max_norm, energy_norm, ..Evaluation::default() };
        let bound_tolerance = evaluation.bound_tolerance::<T>();
        let chunks = map_chunks(self.values.len(), |range| {
            let mut chunk = Evaluation::default();
            range
                .filter(|&i| self.inequality.owns(i))
                .for_each(|i| self.evaluate_at(i, bound_tolerance, solver, &mut chunk));
            chunk
        });
        for chunk in chunks {
            evaluation.state_changes.extend(chunk.state_changes);
            evaluation.merit += chunk.merit;
            evaluation.bound_violation = evaluation.bound_violation.max(chunk.bound_violation);
            evaluation.multiplier_violation += chunk.multiplier_violation;
        }
        evaluation.n_changes = evaluation.state_changes.len();
        evaluation.add_other_parts(self.inequality.distribution());
        evaluation.multiplier_violation = evaluation.multiplier_violation.sqrt();
        self.energy_norm = energy_norm;
        evaluation
    }

    /// Makes the present iterate, which another method found, the best one, whatever the merit of those before.
    pub fn set_best(&mut self, solver: &dyn LinearSolver<T>) {
        self.compute_residual_with_jump_multipliers();
        self.forget_best();
        let merit = self.evaluate(solver).merit;
        self.keep_if_best(merit);
    }

    /// Whether a multiplier of unknown `i` is larger than its rounding.
    pub(super) fn is_above_rounding(
        &self,
        i: usize,
        multiplier: f64,
        solver: &dyn LinearSolver<T>,
    ) -> bool {
        // the values of eliminated unknowns have no error, so that their terms are rounded in `f64` only
        let [inactive, eliminated] = solver.residual_term_magnitudes(i, self);
        multiplier > ROUNDING_BAND * (T::EPSILON * inactive + f64::EPSILON * eliminated)
    }

    /// Adds unknown `i` to an evaluation. `multiplier_violation` is here the sum of the squares `r_i^2 / d_i`, without
    /// a tolerance; the caller takes the square root.
    #[inline(always)]
    fn evaluate_at(
        &self,
        i: usize,
        bound_tolerance: f64,
        solver: &dyn LinearSolver<T>,
        evaluation: &mut Evaluation,
    ) {
        let bound = &self.inequality.bounds[i];
        let (x, r, d) = (self.values[i].to_f64(), self.residual[i], self.diagonal[i]);
        let target = bound.nearest(T::lit(x + r / d)).to_f64();
        evaluation.merit += d * (x - target).powi(2);
        if bound.fixed_value().is_some() {
            return;
        }
        let wrong_multiplier = match self.states[i] {
            Contact::Inactive => {
                if let Some((state, violation)) = violated_bound(bound, x, bound_tolerance) {
                    evaluation.state_changes.push((i as u32, state));
                    evaluation.bound_violation = evaluation.bound_violation.max(violation);
                }
                return;
            }
            Contact::Lower => r,
            Contact::Upper => -r,
        };
        if wrong_multiplier > 0.0 {
            evaluation.multiplier_violation += wrong_multiplier * wrong_multiplier / d;
            if self.is_above_rounding(i, wrong_multiplier, solver) {
                evaluation.state_changes.push((i as u32, Contact::Inactive));
            }
        }
    }
}
