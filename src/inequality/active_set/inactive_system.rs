//! The linear system of an active set, `A_II u_I = b_I - A_IP u_P` on the inactive unknowns `I`,
//! with the prescribed values of all others, `P`; solved with factors.

use super::contact_state::prescribed_value;
use crate::algebra::{Contact, Inequality, PenalisedMatrix};
use crate::linear::direct::EliminationOrder;
use crate::linear::direct::{CondensedFactors, StaticCondensation};
use crate::linear::direct::{FactorError, Factors};
use crate::real::Real;

/// Largest number of corrections of values and jump multipliers for one active set.
const MAX_CORRECTIONS: usize = 12;

/// A correction is the last one if its largest entry is at most this multiple of machine epsilon
/// times the largest value.
const CORRECTION_MULTIPLE: f64 = 16.0;

/// The linear systems of an inequality for all active sets.
pub(crate) struct InactiveSystem<'a, T> {
    inequality: &'a Inequality<T>,
    /// The inactive unknowns of the last system, ascending.
    inactive: Vec<u32>,
    /// The last correction of their values.
    correction: Vec<T>,
    /// The static condensation of the penalised matrix, if the matrix is penalised.
    condensation: Option<StaticCondensation<'a, T>>,
    /// The elimination order of a symmetric matrix, which is the same for all active sets; `None`
    /// before the first factorisation.
    elimination_order: Option<EliminationOrder>,
}

/// The unknowns of a linear system, and its residual.
pub(crate) struct LinearUnknowns<'v, T> {
    pub values: &'v mut [T],
    /// The jump multipliers if the matrix is penalised; else empty.
    pub jump_multipliers: &'v mut [T],
    /// `b - A u`.
    pub residual: &'v mut [f64],
}

/// The sizes of a correction of values and jump multipliers.
struct CorrectionSize {
    /// The energy of the correction.
    correction_energy: f64,
    /// Largest absolute change of a value.
    max_change: f64,
    /// Largest absolute value after the correction.
    max_norm: f64,
    /// Energy after the correction.
    energy: f64,
    /// `sum K_ii u_i^2` after the correction.
    diagonal_energy: f64,
}

impl<'a, T: Real> InactiveSystem<'a, T> {
    /// The systems of an inequality. It may be malformed as long as no system is solved.
    pub fn new(inequality: &'a Inequality<T>) -> Self {
        let penalised = inequality.penalised.as_ref().filter(|_| inequality.is_well_formed());
        let condensation = penalised.map(|penalised| {
            StaticCondensation::new(penalised)
                .with_points(inequality.points_of_unknowns().as_deref())
        });
        Self {
            inequality,
            inactive: Vec::new(),
            correction: Vec::new(),
            condensation,
            elimination_order: None,
        }
    }

    /// The number of jump multipliers; zero if the matrix is not penalised.
    pub fn n_jumps(&self) -> usize {
        let penalised = self.inequality.penalised.as_ref().filter(|_| self.condensation.is_some());
        penalised.map_or(0, |penalised| penalised.n_jumps())
    }

    /// The static condensation; `None` if the matrix is not penalised.
    pub fn condensation(&self) -> Option<&StaticCondensation<'a, T>> {
        self.condensation.as_ref()
    }

    /// Corrects the values of all inactive unknowns by the solution for the residual,
    /// `1 + refinements` times (for a penalised matrix at least so often), and the jump multipliers
    /// with them; then computes the residual. The values of fixed and active unknowns must have
    /// been set.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn solve(
        &mut self,
        states: &[Contact],
        mut unknowns: LinearUnknowns<'_, T>,
        refinements: usize,
    ) -> Result<(), FactorError> {
        let Inequality { matrix, load, bounds, penalised, .. } = self.inequality;
        self.inactive.clear();
        let all = bounds.iter().zip(states).enumerate();
        let inactive = all.filter(|(_, (bound, state))| prescribed_value(bound, **state).is_none());
        self.inactive.extend(inactive.map(|(i, _)| i as u32));
        if let (Some(condensation), Some(penalised)) = (&self.condensation, penalised) {
            let mut is_inactive = vec![false; unknowns.values.len()];
            self.inactive.iter().for_each(|&i| is_inactive[i as usize] = true);
            let factors = condensation.factor(&is_inactive)?;
            let system = PenalisedSystem { penalised, condensation, factors, is_inactive };
            return system.solve(&mut unknowns, refinements);
        }
        let factors = self.factor()?;
        let LinearUnknowns { values, residual, .. } = unknowns;
        for _ in 0..=refinements {
            matrix.residual_f64(load, values, residual);
            self.correction.clear();
            self.correction.extend(self.inactive.iter().map(|&i| T::lit(residual[i as usize])));
            factors.solve_in_place(&mut self.correction, 1);
            for (&i, &correction) in self.inactive.iter().zip(&self.correction) {
                values[i as usize] += correction;
            }
        }
        matrix.residual_f64(load, values, residual);
        Ok(())
    }

    /// Factors of `A_II`.
    fn factor(&mut self) -> Result<Factors<T>, FactorError> {
        let Inequality { matrix, symmetric, .. } = self.inequality;
        if !*symmetric {
            return Factors::new(matrix, false, &self.inactive);
        }
        let order = match self.elimination_order.take() {
            Some(order) => order,
            None => EliminationOrder::for_inequality(self.inequality)?,
        };
        let order = self.elimination_order.insert(order);
        Factors::in_order(matrix, &self.inactive, order)
    }
}

