//! The evaluation of the KKT conditions at an inexact iterate: residual, merit, and the prediction of
//! the active set.

use super::inexact_iterate::{InexactIterate, residual_at};
use crate::algebra::{Bound, Contact};
use crate::parallel::vectors::{map_chunks, map_chunks_mut};
use crate::real::Real;

/// The violations of the KKT conditions, their scales, and the active set that they predict.
#[derive(Default)]
pub(crate) struct KktEvaluation {
    /// The unknowns whose contact state changes, and the new states.
    pub state_changes: Vec<(u32, Contact)>,
    /// Largest violation of a bound by an inactive unknown; violations within rounding do not count.
    pub bound_violation: f64,
    /// Largest `|u_i|`, or one if all values are zero.
    pub max_norm: f64,
    /// Dual norm `(sum r_i^2 / d_i)^(1/2)` of the multipliers of wrong sign, `d` the diagonal of `A`;
    /// rounding is not subtracted.
    pub multiplier_violation: f64,
    /// The same dual norm of the residual on inactive unknowns.
    pub inactive_residual: f64,
    /// Energy norm `(u . A u)^(1/2)` of the iterate; if it is zero, the norm of the load
    /// ([`InexactIterate::load_norm`]).
    pub energy_norm: f64,
}

impl KktEvaluation {
    /// Whether the largest violation of a bound is at most `tolerance` times the largest value, and
    /// the dual norm of the multipliers of wrong sign at most `tolerance` times the energy norm.
    /// The residual on inactive unknowns is not examined.
    pub fn holds_to(&self, tolerance: f64) -> bool {
        self.bound_violation <= tolerance * self.max_norm
            && self.multiplier_violation <= tolerance * self.energy_norm
    }

    /// The sum of the relative violations of bounds and of signs of multipliers, each divided by its
    /// scale as in [`KktEvaluation::holds_to`].
    pub fn merit(&self) -> f64 {
        self.bound_violation / self.max_norm + self.multiplier_violation / self.energy_norm
    }
}

impl<T: Real> InexactIterate<'_, T> {
    /// Recomputes the residual and evaluates the KKT conditions of every unknown. A violation within
    /// `rounding_multiple` times machine epsilon times the scale of its terms changes no state.
    pub fn evaluate_kkt(&mut self, rounding_multiple: f64) -> KktEvaluation {
        let mut evaluation = KktEvaluation::default();
        let (mut energy, mut max_norm) = (0.0, 0.0_f64);
        for (part, part_norm) in self.residual_and_energy() {
            energy += part;
            max_norm = max_norm.max(part_norm);
        }
        evaluation.max_norm = if max_norm > 0.0 { max_norm } else { 1.0 };
        let bound_tolerance = rounding_multiple * T::EPSILON * evaluation.max_norm;
        let parts = map_chunks(self.values.len(), |range| {
            let mut part = KktEvaluation::default();
            range.for_each(|i| self.evaluate_at(i, bound_tolerance, rounding_multiple, &mut part));
            part
        });
        for part in parts {
            evaluation.state_changes.extend(part.state_changes);
            evaluation.bound_violation = evaluation.bound_violation.max(part.bound_violation);
            evaluation.multiplier_violation += part.multiplier_violation;
            evaluation.inactive_residual += part.inactive_residual;
        }
        evaluation.multiplier_violation = evaluation.multiplier_violation.sqrt();
        evaluation.inactive_residual = evaluation.inactive_residual.sqrt();
        evaluation.energy_norm = if energy > 0.0 { energy.sqrt() } else { self.load_norm() };
        evaluation
    }

    /// Recomputes the residual `r`; returns for each chunk of unknowns its part of
    /// `u . (b - r) = u . A u` and its largest `|u_i|`.
    fn residual_and_energy(&mut self) -> Vec<(f64, f64)> {
        let load = &self.inequality.load;
        let values = &self.values;
        let penalised = self.penalised_residual();
        let residual_entry = residual_at(self.inequality, values, penalised.as_deref());
        map_chunks_mut(&mut self.residual, |range, r| {
            let (mut energy, mut max_norm) = (0.0, 0.0_f64);
            for (i, r) in range.zip(r) {
                let (x, b) = (values[i].to_f64(), load[i].to_f64());
                let residual = residual_entry(i);
                *r = T::lit(residual);
                energy += x * (b - residual);
                max_norm = max_norm.max(x.abs());
            }
            (energy, max_norm)
        })
    }

    /// Adds unknown `i` to an evaluation. Its violation of a bound and the change of its contact state
    /// count only beyond their rounding tolerances; its squares `r_i^2 / d_i` in
    /// `multiplier_violation` and `inactive_residual`, of which the caller takes the square roots, are
    /// added without a tolerance.
    #[inline(always)]
    fn evaluate_at(
        &self,
        i: usize,
        bound_tolerance: f64,
        rounding_multiple: f64,
        evaluation: &mut KktEvaluation,
    ) {
        let bound = &self.inequality.bounds[i];
        if let Bound::Fixed(_) = bound {
            return;
        }
        let (x, r) = (self.values[i].to_f64(), self.residual[i].to_f64());
        let d = self.diagonal[i].to_f64();
        let wrong_multiplier = match self.states[i] {
            Contact::Inactive => {
                evaluation.inactive_residual += r * r / d;
                let below = bound.lower().map_or(0.0, |l| l.to_f64() - x);
                let above = bound.upper().map_or(0.0, |u| x - u.to_f64());
                if below > bound_tolerance {
                    evaluation.state_changes.push((i as u32, Contact::Lower));
                    evaluation.bound_violation = evaluation.bound_violation.max(below);
                } else if above > bound_tolerance {
                    evaluation.state_changes.push((i as u32, Contact::Upper));
                    evaluation.bound_violation = evaluation.bound_violation.max(above);
                }
                return;
            }
            // lower = upper: the unknown is fixed although its bound is not `Fixed`; it is never
            // inactive
            _ if bound.fixed_value().is_some() => return,
            Contact::Lower => r,
            Contact::Upper => -r,
        };
        if wrong_multiplier > 0.0 {
            evaluation.multiplier_violation += wrong_multiplier * wrong_multiplier / d;
            if wrong_multiplier > self.multiplier_tolerance(i, rounding_multiple) {
                evaluation.state_changes.push((i as u32, Contact::Inactive));
            }
        }
    }

    /// Tolerance for a multiplier of the wrong sign: `rounding_multiple` times machine epsilon
    /// times the sum of the absolute values of the terms of its residual.
    fn multiplier_tolerance(&self, i: usize, rounding_multiple: f64) -> f64 {
        let (columns, entries) = self.inequality.matrix.row(i);
        let mut sum = self.inequality.load[i].to_f64().abs();
        for (&j, a) in columns.iter().zip(entries) {
            sum += (a.to_f64() * self.values[j as usize].to_f64()).abs();
        }
        rounding_multiple * T::EPSILON * sum
    }

    /// The dual norm `(sum b_i^2 / d_i)^(1/2)` of the load, used in place of the energy norm of a zero
    /// iterate; one if the load is zero too.
    fn load_norm(&self) -> f64 {
        let terms = self.inequality.load.iter().zip(&self.diagonal);
        let sum: f64 =
            terms.map(|(b, d)| b.to_f64().powi(2) / d.to_f64().abs().max(f64::MIN_POSITIVE)).sum();
        if sum > 0.0 { sum.sqrt() } else { 1.0 }
    }
}
