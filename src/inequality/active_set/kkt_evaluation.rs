//! The evaluation of the KKT conditions at an inexact iterate: residual, merit, and the prediction of
//! the active set.

use super::inexact_iterate::{InexactIterate, residual_at};
use crate::algebra::{Bound, Contact};
use crate::parallel::vectors::{map_chunks, map_chunks_mut};
use crate::real::Real;

/// The violations of the KKT conditions, and the active set they predict.
#[derive(Default)]
pub(crate) struct KktEvaluation {
    /// The unknowns whose contact state changes, and the new states.
    pub state_changes: Vec<(u32, Contact)>,
    /// Largest violation of a bound.
    pub bound_violation: f64,
    /// Largest `|u_i|`.
    pub displacement: f64,
    /// Dual norm `(sum r_i^2 / d_i)^(1/2)` of the multipliers of wrong sign.
    pub multiplier_violation: f64,
    /// Dual norm of the residual on inactive unknowns.
    pub inactive_residual: f64,
    /// Energy norm of the iterate, or of the load where that is zero.
    pub energy: f64,
}

impl KktEvaluation {
    /// Whether bounds and signs of multipliers hold to a relative tolerance.
    pub fn holds_to(&self, tolerance: f64) -> bool {
        self.bound_violation <= tolerance * self.displacement
            && self.multiplier_violation <= tolerance * self.energy
    }

    /// The sum of the relative violations of bounds and signs.
    pub fn merit(&self) -> f64 {
        self.bound_violation / self.displacement + self.multiplier_violation / self.energy
    }
}

impl<T: Real> InexactIterate<'_, T> {
    /// Recomputes the residual and evaluates the KKT conditions of every unknown.
    pub fn evaluate_kkt(&mut self, band: f64) -> KktEvaluation {
        let mut evaluation = KktEvaluation::default();
        for (energy, displacement) in self.residual_and_energy() {
            evaluation.energy += energy;
            evaluation.displacement = evaluation.displacement.max(displacement);
        }
        let displacement = evaluation.displacement;
        evaluation.displacement = if displacement > 0.0 { displacement } else { 1.0 };
        let tolerance = band * T::EPSILON * evaluation.displacement;
        let parts = map_chunks(self.values.len(), |range| {
            let mut part = KktEvaluation::default();
            range.for_each(|i| self.predict(i, tolerance, band, &mut part));
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
        evaluation.energy =
            if evaluation.energy > 0.0 { evaluation.energy.sqrt() } else { self.load_energy() };
        evaluation
    }

    /// Recomputes the residual `r`; returns `u.(b - r) = u.A u` and the largest `|u_i|` of each chunk.
    fn residual_and_energy(&mut self) -> Vec<(f64, f64)> {
        let load = &self.inequality.load;
        let values = &self.values;
        let penalised = self.penalised_residual();
        let residual_at = residual_at(self.inequality, values, penalised.as_deref());
        map_chunks_mut(&mut self.residual, |range, r| {
            let (mut energy, mut displacement) = (0.0, 0.0_f64);
            for (i, r) in range.zip(r) {
                let (x, b) = (values[i].to_f64(), load[i].to_f64());
                let residual = residual_at(i);
                *r = T::lit(residual);
                energy += x * (b - residual);
                displacement = displacement.max(x.abs());
            }
            (energy, displacement)
        })
    }

    /// Adds the violations of unknown `i` and the change of its contact state, if they exceed rounding.
    #[inline(always)]
    fn predict(&self, i: usize, bound_tolerance: f64, band: f64, evaluation: &mut KktEvaluation) {
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
            _ if bound.fixed_value().is_some() => return,
            Contact::Lower => r,
            Contact::Upper => -r,
        };
        if wrong_multiplier > 0.0 {
            evaluation.multiplier_violation += wrong_multiplier * wrong_multiplier / d;
            if wrong_multiplier > self.multiplier_tolerance(i, band) {
                evaluation.state_changes.push((i as u32, Contact::Inactive));
            }
        }
    }

    /// The size of a multiplier of wrong sign up to which rounding explains it: `band` units of the
    /// absolute terms of its residual.
    fn multiplier_tolerance(&self, i: usize, band: f64) -> f64 {
        let (columns, entries) = self.inequality.matrix.row(i);
        let mut sum = self.inequality.load[i].to_f64().abs();
        for (&j, a) in columns.iter().zip(entries) {
            sum += (a.to_f64() * self.values[j as usize].to_f64()).abs();
        }
        band * T::EPSILON * sum
    }

    /// The dual norm `(sum b_i^2 / d_i)^(1/2)` of the load, or one: a scale of the energy at zero.
    fn load_energy(&self) -> f64 {
        let terms = self.inequality.load.iter().zip(&self.diagonal);
        let sum: f64 =
            terms.map(|(b, d)| b.to_f64().powi(2) / d.to_f64().abs().max(f64::MIN_POSITIVE)).sum();
        if sum > 0.0 { sum.sqrt() } else { 1.0 }
    }
}
