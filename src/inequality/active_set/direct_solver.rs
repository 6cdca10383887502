//! The linear systems of active sets, solved with factors of the assembled matrix or, for a penalised matrix, by static
//! condensation.

use super::iterate::Iterate;
use super::linear_solver::{Accuracy, End, LinearSolver};
use crate::algebra::{Inequality, PenalisedMatrix};
use crate::inequality::algebraic_bound::{AdmissibleValues, algebraic_bound};
use crate::linear::direct::{
    CondensedFactors, FactorError, Factors, MatrixFactors, StaticCondensation,
};
use crate::real::Real;

/// Number of solutions for one active set, each with the residual in `f64` of the one before. Every step of the active
/// set method is itself a correction of the preceding iterate; the second solution gains two digits and more in `f32` if a
/// single step suffices (a warm start).
const SOLUTIONS: usize = 2;

/// Largest number of corrections of values and jump multipliers for one active set.
const MAX_CORRECTIONS: usize = 12;

/// A correction counts as rounding if its largest entry is at most this multiple of machine epsilon times the largest
/// absolute value.
const CORRECTION_MULTIPLE: f64 = 16.0;

/// Largest energy of the last correction, divided by the energy of the values or of the first one, with which the factors
/// count as accurate to one digit or more.
const MAX_CORRECTION_SHARE: f64 = 0.01;

/// A solver with factors for the linear systems of all active sets of an inequality.
pub(crate) struct DirectSolver<'a, T> {
    inequality: &'a Inequality<T>,
    /// The inactive unknowns, ascending.
    inactive: Vec<u32>,
    /// The factors for the inactive unknowns; `None` before the first factorisation and after one that failed.
    factors: Option<MatrixFactors<T>>,
    /// The static condensation of the penalised matrix, if the matrix is penalised.
    condensation: Option<StaticCondensation<'a, T>>,
}

impl<'a, T: Real> DirectSolver<'a, T> {
    /// The solver of an inequality, which must be well formed.
    pub fn new(inequality: &'a Inequality<T>) -> Self {
        let penalised = inequality.penalised.as_ref();
        let condensation = penalised.map(|p| StaticCondensation::new(p, &inequality.matrix));
        Self { inequality, inactive: Vec::new(), factors: None, condensation }
    }

    /// The static condensation; `None` if the matrix is not penalised.
    pub fn condensation(&self) -> Option<&StaticCondensation<'a, T>> {
        self.condensation.as_ref()
    }

    /// Corrects the values [`SOLUTIONS`] times; then computes the residual.
    ///
    /// # Errors
    /// [`FactorError::Singular`] if the energy of the last correction exceeds [`MAX_CORRECTION_SHARE`] times the larger
    /// one of the energies of the values and of the first correction: the factors then have no correct digit. A solution
    /// may have no energy.
    fn correct_assembled(
        &self,
        factors: &Factors<T>,
        iterate: &mut Iterate<'_, T>,
    ) -> Result<(), FactorError> {
        let Inequality { matrix, load, .. } = self.inequality;
        let Iterate { values, residual, .. } = iterate;
        let mut correction = Vec::with_capacity(self.inactive.len());
        let mut correction_energies = [0.0_f64; SOLUTIONS];
        for correction_energy in &mut correction_energies {
            matrix.residual_f64(load, values, residual);
            correction.clear();
            correction.extend(self.inactive.iter().map(|&i| T::lit(residual[i as usize])));
            factors.solve_in_place(&mut correction, 1);
            for (&i, &correction) in self.inactive.iter().zip(&correction) {
                values[i as usize] += correction;
                *correction_energy += correction.to_f64() * residual[i as usize];
            }
        }
        matrix.residual_f64(load, values, residual);
        let terms = values.iter().zip(load).zip(residual.iter());
        let energy: f64 = terms.map(|((x, b), r)| x.to_f64() * (b.to_f64() - r)).sum();
        let largest = energy.abs().max(correction_energies[0].abs());
        match correction_energies[SOLUTIONS - 1].abs() > MAX_CORRECTION_SHARE * largest {
            true => Err(FactorError::Singular),
            false => Ok(()),
        }
    }
}

