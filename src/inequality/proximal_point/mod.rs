//! The proximal point method with latent variables: proximal Galerkin for the algebraic inequality.
//!
//! | file | content |
//! |---|---|
//! | `mod` | [`ProximalPoint`] as a solver, the start, the steps and the end of a run |
//! | `latent` | the entropies of one and of two bounds |

mod latent;

use super::active_set::prescribed_value;
use super::certificate::violations::certify_with_rounding;
use super::certificate::{is_final, nearer_bound, positive_diagonal};
use super::history::Recorder;
use super::interior_point::NewtonSystem;
use super::recession::{press_onto_bounds, solve_with_kernel};
use super::validation::check;
use super::{InequalitySolver, InitialGuess, Outcome, Solution};
use crate::algebra::Inequality;
use crate::instances::compiled;
use crate::linear::direct::{DirectSystem, FactorError, MixedVector};
use crate::real::Real;
use latent::Latent;

/// Largest number of linear systems of a run.
const MAX_SYSTEMS: usize = 60;

/// The factor by which the weight grows from step to step, without a limit: with a limit the certificate is not reached.
const GROWTH: f64 = 4.0;

/// The number of steps by which the weight is ahead if there are starting values.
const STEPS_AHEAD: i32 = 6;

/// The least gap of starting values, times their first weight.
const LEAST_GAP: f64 = 1e-3;

/// The largest entry of the diagonal `D`, divided by the weight `w` of its unknown.
const PINNED: f64 = 1e15;

/// The latent variable proximal point method, known as proximal Galerkin, for comparison with the other solvers.
///
/// Step `k` minimises the energy plus a Bregman distance from the values before, divided by the weight `alpha`. With the
/// latent variable `psi`, of which the value is an increasing function `u(psi)` between the bounds, that is
/// `A u(psi) - b = w (psi_before - psi) / alpha`, `w` a diagonal: one Newton system a step, with `A` plus the diagonal
/// `w / (alpha u'(psi))`. Every step multiplies the weight by four. Where a step would release an unknown from its bound,
/// the gap grows by no more than the correction of that unknown. The method applies to every matrix whose symmetric
/// part is positive semidefinite, and starts from starting values, else from the solution without bounds. It ends as soon
/// as the values, those near bounds on these bounds, have a certificate within its limit (in single precision, whose limit
/// says little of forces, when another step no longer halves it); else after 60 systems, with the values of the smallest
/// certificate.
///
/// For symmetric matrices the steps, solved exactly, converge for every weight (G. Chen, M. Teboulle, SIAM J. Optim. 3
/// (1993) 538-543); for one Newton system a step there is no proof. Source of the method: B. Keith, T. M. Surowiec,
/// Found. Comput. Math. (2024), arXiv 2307.12444; there the entropy acts on functions, which makes a discretisation of
/// its own, here on the unknowns, so that the limit is the solution of the scheme.
///
/// Where gap and multiplier vanish together, the number of systems may grow with the mesh; with bounds at vertices of
/// over-penalised schemes the limit of systems may be reached. An inequality of one part of a mesh has the outcome
/// [`Outcome::Unsuitable`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProximalPoint;

impl<T: Real> InequalitySolver<T> for ProximalPoint {
    fn name(&self) -> &'static str {
        "proximal"
    }

    fn solve(&self, inequality: &Inequality<T>) -> Solution<T> {
        self.solve_from(inequality, &InitialGuess::default())
    }

    fn solve_from(&self, inequality: &Inequality<T>, guess: &InitialGuess<T>) -> Solution<T> {
        if inequality.is_in_parts() {
            return Solution::without_iterate(inequality, Outcome::Unsuitable);
        }
        compiled!(
            T: fn(&Inequality<T>, &InitialGuess<T>) -> Solution<T>
                = |inequality, guess| {
                    solve_with_kernel(inequality, guess, |inequality, recorder| {
                        run(inequality, guess, recorder)
                    })
                }
        )(inequality, guess)
    }
}