/// The system `K u + M^T p = c`, `M u - S^-1 p = g` of a [`PenalisedMatrix`], for values `u` of the
/// inactive unknowns and jump multipliers `p`.
struct PenalisedSystem<'s, 'a, T> {
    penalised: &'a PenalisedMatrix<T>,
    condensation: &'s StaticCondensation<'a, T>,
    factors: CondensedFactors<T>,
    is_inactive: Vec<bool>,
}

impl<T: Real> PenalisedSystem<'_, '_, T> {
    /// Corrects values and jump multipliers together, at least `1 + refinements` times (but at most
    /// [`MAX_CORRECTIONS`] times) and until the corrections no longer halve.
    ///
    /// # Errors
    /// [`FactorError::Singular`] if the last correction is not small in energy: the matrix is then
    /// singular in the precision of the scalar.
    fn solve(
        &self,
        unknowns: &mut LinearUnknowns<'_, T>,
        refinements: usize,
    ) -> Result<(), FactorError> {
        let mut mismatch = vec![0.0; unknowns.jump_multipliers.len()];
        let mut least = f64::INFINITY;
        let mut is_singular = false;
        let floor = (CORRECTION_MULTIPLE * T::EPSILON).powi(2);
        for correction in 0..MAX_CORRECTIONS {
            let size = self.correct(unknowns, &mut mismatch);
            let is_small = size.max_change <= CORRECTION_MULTIPLE * T::EPSILON * size.max_norm;
            // A quarter of the digits of the scalar in the energy norm: single unknowns of thin
            // cells may have fewer correct digits. The floor is for constants, whose energy is
            // zero.
            let tolerance = T::EPSILON.sqrt() * size.energy + floor * size.diagonal_energy;
            is_singular = size.correction_energy.abs() > tolerance;
            // false for numbers that are not finite
            let halves = size.max_change <= 0.5 * least && !is_small;
            if correction >= refinements && !halves {
                break;
            }
            least = size.max_change;
        }
        self.compute_residual(unknowns);
        if is_singular { Err(FactorError::Singular) } else { Ok(()) }
    }

    /// One correction of values and jump multipliers by the solution for the residuals of both
    /// equations. The residual of the second equation is computed in `mismatch`; both residuals are
    /// overwritten by the corrections.
    fn correct(
        &self,
        unknowns: &mut LinearUnknowns<'_, T>,
        mismatch: &mut [f64],
    ) -> CorrectionSize {
        let penalised = self.penalised;
        for (jump, out) in mismatch.iter_mut().enumerate() {
            let multiplier = unknowns.jump_multipliers[jump].to_f64();
            *out = penalised.jump_residual(jump, |i| unknowns.values[i].to_f64(), multiplier);
        }
        self.compute_residual(unknowns);
        let LinearUnknowns { values, jump_multipliers, residual } = unknowns;
        let correction_energy =
            self.condensation.solve(&self.factors, &self.is_inactive, residual, mismatch);
        let (mut max_change, mut max_norm, mut diagonal_energy) = (0.0_f64, 0.0_f64, 0.0);
        for (i, (x, correction)) in values.iter_mut().zip(residual.iter()).enumerate() {
            *x += T::lit(*correction);
            max_change = max_change.max(correction.abs());
            max_norm = max_norm.max(x.to_f64().abs());
            diagonal_energy += penalised.stiffness_diagonal(i) * x.to_f64().powi(2);
        }
        for (multiplier, correction) in jump_multipliers.iter_mut().zip(mismatch) {
            *multiplier += T::lit(*correction);
        }
        let multiplier = |jump: usize| jump_multipliers[jump].to_f64();
        let energy = penalised.energy(|i| values[i].to_f64(), multiplier);
        CorrectionSize { correction_energy, max_change, max_norm, energy, diagonal_energy }
    }

    /// Sets the residual to `c - K u - M^T p`.
    fn compute_residual(&self, unknowns: &mut LinearUnknowns<'_, T>) {
        let LinearUnknowns { values, jump_multipliers, residual } = unknowns;
        let multiplier = |jump: usize| jump_multipliers[jump].to_f64();
        self.penalised.residual_with_jump_multipliers(|i| values[i].to_f64(), multiplier, residual);
    }
}