impl<T: Real> DirectSolver<'_, T> {
    /// Projects the values onto their bounds and returns the bound on their error ([`algebraic_bound`]); `None` for a
    /// matrix that is not symmetric, if an active unknown is not strongly active, or if rounding makes the square
    /// negative.
    ///
    /// The norm is the root of the energy of one more correction. For an assembled matrix the bound is proven but for
    /// rounding in the factors. For a penalised matrix the energy is that of a correction of values and jump multipliers
    /// together, in which the rounding of single values has no weight.
    pub fn error_bound(&self, iterate: &mut Iterate<'_, T>) -> Option<f64> {
        if !self.inequality.symmetric {
            return None;
        }
        iterate.project_onto_bounds();
        let squared = self.correction_energy(iterate)?;
        let norm = (squared >= 0.0).then(|| squared.sqrt());
        let Iterate { values, residual, diagonal, energy_norm, eliminated: present, .. } =
            &*iterate;
        let (inequality, energy_norm) = (self.inequality, *energy_norm);
        let values = AdmissibleValues { inequality, values, residual, diagonal, energy_norm };
        // the factors are those of the inactive unknowns
        let has_factors = |eliminated: &[bool]| eliminated == present;
        algebraic_bound(&values, 0.0, |eliminated, _| Ok(norm.filter(|_| has_factors(eliminated))))
            .unwrap_or(None)
    }

    /// The energy of one more correction, which is not applied; `None` without factors. Computes the residual of the
    /// values.
    fn correction_energy(&self, iterate: &mut Iterate<'_, T>) -> Option<f64> {
        match (&self.factors, &self.condensation, &self.inequality.penalised) {
            (Some(MatrixFactors::Assembled(factors)), ..) => {
                iterate.compute_residual();
                let residual = &iterate.residual;
                let of_inactive = |&i: &u32| T::lit(residual[i as usize]);
                let mut correction: Vec<T> = self.inactive.iter().map(of_inactive).collect();
                factors.solve_in_place(&mut correction, 1);
                let terms = self.inactive.iter().zip(&correction);
                Some(terms.map(|(&i, e)| residual[i as usize] * e.to_f64()).sum())
            }
            (Some(MatrixFactors::Condensed(factors)), Some(condensation), Some(penalised)) => {
                let is_inactive = iterate.eliminated.iter().map(|&e| !e).collect();
                let system = PenalisedSystem { penalised, condensation, factors, is_inactive };
                let mut jump_residuals = vec![0.0; iterate.jump_multipliers.len()];
                system.compute_residuals(iterate, &mut jump_residuals);
                let mut residual = iterate.residual.clone();
                let is_inactive = &system.is_inactive;
                Some(condensation.solve(factors, is_inactive, &mut residual, &mut jump_residuals))
            }
            _ => None,
        }
    }
}

impl<T: Real> LinearSolver<T> for DirectSolver<'_, T> {
    fn set_eliminated(&mut self, eliminated: &[bool]) -> Result<(), End> {
        self.inactive.clear();
        let inactive = eliminated.iter().enumerate().filter(|(_, eliminated)| !**eliminated);
        self.inactive.extend(inactive.map(|(i, _)| i as u32));
        self.factors = None;
        self.factors = Some(match &self.condensation {
            Some(condensation) => {
                let is_inactive: Vec<bool> = eliminated.iter().map(|&e| !e).collect();
                MatrixFactors::Condensed(Box::new(condensation.factor(&is_inactive, &[])?))
            }
            None => {
                let Inequality { matrix, symmetric, .. } = self.inequality;
                MatrixFactors::Assembled(Factors::new(matrix, *symmetric, &self.inactive)?)
            }
        });
        Ok(())
    }

    /// For a penalised matrix, corrects values and jump multipliers together until the corrections no longer halve.
    fn correct(&mut self, iterate: &mut Iterate<'_, T>, _accuracy: Accuracy) -> Result<(), End> {
        match (&self.factors, &self.condensation, &self.inequality.penalised) {
            (Some(MatrixFactors::Assembled(factors)), ..) => {
                self.correct_assembled(factors, iterate)?;
            }
            (Some(MatrixFactors::Condensed(factors)), Some(condensation), Some(penalised)) => {
                let is_inactive = iterate.eliminated.iter().map(|&e| !e).collect();
                iterate.jump_multipliers.resize(penalised.n_jumps(), T::lit(0.0));
                let system = PenalisedSystem { penalised, condensation, factors, is_inactive };
                system.solve(iterate)?;
            }
            _ => return Err(End::Unsuitable),
        }
        Ok(())
    }

    fn residual_term_magnitudes(&self, i: usize, iterate: &Iterate<'_, T>) -> [f64; 2] {
        match &self.condensation {
            Some(condensation) => condensation.residual_term_magnitudes(
                (i, self.inequality.load[i]),
                &|j| iterate.values[j].to_f64(),
                &iterate.jump_multipliers,
                &|j| iterate.eliminated[j],
            ),
            None => iterate.residual_term_magnitudes(i),
        }
    }
}

