//! One cycle: sweeps of projected Gauss-Seidel and a truncated linear correction.

use std::borrow::Cow;

use crate::algebra::Inequality;
use crate::inequality::Outcome;
use crate::inequality::certificate::positive_diagonal;
use crate::inequality::certificate::scales::Scales;
use crate::inequality::initial_guess::InitialGuess;
use crate::linear::Preconditioner;
use crate::linear::direct::FactorError;
use crate::parallel::vectors::{for_each_chunk, map_chunks};
use crate::real::Real;

/// Sweeps of projected Gauss-Seidel before each linear correction.
const SWEEPS: usize = 2;

/// The iterate of monotone multigrid, whose values are admissible, with the vectors of a cycle.
pub(super) struct MultigridIterate<'a, T: Real> {
    pub inequality: &'a Inequality<T>,
    /// The load of the assembled matrix.
    load: Cow<'a, [T]>,
    pub values: Vec<T>,
    /// `b - A u`; zero on eliminated unknowns.
    residual: Vec<T>,
    /// The linear correction of the values.
    correction: Vec<T>,
    /// Whether an unknown is eliminated from the linear correction: fixed, or at a bound.
    eliminated: Vec<bool>,
    /// The value of `eliminated` for which the preconditioner is set up; empty if it is set up for no such value.
    pub eliminated_in_preconditioner: Vec<bool>,
    /// The name of the preconditioner, in reports.
    pub linear_solver: &'static str,
    /// The diagonal of the matrix.
    pub diagonal: Vec<T>,
    /// `b - A u` on all unknowns.
    full_residual: Vec<f64>,
    /// The energy norm of the values before the last correction; see [`Scales::energy_norm`].
    pub energy_norm: f64,
    pub cycles: usize,
    /// See [`Solution::algebraic_bound`](crate::inequality::Solution::algebraic_bound).
    pub algebraic_bound: Option<f64>,
}

impl<'a, T: Real> MultigridIterate<'a, T> {
    /// The values of the guess, or zero, projected onto the bounds.
    pub fn new(inequality: &'a Inequality<T>, guess: &InitialGuess<T>) -> Self {
        let n = inequality.bounds.len();
        let guess = guess.values.as_deref().filter(|values| values.len() == n);
        let start = |i: usize| guess.map_or(T::lit(0.0), |values| values[i]);
        let bounds = inequality.bounds.iter().enumerate();
        let values = bounds.map(|(i, bound)| bound.nearest(start(i))).collect();
        let zeros = vec![T::lit(0.0); n];
        Self {
            inequality,
            load: inequality.assembled_load(),
            values,
            residual: zeros.clone(),
            correction: zeros,
            eliminated: vec![false; n],
            eliminated_in_preconditioner: Vec::new(),
            linear_solver: "multigrid",
            diagonal: Vec::new(),
            full_residual: vec![0.0; n],
            energy_norm: 0.0,
            cycles: 0,
            algebraic_bound: None,
        }
    }

    /// One cycle: sweeps and a linear correction. Returns an estimate of the energy norm of the change of the values.
    ///
    /// # Errors
    /// [`Outcome::NotFinite`], and the outcomes of a sweep and of the correction that cannot be computed.
    pub fn cycle(&mut self, preconditioner: &mut dyn Preconditioner<T>) -> Result<f64, Outcome> {
        self.cycles += 1;
        // the bound is that of the values before this cycle
        self.algebraic_bound = None;
        let mut squared_change = 0.0;
        for _ in 0..SWEEPS {
            squared_change += self.gauss_seidel_sweep()?;
        }
        let squared_correction = self.correct(preconditioner)?;
        if !(self.energy_norm.is_finite() && squared_change.is_finite()) {
            return Err(Outcome::NotFinite);
        }
        Ok((squared_change + squared_correction).sqrt())
    }

    /// One sweep of projected Gauss-Seidel. Returns the sum of `d_i (change of u_i)^2`, an estimate
    /// of the square of the energy norm of the change.
    ///
    /// # Errors
    /// [`Outcome::NotCoercive`] for a diagonal entry that is not positive.
    fn gauss_seidel_sweep(&mut self) -> Result<f64, Outcome> {
        let Inequality { matrix, bounds, .. } = self.inequality;
        let mut sum = 0.0;
        for (i, (bound, &d)) in bounds.iter().zip(&self.diagonal).enumerate() {
            if bound.fixed_value().is_some() {
                continue;
            }
            if d <= T::lit(0.0) {
                return Err(Outcome::NotCoercive);
            }
            let residual = self.load[i] - matrix.row_dot(i, &self.values);
            let next = bound.nearest(self.values[i] + residual / d);
            let change = (next - self.values[i]).to_f64();
            sum += d.to_f64() * change * change;
            self.values[i] = next;
        }
        Ok(sum)
    }

