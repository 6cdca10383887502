//! The linear systems of active sets, solved with factors.

use super::iterate::Iterate;
use super::linear_solver::{Accuracy, End, LinearSolver};
use crate::algebra::Inequality;
use crate::inequality::algebraic_bound::{AdmissibleValues, algebraic_bound};
use crate::linear::direct::{DirectSystem, MixedVector, SystemFactors};
use crate::real::Real;

/// Number of corrections for one active set, with jump multipliers the least number, each by the residual in `f64` of the one
/// before. Every step of the active set method is itself a correction of the preceding iterate; the second one gains two
/// digits and more in `f32` if a single step suffices (a warm start).
const CORRECTIONS: usize = 2;

/// Largest number of corrections of values together with jump multipliers for one active set.
const MAX_CORRECTIONS: usize = 12;

/// A correction counts as rounding if its largest entry is at most this multiple of machine epsilon times the largest
/// absolute value.
const CORRECTION_MULTIPLE: f64 = 16.0;

/// Largest energy of the last correction, divided by the energy of the values or of the first one, with which the factors
/// of a matrix that is not penalised count as accurate to one digit or more.
const MAX_CORRECTION_SHARE: f64 = 0.01;

/// A solver with factors for the linear systems of all active sets of an inequality.
pub(crate) struct DirectSolver<'a, T> {
    inequality: &'a Inequality<T>,
    system: DirectSystem<'a, T>,
    /// Whether an unknown is inactive.
    is_inactive: Vec<bool>,
    /// The factors for the inactive unknowns; `None` before the first factorisation and after one that failed.
    factors: Option<SystemFactors<T>>,
}

impl<'a, T: Real> DirectSolver<'a, T> {
    /// The solver of an inequality, which must be well formed.
    pub fn new(inequality: &'a Inequality<T>) -> Self {
        let system = DirectSystem::new(inequality);
        Self { inequality, system, is_inactive: Vec::new(), factors: None }
    }

    /// The systems of the inequality.
    pub fn system(&self) -> &DirectSystem<'a, T> {
        &self.system
    }

    /// Projects the values onto their bounds and returns the bound on their error ([`algebraic_bound`]); `None` for a
    /// matrix that is not symmetric, without factors, if an active unknown is not strongly active, or if rounding makes the
    /// square negative.
    ///
    /// The norm is the root of the energy of one more correction. The bound is proven but for rounding in the factors. For
    /// a penalised matrix the energy is that of a correction of values and jump multipliers together, in which the
    /// rounding of single values has no weight.
    pub fn error_bound(&self, iterate: &mut Iterate<'_, T>) -> Option<f64> {
        if !self.inequality.symmetric {
            return None;
        }
        iterate.project_onto_bounds();
        let mut correction = self.residual(iterate);
        iterate.residual.clone_from(&correction.values);
        let squared = self.system.solve(self.factors.as_ref()?, &self.is_inactive, &mut correction);
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

    /// Whether the last of the energies of corrections is not small beside that of the values, whose residual is current.
    /// Solutions may have no energy.
    fn is_inaccurate(&self, iterate: &Iterate<'_, T>, energies: &[f64]) -> bool {
        let Inequality { penalised, load, .. } = self.inequality;
        let Iterate { values, jump_multipliers, residual, .. } = iterate;
        let (first, last) = (energies[0], energies[energies.len() - 1]);
        let Some(penalised) = penalised else {
            let terms = values.iter().zip(load).zip(residual);
            let energy: f64 = terms.map(|((x, b), r)| x.to_f64() * (b.to_f64() - r)).sum();
            return last.abs() > MAX_CORRECTION_SHARE * energy.abs().max(first.abs());
        };
        let value = |i: usize| values[i].to_f64();
        let energy = penalised.energy(load, value, |jump| jump_multipliers[jump].to_f64());
        let of_diagonal = |i: usize| penalised.stiffness_diagonal(i) * value(i).powi(2);
        let squared_rounding = (CORRECTION_MULTIPLE * T::EPSILON).powi(2);
        // A quarter of the digits of the scalar in the energy norm: single unknowns of thin cells may have fewer correct
        // digits. The second term is for constants, whose energy is zero.
        let of_constants = squared_rounding * (0..values.len()).map(of_diagonal).sum::<f64>();
        last.abs() > T::EPSILON.sqrt() * energy + of_constants
    }

    /// The residual of values and jump multipliers.
    fn residual(&self, Iterate { values, jump_multipliers, .. }: &Iterate<'_, T>) -> MixedVector {
        self.system.residual(|i| values[i].to_f64(), |jump| jump_multipliers[jump].to_f64())
    }
}

impl<T: Real> LinearSolver<T> for DirectSolver<'_, T> {
    fn set_eliminated(&mut self, eliminated: &[bool]) -> Result<(), End> {
        self.is_inactive.clear();
        self.is_inactive.extend(eliminated.iter().map(|eliminated| !eliminated));
        self.factors = None;
        self.factors = Some(self.system.factor(&self.is_inactive, &[], &mut None)?);
        Ok(())
    }

    /// Corrects the values [`CORRECTIONS`] times. With jump multipliers, which are corrected together with them, up to
    /// [`MAX_CORRECTIONS`] times, until a correction is rounding or its largest change is more than half of the preceding
    /// one.
    ///
    /// # Errors
    /// [`End::Singular`] if the energy of the last correction is not small: the matrix is then singular in the precision
    /// of the scalar.
    fn correct(&mut self, iterate: &mut Iterate<'_, T>, _accuracy: Accuracy) -> Result<(), End> {
        let Some(factors) = &self.factors else { return Err(End::Unsuitable) };
        iterate.jump_multipliers.resize(self.system.n_jumps(), T::lit(0.0));
        let (mut energies, mut previous_change) = (Vec::new(), f64::INFINITY);
        while energies.len() < MAX_CORRECTIONS {
            let mut correction = self.residual(iterate);
            energies.push(self.system.solve(factors, &self.is_inactive, &mut correction));
            let Iterate { values, jump_multipliers, .. } = &mut *iterate;
            let (mut max_change, mut max_norm) = (0.0_f64, 0.0_f64);
            for (x, change) in values.iter_mut().zip(&correction.values) {
                *x += T::lit(*change);
                max_change = max_change.max(change.abs());
                max_norm = max_norm.max(x.to_f64().abs());
            }
            for (multiplier, change) in
                jump_multipliers.iter_mut().zip(&correction.jump_multipliers)
            {
                *multiplier += T::lit(*change);
            }
            let is_small = max_change <= CORRECTION_MULTIPLE * T::EPSILON * max_norm;
            // false for numbers that are not finite
            let halves = max_change <= 0.5 * previous_change && !is_small;
            if energies.len() >= CORRECTIONS && (jump_multipliers.is_empty() || !halves) {
                break;
            }
            previous_change = max_change;
        }
        iterate.compute_residual_with_jump_multipliers();
        match self.is_inaccurate(iterate, &energies) {
            true => Err(End::Singular),
            false => Ok(()),
        }
    }

    fn residual_term_magnitudes(&self, i: usize, iterate: &Iterate<'_, T>) -> [f64; 2] {
        match &self.inequality.penalised {
            Some(penalised) => penalised.residual_term_magnitudes(
                (i, self.inequality.load[i]),
                |j| iterate.values[j].to_f64(),
                &iterate.jump_multipliers,
                |j| iterate.eliminated[j],
            ),
            None => iterate.residual_term_magnitudes(i),
        }
    }
}