fn run<T: Real>(
    inequality: &Inequality<T>,
    guess: &InitialGuess<T>,
    recorder: &Recorder<'_>,
) -> Solution<T> {
    if let Err(outcome) = check(inequality) {
        return Solution::without_iterate(inequality, outcome);
    }
    let system = DirectSystem::new(inequality);
    let system = NewtonSystem::new(inequality, &system);
    let mut iterate = match ProximalIterate::start(inequality, system, guess) {
        Ok(iterate) => iterate,
        Err(error) => return Solution::without_iterate(inequality, error.into()),
    };
    recorder.begin_step();
    let mut before = f64::INFINITY;
    let outcome = loop {
        recorder.end_step(|| iterate.certificate);
        match is_final::<T>(iterate.best.2, before, iterate.certificate) {
            true => break Outcome::Converged,
            // no bound is violated, so that no system differs from the first one
            false if iterate.weight.is_infinite() => break Outcome::Stalled,
            false if iterate.systems >= MAX_SYSTEMS => break Outcome::IterationLimit,
            false => recorder.begin_step(),
        }
        before = iterate.certificate;
        if let Err(outcome) = iterate.step() {
            break outcome;
        }
    };
    iterate.into_solution(outcome)
}

/// The latent variable of an unknown that is not fixed and has bounds.
struct LatentUnknown {
    unknown: usize,
    latent: Latent,
    /// The weight `w` of the entropy.
    scale: f64,
    /// The entry of `A` on the diagonal.
    diagonal: f64,
}

impl LatentUnknown {
    /// The entry of `D`.
    fn shift(&self, weight: f64) -> f64 {
        (self.scale / (weight * self.latent.slope())).min(PINNED * self.scale)
    }

    /// Changes the latent variable, after the Newton system has changed the value by `change` and left the residual.
    fn advance(&mut self, change: f64, residual: f64, weight: f64) {
        let is_pinned = self.shift(weight) > self.scale;
        // of a pinned unknown the linearisation says nothing, and the optimality condition says it exactly
        let by = match is_pinned {
            true => weight * residual / self.scale,
            false => change / self.latent.slope(),
        };
        let gauss_seidel = if is_pinned { residual.abs() / self.diagonal } else { 0.0 };
        self.latent.advance(by, (self.latent.gap() + change.abs()).max(gauss_seidel));
    }
}

/// The unknowns that are not fixed and have bounds.
fn latent_unknowns<T: Real>(
    inequality: &Inequality<T>,
    system: &NewtonSystem<'_, '_, T>,
) -> Vec<LatentUnknown> {
    let with_bounds = |(unknown, bound)| {
        let latent = Latent::of(bound)?;
        let scale = system.diagonal_scale(unknown);
        let diagonal = positive_diagonal(inequality, unknown);
        Some(LatentUnknown { unknown, latent, scale, diagonal })
    };
    inequality.bounds.iter().enumerate().filter_map(with_bounds).collect()
}

/// The point of a run.
struct ProximalIterate<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    system: NewtonSystem<'h, 'a, T>,
    /// The values, which need not be admissible, and the jump multipliers, after the last system.
    point: MixedVector,
    latent: Vec<LatentUnknown>,
    /// The weight of the next step; infinite if the solution without bounds violates none.
    weight: f64,
    /// Number of linear systems.
    systems: usize,
    /// The admissible values with the smallest certificate, their jump multipliers, and the largest of its numbers.
    best: (Vec<T>, Vec<T>, f64),
    /// The largest of the numbers of the certificate of the last admissible values.
    certificate: f64,
}

impl<'h, 'a, T: Real> ProximalIterate<'h, 'a, T> {
    /// The solution without bounds, and the latent variables of the starting values, if there are any, else of this
    /// solution, with gaps that are at least its largest violation of a bound.
    fn start(
        inequality: &'a Inequality<T>,
        mut system: NewtonSystem<'h, 'a, T>,
        guess: &InitialGuess<T>,
    ) -> Result<Self, FactorError> {
        let (point, is_regular) = system.solve_without_bounds()?;
        let latent = latent_unknowns(inequality, &system);
        let best = (Vec::new(), Vec::new(), f64::INFINITY);
        let (weight, certificate) = (f64::INFINITY, f64::INFINITY);
        let mut iterate =
            Self { inequality, system, point, latent, weight, systems: 1, best, certificate };
        let residual = iterate.system.residual(&iterate.point);
        iterate.keep_if_best(&residual.values);
        let violation = iterate.set_weight(is_regular);
        match guess.values.as_ref().filter(|values| values.len() == inequality.size()) {
            Some(values) => iterate.begin_at(values),
            None => iterate.set_latent_variables(violation),
        }
        Ok(iterate)
    }