    /// One linear correction of the unknowns that are not eliminated, with exact line search. Returns the square of the
    /// energy norm of the change; zero if nothing changes, because the coarsest matrix is singular, or the projected
    /// correction is no direction of descent or has no positive curvature.
    ///
    /// # Errors
    /// The outcome if the coarsest matrix has no factors.
    fn correct(&mut self, preconditioner: &mut dyn Preconditioner<T>) -> Result<f64, Outcome> {
        let Inequality { matrix, bounds, .. } = self.inequality;
        self.eliminate_active();
        if self.eliminated != self.eliminated_in_preconditioner {
            self.eliminated_in_preconditioner.clear();
            match preconditioner.set_fixed(&self.eliminated) {
                Ok(()) => {
                    self.eliminated_in_preconditioner.extend_from_slice(&self.eliminated);
                }
                // only the bounds prevent a rigid motion; the sweeps converge without the correction
                Err(FactorError::Singular) if bounds.iter().any(|bound| bound.is_inequality()) => {
                    return Ok(0.0);
                }
                // the whole matrix has been checked: a negative pivot is one of rounding
                Err(FactorError::NotPositive) => return Err(Outcome::Stalled),
                Err(error) => return Err(error.into()),
            }
        }
        preconditioner.apply(&self.residual, &mut self.correction);
        let (values, eliminated) = (&self.values, &self.eliminated);
        for_each_chunk(&mut self.correction, |range, correction| {
            for (i, correction) in range.zip(correction) {
                *correction = match eliminated[i] {
                    true => T::lit(0.0),
                    false => bounds[i].nearest(values[i] + *correction) - values[i],
                };
            }
        });
        let (residual, correction) = (&self.residual, &self.correction);
        let chunks = map_chunks(correction.len(), |range| {
            range.filter(|&i| !eliminated[i]).fold([0.0; 2], |[slope, curvature], i| {
                let step = correction[i].to_f64();
                let image = matrix.row_dot_f64(i, correction);
                [slope + residual[i].to_f64() * step, curvature + step * image]
            })
        });
        let (slope, curvature) =
            chunks.iter().fold((0.0, 0.0), |(a, b), [slope, curvature]| (a + slope, b + curvature));
        if slope <= 0.0 || curvature <= 0.0 {
            return Ok(0.0);
        }
        let length = T::lit((slope / curvature).min(self.ratio_test()));
        let correction = &self.correction;
        for_each_chunk(&mut self.values, |range, values| {
            for (i, value) in range.zip(values) {
                *value = bounds[i].nearest(*value + length * correction[i]);
            }
        });
        Ok(curvature * length.to_f64().powi(2))
    }

    /// Marks all unknowns that are fixed or at a bound as eliminated. Computes the energy norm of the values and the
    /// residual, which is zero on eliminated unknowns and `b - A u` on all others.
    fn eliminate_active(&mut self) {
        let inequality = self.inequality;
        inequality.residual_f64(&self.values, &mut self.full_residual);
        let diagonal = |i: usize| match self.diagonal[i].to_f64() {
            d if d > 0.0 => d,
            _ => positive_diagonal(inequality, i),
        };
        let residual = &self.full_residual;
        self.energy_norm =
            Scales::of(inequality, (&self.values, residual, &[]), &diagonal, T::PRECISION)
                .energy_norm;
        let (bounds, values) = (&inequality.bounds, &self.values);
        for_each_chunk(&mut self.eliminated, |range, eliminated| {
            for (i, eliminated) in range.zip(eliminated) {
                let (bound, x) = (&bounds[i], values[i]);
                *eliminated = bound.fixed_value().is_some()
                    || bound.lower().is_some_and(|l| x <= l)
                    || bound.upper().is_some_and(|u| x >= u);
            }
        });
        let (eliminated, full_residual) = (&self.eliminated, &self.full_residual);
        for_each_chunk(&mut self.residual, |range, residual| {
            for (i, residual) in range.zip(residual) {
                *residual = T::lit(if eliminated[i] { 0.0 } else { full_residual[i] });
            }
        });
    }

    /// The ratio test: the largest multiple of the projected correction that the bounds admit, at
    /// least one; infinite if no bound limits it.
    fn ratio_test(&self) -> f64 {
        let (bounds, values, correction) =
            (&self.inequality.bounds, &self.values, &self.correction);
        let chunks = map_chunks(values.len(), |range| {
            range.fold(f64::INFINITY, |longest, i| {
                let (x, step) = (values[i].to_f64(), correction[i].to_f64());
                match (bounds[i].lower(), bounds[i].upper()) {
                    (Some(l), _) if step < 0.0 => longest.min((l.to_f64() - x) / step),
                    (_, Some(u)) if step > 0.0 => longest.min((u.to_f64() - x) / step),
                    _ => longest,
                }
            })
        });
        chunks.into_iter().fold(f64::INFINITY, f64::min).max(1.0)
    }
}
