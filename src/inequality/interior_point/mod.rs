//! A primal-dual interior point method: the predictor-corrector method of Mehrotra.
//!
//! | file | content |
//! |---|---|
//! | `mod` | [`InteriorPoint`] as a solver, the steps and the end of a run |
//! | `start` | the point from which a run starts |
//! | `bound_pairs` | slack and dual variable of every bound, the ratio test |
//! | `newton_system` | the linear systems |

mod bound_pairs;
mod newton_system;
mod start;

use super::certificate::is_final;
use super::certificate::violations::certify_with_rounding;
use super::history::Recorder;
use super::recession::{press_onto_bounds, solve_with_kernel};
use super::validation::check;
use super::{ActiveSet, InequalitySolver, InitialGuess, Outcome, Solution};
use crate::algebra::Inequality;
use crate::instances::compiled;
use crate::linear::direct::{DirectSystem, MixedVector, SystemFactors};
use crate::real::Real;
use bound_pairs::{BoundPair, mean_product, ratio_test};
pub(super) use newton_system::NewtonSystem;

/// Largest number of linear systems of a run. Runs of the file of figures take 13 in the mean and 24 at
/// most.
pub(crate) const MAX_SYSTEMS: usize = 60;

/// Fraction of the distance to the first zero of a slack or dual variable that a step takes.
const STEP_FRACTION: f64 = 0.995;

/// Largest number of further correctors of a step, each a solution with the factors at hand. On cone-2d, `wopsip`, at 64
/// a run takes 15 systems with them and 23 without.
const MAX_CORRECTORS: usize = 5;

/// The factor by which another corrector must lengthen the step.
const LEAST_GAIN: f64 = 1.01;

/// The predictor-corrector method of Mehrotra (SIAM J. Optim. 2 (1992) 575-601) for
/// `A u - b = z_lower - z_upper` with the dual variables `z` of the bounds.
///
/// Slacks are unknowns beside `u`, so that the start may violate bounds. Every step factors `A` plus a positive
/// diagonal, solves for a predictor, a corrector, and further correctors (Carpenter, Lustig, Mulvey, Shanno, SIAM J.
/// Optim. 3 (1993) 696-725) while these lengthen it, and goes almost to the first zero of a slack or dual variable.
/// The method applies to every
/// matrix whose symmetric part is positive semidefinite. It ends as soon as the values, those of
/// active bounds on these bounds, have a certificate within its limit; in single precision, whose limit says little of
/// forces, when another step no longer halves it. Linear systems are solved with factors.
///
/// [`ActiveSet`] runs this method where its active set stagnates, and begins anew from the contact states at its end.
///
/// Where the matrix is a [`PenalisedMatrix`](crate::algebra::PenalisedMatrix) `K + M^T S M`, the jump multipliers
/// `p = S (M u - g)` are unknowns too, whose residual has no sum of a penalty weight and a stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InteriorPoint;

impl<T: Real> InequalitySolver<T> for InteriorPoint {
    fn name(&self) -> &'static str {
        "interior-point"
    }

    fn solve(&self, inequality: &Inequality<T>) -> Solution<T> {
        self.solve_from(inequality, &InitialGuess::default())
    }

    /// Solves the inequality; starting values have no effect. [`ActiveSet`] solves the inequality of one part of a
    /// mesh.
    fn solve_from(&self, inequality: &Inequality<T>, guess: &InitialGuess<T>) -> Solution<T> {
        if inequality.is_in_parts() {
            return ActiveSet::default().solve_from(inequality, guess);
        }
        compiled!(
            T: fn(&Inequality<T>, &InitialGuess<T>) -> Solution<T>
                = |inequality, guess| solve_with_kernel(inequality, guess, checked_run)
        )(inequality, guess)
    }
}

fn checked_run<T: Real>(inequality: &Inequality<T>, recorder: &Recorder<'_>) -> Solution<T> {
    if let Err(outcome) = check(inequality) {
        return Solution::without_iterate(inequality, outcome);
    }
    run(inequality, &DirectSystem::new(inequality), MAX_SYSTEMS, recorder)
}

/// A run with at most so many linear systems.
pub(super) fn run<'a, T: Real>(
    inequality: &'a Inequality<T>,
    system: &DirectSystem<'a, T>,
    max_systems: usize,
    recorder: &Recorder<'_>,
) -> Solution<T> {
    let system = NewtonSystem::new(inequality, system);
    let mut iterate = match InteriorIterate::start(inequality, system) {
        Ok(iterate) => iterate,
        Err(error) => return Solution::without_iterate(inequality, error.into()),
    };
    recorder.begin_step();
    let mut before = f64::INFINITY;
    let outcome = loop {
        let certificate = iterate.keep_if_best();
        recorder.end_step(|| certificate);
        let smallest = iterate.best.as_ref().map_or(f64::INFINITY, |best| best.2);
        if is_final::<T>(smallest, before, certificate) {
            break Outcome::Converged;
        }
        if iterate.systems >= max_systems {
            break Outcome::IterationLimit;
        }
        before = certificate;
        recorder.begin_step();
        if let Err(outcome) = iterate.step() {
            break outcome;
        }
    };
    iterate.into_solution(outcome)
}

/// The point of a run.
struct InteriorIterate<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    system: NewtonSystem<'h, 'a, T>,
    point: MixedVector,
    pairs: Vec<BoundPair>,
    /// Number of linear systems.
    systems: usize,
    /// Values, jump multipliers and certificate of the step with the smallest certificate within its limit.
    best: Option<(Vec<T>, Vec<T>, f64)>,
}

