//! Truncated nonsmooth Newton multigrid: monotone, and indifferent to strict complementarity.

use super::certificate::certify;
use super::initial_guess::InitialGuess;
use super::{ActiveSet, InequalitySolver, Outcome, Solution, active_set};
use crate::algebra::{Contact, Inequality};
use crate::instances::compiled;
use crate::linear::CoarseSpaces;
use crate::linear::direct::factors::FactorError;
use crate::linear::precondition::coarse_level::CoarseLevel;
use crate::linear::precondition::multigrid::Multigrid;
use crate::real::Real;

/// The truncated nonsmooth Newton multigrid method (Graeser, Kornhuber, J. Comput. Math. 27 (2009)
/// 1-44; Graeser, Sack, Sander, Domain Decomposition Methods XVIII (2009) 129-136) for matrices
/// that are symmetric and positive definite.
///
/// One step is a sweep of projected Gauss-Seidel, a V-cycle for the correction of all unknowns off
/// their bounds, and an exact search along it as far as bounds admit. The energy never rises, and
/// the sweep alone would converge, so that the method does from any start (Glowinski 1984 for the
/// sweep). Coarse functions are cut off at the bounds. No step depends on which of gap and
/// multiplier vanish, and the number of steps hardly on the mesh as long as the start is near.
///
/// The coarser functions are those of [`InitialGuess`], or made from the matrix by aggregation: the
/// matrix should be that of conforming linear functions. For others it converges all the same,
/// slowly; matrices that are not symmetric go to [`ActiveSet`].
#[derive(Clone, Debug, PartialEq)]
pub struct MonotoneMultigrid {
    /// Most steps.
    pub max_cycles: usize,
    /// Sweeps before each linear correction.
    pub sweeps: usize,
    /// Energy norm of the last correction over that of the solution; `f32` stops at its rounding.
    pub tolerance: f64,
}

impl Default for MonotoneMultigrid {
    fn default() -> Self {
        Self { max_cycles: 200, sweeps: 2, tolerance: 1e-10 }
    }
}

impl<T: Real> InequalitySolver<T> for MonotoneMultigrid {
    fn name(&self) -> &'static str {
        "monotone-multigrid"
    }

    fn solve(&self, inequality: &Inequality<T>) -> Solution<T> {
        self.solve_from(inequality, &InitialGuess::default())
    }

    fn solve_from(&self, inequality: &Inequality<T>, nearby: &InitialGuess<T>) -> Solution<T> {
        compiled!(
            T: fn(&MonotoneMultigrid, &Inequality<T>, &InitialGuess<T>) -> Solution<T>
                = MonotoneMultigrid::descend
        )(self, inequality, nearby)
    }

    fn uses_coarse_spaces(&self, _unknowns: usize) -> bool {
        true
    }
}

impl MonotoneMultigrid {
    fn descend<T: Real>(
        &self,
        inequality: &Inequality<T>,
        nearby: &InitialGuess<T>,
    ) -> Solution<T> {
        if !inequality.symmetric {
            return ActiveSet::default().solve_from(inequality, nearby);
        }
        let mut descent = Descent::new(inequality, nearby);
        let outcome = match active_set::check_input(inequality) {
            Ok(()) => descent.run(self, nearby).unwrap_or_else(|outcome| outcome),
            Err(outcome) => outcome,
        };
        descent.into_solution(outcome)
    }
}

/// Admissible values on their way down.
struct Descent<'a, T> {
    inequality: &'a Inequality<T>,
    values: Vec<T>,
    /// `b - A u`, zero on bounds.
    force: Vec<T>,
    step: Vec<T>,
    fixed: Vec<bool>,
    cycles: usize,
}

impl<'a, T: Real> Descent<'a, T> {
    fn new(inequality: &'a Inequality<T>, nearby: &InitialGuess<T>) -> Self {
        let n = inequality.bounds.len();
        let near = nearby.values.as_deref().filter(|values| values.len() == n);
        let start = |i: usize| near.map_or(T::lit(0.0), |values| values[i]);
        let bounds = inequality.bounds.iter().enumerate();
        let values = bounds.map(|(i, bound)| bound.nearest(start(i))).collect();
        let zeros = vec![T::lit(0.0); n];
        Self {
            inequality,
            values,
            force: zeros.clone(),
            step: zeros,
            fixed: vec![false; n],
            cycles: 0,
        }
    }

    /// The error is the reason why it does not arrive.
    fn run(
        &mut self,
        settings: &MonotoneMultigrid,
        nearby: &InitialGuess<T>,
    ) -> Result<Outcome, Outcome> {
        let Inequality { matrix, bounds, .. } = self.inequality;
        let made = match nearby.functions {
            CoarseSpaces::CoarseLevel(_) => None,
            _ => {
                let given: Vec<bool> = bounds.iter().map(|b| b.only_value().is_some()).collect();
                CoarseLevel::aggregated(matrix, &given)
            }
        };
        let coarser = match &nearby.functions {
            CoarseSpaces::CoarseLevel(coarser) => Some(coarser),
            _ => made.as_ref(),
        };
        let mut multigrid = Multigrid::new(matrix, coarser);
        let least = nearby.accuracy.unwrap_or(0.0).max(4.0 * T::EPSILON);
        let tolerance = settings.tolerance.max(least);
        let limit = if nearby.accuracy.is_some() { f64::INFINITY } else { T::CERTIFICATE_LIMIT };
        while self.cycles < settings.max_cycles {
            self.cycles += 1;
            let mut swept = 0.0;
            for _ in 0..settings.sweeps {
                swept += self.sweep()?;
            }
            let corrected = self.correct(&mut multigrid)?;
            let energy = self.energy();
            if !(energy.is_finite() && swept.is_finite()) {
                return Err(Outcome::NotFinite);
            }
            if (swept + corrected).sqrt() <= tolerance * energy.sqrt()
                && certify(self.inequality, &self.values).largest() <= limit
            {
                return Ok(Outcome::Converged);
            }
        }
        Err(Outcome::IterationLimit)
    }