    /// Sets the first weight from the correction `p` of the values onto their bounds, or onto the admissible values
    /// nearest to zero where the matrix is singular: `max |p_i|` times the sum of the scales over the unknowns with `p_i`
    /// not zero, divided by `p.A p`. With it changes of latent variables are of size one. Returns `max |p_i|`.
    fn set_weight(&mut self, is_regular: bool) -> f64 {
        let mut correction = vec![0.0; self.inequality.size()];
        let (mut largest, mut scales, mut energy) = (0.0_f64, 0.0, 0.0);
        for LatentUnknown { unknown, scale, .. } in &self.latent {
            let x = self.point.values[*unknown];
            let target = T::lit(if is_regular { x } else { 0.0 });
            let p = self.inequality.bounds[*unknown].nearest(target).to_f64() - x;
            correction[*unknown] = p;
            if p != 0.0 {
                largest = largest.max(p.abs());
                scales += scale;
                energy += if is_regular { 0.0 } else { scale * p * p };
            }
        }
        energy += self.system.energy(&correction);
        self.weight = if largest > 0.0 { largest * scales / energy } else { f64::INFINITY };
        largest
    }

    /// Begins at given values, several steps ahead.
    fn begin_at(&mut self, values: &[T]) {
        let given = self.point.values.iter_mut().zip(values).zip(&self.inequality.bounds);
        given.for_each(|((x, &value), bound)| *x = bound.nearest(value).to_f64());
        self.weight *= GROWTH.powi(STEPS_AHEAD);
        self.set_latent_variables(LEAST_GAP / self.weight);
    }

    /// Sets the latent variables to those of the values, or of values with the gap `least` that are nearer to a bound.
    fn set_latent_variables(&mut self, least: f64) {
        for LatentUnknown { unknown, latent, .. } in &mut self.latent {
            latent.set_value(self.point.values[*unknown], least);
        }
    }

    /// One step: a Newton system, the next latent variables, the next weight.
    ///
    /// # Errors
    /// The reason if the matrix has no factors; [`Outcome::NotFinite`] if a number is not finite.
    fn step(&mut self) -> Result<(), Outcome> {
        self.systems += 1;
        let mut diagonal = vec![0.0; self.inequality.size()];
        for of in &self.latent {
            self.point.values[of.unknown] = of.latent.value();
            diagonal[of.unknown] = of.shift(self.weight);
        }
        let factors = self.system.factor_held(&mut diagonal)?;
        let mut change = self.system.residual(&self.point);
        self.system.solve(&factors, &mut change);
        let add = |x: &mut [f64], by: &[f64]| x.iter_mut().zip(by).for_each(|(x, by)| *x += by);
        add(&mut self.point.values, &change.values);
        add(&mut self.point.jump_multipliers, &change.jump_multipliers);
        let residual = self.system.residual(&self.point).values;
        for of in &mut self.latent {
            of.advance(change.values[of.unknown], residual[of.unknown], self.weight);
        }
        let is_finite = |x: &f64| x.is_finite();
        let mut latent = self.latent.iter().map(|of| of.latent.psi);
        if !(self.point.values.iter().all(is_finite) && latent.all(f64::is_finite)) {
            return Err(Outcome::NotFinite);
        }
        self.weight *= GROWTH;
        self.keep_if_best(&residual);
        Ok(())
    }

    /// Projects the values onto their bounds, and onto the nearer bound those whose gap is at most the Gauss-Seidel step
    /// by the residual of the point; keeps them if their certificate is the smallest so far.
    fn keep_if_best(&mut self, residual: &[f64]) {
        let bounds = self.inequality.bounds.iter().zip(&self.point.values);
        let mut values: Vec<T> = bounds.map(|(bound, &x)| bound.nearest(T::lit(x))).collect();
        for LatentUnknown { unknown, diagonal, .. } in &self.latent {
            let (bound, x) = (&self.inequality.bounds[*unknown], &mut values[*unknown]);
            let (side, gap, step) = nearer_bound(bound, x.to_f64(), -residual[*unknown] / diagonal);
            if gap <= step {
                *x = prescribed_value(bound, side).unwrap_or(*x);
            }
        }
        press_onto_bounds(self.inequality, &mut values);
        let multipliers: Vec<T> = self.point.jump_multipliers.iter().map(|&p| T::lit(p)).collect();
        let certificate = certify_with_rounding(self.inequality, &values, &multipliers).0.largest();
        self.certificate = certificate;
        if certificate < self.best.2 {
            self.best = (values, multipliers, certificate);
        }
    }

    fn into_solution(self, outcome: Outcome) -> Solution<T> {
        let (values, multipliers, certificate) = self.best;
        let outcome =
            if certificate <= T::CERTIFICATE_LIMIT { Outcome::Converged } else { outcome };
        let solution = match certificate.is_finite() {
            true => Solution::of_values(self.inequality, values, multipliers, outcome),
            false => Solution::without_iterate(self.inequality, outcome),
        };
        solution.iterations(self.systems, 0)
    }
}