/// The system `K u + M^T p = c`, `M u - S^-1 p = g` of a [`PenalisedMatrix`], for values `u` of the
/// inactive unknowns and jump multipliers `p`.
struct PenalisedSystem<'s, 'a, T> {
    penalised: &'a PenalisedMatrix<T>,
    condensation: &'s StaticCondensation<'a, T>,
    factors: &'s CondensedFactors<T>,
    is_inactive: Vec<bool>,
}

impl<T: Real> PenalisedSystem<'_, '_, T> {
    /// Corrects values and jump multipliers together, [`SOLUTIONS`] to [`MAX_CORRECTIONS`] times, until a correction is
    /// rounding or its largest change is more than half of the preceding one.
    ///
    /// # Errors
    /// [`FactorError::Singular`] if the energy of the last correction is not small: the matrix is then singular in the
    /// precision of the scalar.
    fn solve(&self, iterate: &mut Iterate<'_, T>) -> Result<(), FactorError> {
        let penalised = self.penalised;
        // the residuals of both equations, which the corrections overwrite
        let mut jump_residuals = vec![0.0; iterate.jump_multipliers.len()];
        let mut previous_change = f64::INFINITY;
        let mut is_singular = false;
        let squared_rounding = (CORRECTION_MULTIPLE * T::EPSILON).powi(2);
        for solution in 1..=MAX_CORRECTIONS {
            self.compute_residuals(iterate, &mut jump_residuals);
            let Iterate { inequality, values, jump_multipliers, residual, .. } = &mut *iterate;
            let (factors, is_inactive) = (self.factors, &self.is_inactive);
            let correction_energy =
                self.condensation.solve(factors, is_inactive, residual, &mut jump_residuals);
            let (mut max_change, mut max_norm, mut diagonal_energy) = (0.0_f64, 0.0_f64, 0.0);
            for (i, (x, correction)) in values.iter_mut().zip(residual.iter()).enumerate() {
                *x += T::lit(*correction);
                max_change = max_change.max(correction.abs());
                max_norm = max_norm.max(x.to_f64().abs());
                diagonal_energy += penalised.stiffness_diagonal(i) * x.to_f64().powi(2);
            }
            for (multiplier, correction) in jump_multipliers.iter_mut().zip(&jump_residuals) {
                *multiplier += T::lit(*correction);
            }
            let multiplier = |jump: usize| jump_multipliers[jump].to_f64();
            let load = &inequality.load;
            let energy = penalised.energy(load, |i| values[i].to_f64(), multiplier);
            let is_small = max_change <= CORRECTION_MULTIPLE * T::EPSILON * max_norm;
            // A quarter of the digits of the scalar in the energy norm: single unknowns of thin cells may have fewer
            // correct digits. The second term is for constants, whose energy is zero.
            let tolerance = T::EPSILON.sqrt() * energy + squared_rounding * diagonal_energy;
            is_singular = correction_energy.abs() > tolerance;
            // false for numbers that are not finite
            let halves = max_change <= 0.5 * previous_change && !is_small;
            if solution >= SOLUTIONS && !halves {
                break;
            }
            previous_change = max_change;
        }
        iterate.compute_residual_with_jump_multipliers();
        if is_singular { Err(FactorError::Singular) } else { Ok(()) }
    }

    /// Sets the residual to `c - K u - M^T p`, and `jump_residuals` to `g - M u + S^-1 p`.
    fn compute_residuals(&self, iterate: &mut Iterate<'_, T>, jump_residuals: &mut [f64]) {
        for (jump, out) in jump_residuals.iter_mut().enumerate() {
            let multiplier = iterate.jump_multipliers[jump].to_f64();
            *out = self.penalised.jump_residual(jump, |i| iterate.values[i].to_f64(), multiplier);
        }
        iterate.compute_residual_with_jump_multipliers();
    }
}