    /// One sweep of projected Gauss-Seidel; the square of the energy norm it moves by, roughly.
    fn sweep(&mut self) -> Result<f64, Outcome> {
        let Inequality { matrix, load, bounds, .. } = self.inequality;
        let mut moved = 0.0;
        for (i, bound) in bounds.iter().enumerate() {
            if bound.only_value().is_some() {
                continue;
            }
            let d = matrix.get(i, i);
            if d <= T::lit(0.0) {
                return Err(Outcome::NotCoercive);
            }
            let force = load[i] - matrix.row_dot(i, &self.values);
            let next = bound.nearest(self.values[i] + force / d);
            let change = (next - self.values[i]).to_f64();
            moved += d.to_f64() * change * change;
            self.values[i] = next;
        }
        Ok(moved)
    }

    /// One linear correction off the bounds; the square of the energy norm it moves by.
    fn correct(&mut self, multigrid: &mut Multigrid<'_, T>) -> Result<f64, Outcome> {
        let Inequality { matrix, load, bounds, .. } = self.inequality;
        for (i, bound) in bounds.iter().enumerate() {
            let x = self.values[i];
            self.fixed[i] = bound.only_value().is_some()
                || bound.lower().is_some_and(|l| x <= l)
                || bound.upper().is_some_and(|u| x >= u);
            let force = load[i].to_f64() - matrix.row_dot_f64(i, &self.values);
            self.force[i] = if self.fixed[i] { T::lit(0.0) } else { T::lit(force) };
        }
        match multigrid.fix(&self.fixed) {
            Ok(()) => {}
            // nothing but bounds holds the body: the sweep alone goes on
            Err(FactorError::Singular) if bounds.iter().any(|bound| bound.is_inequality()) => {
                return Ok(0.0);
            }
            Err(error) => return Err(error.into()),
        }
        multigrid.apply(&self.force, &mut self.step);
        for (i, step) in self.step.iter_mut().enumerate() {
            *step = if self.fixed[i] {
                T::lit(0.0)
            } else {
                bounds[i].nearest(self.values[i] + *step) - self.values[i]
            };
        }
        let (mut slope, mut curvature) = (0.0, 0.0);
        for (i, step) in self.step.iter().enumerate().filter(|(i, _)| !self.fixed[*i]) {
            slope += self.force[i].to_f64() * step.to_f64();
            curvature += step.to_f64() * matrix.row_dot_f64(i, &self.step);
        }
        if slope <= 0.0 {
            return Ok(0.0);
        }
        if curvature <= 0.0 {
            return Err(Outcome::NotCoercive);
        }
        let length = T::lit((slope / curvature).min(self.room()));
        for (value, (step, bound)) in self.values.iter_mut().zip(self.step.iter().zip(bounds)) {
            *value = bound.nearest(*value + length * *step);
        }
        Ok(curvature * length.to_f64().powi(2))
    }

    /// The longest multiple of the step that bounds admit; never less than one.
    fn room(&self) -> f64 {
        let mut room = f64::INFINITY;
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let (x, step) = (self.values[i].to_f64(), self.step[i].to_f64());
            match (bound.lower(), bound.upper()) {
                (Some(l), _) if step < 0.0 => room = room.min((l.to_f64() - x) / step),
                (_, Some(u)) if step > 0.0 => room = room.min((u.to_f64() - x) / step),
                _ => {}
            }
        }
        room.max(1.0)
    }

    /// The square of the energy norm, or that of the load where the values are zero.
    fn energy(&self) -> f64 {
        let Inequality { matrix, load, .. } = self.inequality;
        let values = self.values.iter().enumerate();
        let energy: f64 =
            values.map(|(i, x)| x.to_f64() * matrix.row_dot_f64(i, &self.values)).sum();
        if energy > 0.0 {
            return energy;
        }
        let loads = load.iter().enumerate();
        let sum: f64 =
            loads.map(|(i, b)| b.to_f64().powi(2) / matrix.get(i, i).to_f64().abs()).sum();
        if sum > 0.0 { sum } else { 1.0 }
    }

    fn into_solution(self, outcome: Outcome) -> Solution<T> {
        let bounds = self.inequality.bounds.iter().zip(&self.values);
        let contact = bounds
            .map(|(bound, x)| match (bound.lower(), bound.upper()) {
                (Some(l), _) if *x <= l => Contact::Lower,
                (_, Some(u)) if *x >= u => Contact::Upper,
                _ => Contact::Inactive,
            })
            .collect();
        Solution {
            values: self.values,
            contact,
            outcome,
            outer: self.cycles,
            linear: self.cycles,
            linear_solver: "multigrid",
            algebraic_bound: None,
            forces: Vec::new(),
        }
    }
}