impl<T: Real> InteriorIterate<'_, '_, T> {
    /// One step with its predictor and corrector.
    ///
    /// # Errors
    /// The reason if the matrix has no factors; [`Outcome::Stalled`] if the step is not finite or has length zero.
    fn step(&mut self) -> Result<(), Outcome> {
        self.systems += 1;
        let mut diagonal = vec![0.0; self.point.values.len()];
        for pair in &self.pairs {
            diagonal[pair.unknown] += pair.dual / pair.slack;
        }
        let factors = self.system.factor_held(&mut diagonal)?;
        let mut residual = self.system.residual(&self.point);
        for pair in &self.pairs {
            residual.values[pair.unknown] += pair.side * pair.dual;
        }
        let mean = mean_product(&self.pairs, 0.0);
        self.direct(&factors, residual.clone(), |pair| -pair.slack * pair.dual);
        let predicted = mean_product(&self.pairs, ratio_test(&self.pairs));
        // Mehrotra's centring: the cube of the reduction that the predictor achieves
        let target = mean * (predicted / mean).powi(3);
        let correct =
            |pair: &BoundPair| target - pair.slack * pair.dual - pair.change[0] * pair.change[1];
        let mut direction = self.direct(&factors, residual.clone(), correct);
        let mut longest = ratio_test(&self.pairs);
        for _ in 0..MAX_CORRECTORS {
            let changes: Vec<[f64; 2]> = self.pairs.iter().map(|pair| pair.change).collect();
            let corrected = self.direct(&factors, residual.clone(), correct);
            let length = ratio_test(&self.pairs);
            if length <= LEAST_GAIN * longest {
                self.pairs.iter_mut().zip(changes).for_each(|(pair, change)| pair.change = change);
                break;
            }
            (direction, longest) = (corrected, length);
        }
        let length = if longest < 1.0 { STEP_FRACTION * longest } else { 1.0 };
        if length <= 0.0 || !mean_product(&self.pairs, length).is_finite() {
            return Err(Outcome::Stalled);
        }
        let advance = |x: &mut [f64], by: &[f64]| {
            x.iter_mut().zip(by).for_each(|(x, by)| *x += length * by);
        };
        advance(&mut self.point.values, &direction.values);
        advance(&mut self.point.jump_multipliers, &direction.jump_multipliers);
        self.pairs.iter_mut().for_each(|pair| pair.advance(length));
        Ok(())
    }

    /// The Newton direction for the residual `b - A u + z_lower - z_upper`, with which the product of each slack and
    /// dual variable changes by `product_change`, up to the product of their changes: the solution of
    /// `(A + D) w = r + sum side (product_change - dual g) / slack`, where `g` is the gap less the slack, and the sum is
    /// over the bounds of an unknown. Sets the changes of the pairs.
    fn direct(
        &mut self,
        factors: &SystemFactors<T>,
        mut right: MixedVector,
        product_change: impl Fn(&BoundPair) -> f64,
    ) -> MixedVector {
        let Self { system, point, pairs, .. } = self;
        let excess = |pair: &BoundPair| pair.gap(point.values[pair.unknown]) - pair.slack;
        for pair in pairs.iter() {
            let term = (product_change(pair) - pair.dual * excess(pair)) / pair.slack;
            right.values[pair.unknown] += pair.side * term;
        }
        system.solve(factors, &mut right);
        for pair in pairs.iter_mut() {
            let slack_change = pair.side * right.values[pair.unknown] + excess(pair);
            pair.set_change(slack_change, product_change(pair));
        }
        right
    }

    /// Admissible values. They lie on the bounds whose dual variables exceed the slacks times the diagonal entries, and
    /// on the bounds that they would violate.
    fn values(&self) -> Vec<T> {
        let bounds = &self.inequality.bounds;
        let values = bounds.iter().zip(&self.point.values);
        let mut values: Vec<T> = values.map(|(bound, &x)| bound.nearest(T::lit(x))).collect();
        for pair in &self.pairs {
            if pair.dual > self.system.diagonal_scale(pair.unknown) * pair.slack {
                values[pair.unknown] = T::lit(pair.bound);
            }
        }
        press_onto_bounds(self.inequality, &mut values);
        values
    }

    fn jump_multipliers(&self) -> Vec<T> {
        self.point.jump_multipliers.iter().map(|&p| T::lit(p)).collect()
    }

    /// Keeps the present values if their certificate is within its limit and the smallest so far; returns the largest
    /// number of the certificate.
    fn keep_if_best(&mut self) -> f64 {
        let (values, multipliers) = (self.values(), self.jump_multipliers());
        let certificate = certify_with_rounding(self.inequality, &values, &multipliers).0.largest();
        let smallest = self.best.as_ref().map_or(T::CERTIFICATE_LIMIT, |best| best.2);
        if certificate <= smallest {
            self.best = Some((values, multipliers, certificate));
        }
        certificate
    }

    /// The solution: the best values if they are within the limit of the certificate, whatever ended the run.
    fn into_solution(mut self, outcome: Outcome) -> Solution<T> {
        let (values, multipliers, outcome) = match self.best.take() {
            Some((values, multipliers, _)) => (values, multipliers, Outcome::Converged),
            None => (self.values(), self.jump_multipliers(), outcome),
        };
        Solution::of_values(self.inequality, values, multipliers, outcome)
            .iterations(self.systems, 0)
    }
}
