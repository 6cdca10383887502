//! The active set method with inexact linear solutions: no factors of the matrix.

use super::active_set::ActiveSet;
use super::conjugate_gradients::{ConjugateGradients, End, Preconditioner, Run, Stop, dot};
use super::cycles::key_of;
use super::iterate::{known_value, rest};
use super::linear::FactorError;
use super::nearby::Nearby;
use super::pieces::{each_mut, map, map_mut};
use super::preconditioners::Preconditioners;
use super::{Outcome, Solution};
use crate::algebra::{Bound, Contact, Inequality, Start};
use crate::real::Real;

/// Most iterations for one linear system.
const MOST_ITERATIONS: usize = 500;

/// Fewer changes of state than this hardly change the error: the next system is solved well.
const FEW: usize = 16;

/// Most times a system is solved again because of rounding.
const MOST_REPEATS: usize = 3;

/// The smallest Ritz value is this much larger, at most, than the smallest eigenvalue.
const RITZ: f64 = 0.9;

/// The current iterate.
pub(super) struct Inexact<'a, T> {
    inequality: &'a Inequality<T>,
    pub values: Vec<T>,
    pub state: Vec<Contact>,
    /// Whether an unknown has a known value: a Dirichlet datum or a bound it rests on.
    fixed: Vec<bool>,
    diagonal: Vec<T>,
    /// `b - A u`, zero where fixed while linear systems are solved.
    residual: Vec<T>,
    fingerprint: u128,
    seen: Vec<u128>,
    pub outer: usize,
    pub linear: usize,
    /// Smallest Ritz value so far.
    lowest: f64,
    /// Energy norm of the iterate.
    energy: f64,
    /// Preconditioned norm of the residual after the last linear system.
    norm: f64,
}

/// What a look at the whole iterate tells.
#[derive(Default)]
struct Look {
    flips: Vec<(u32, Contact)>,
    /// Largest violation of a bound.
    violation: f64,
    /// Largest displacement.
    scale: f64,
    /// Dual norm of the multipliers of wrong sign, and of the residual off contact.
    wrong: f64,
    off_contact: f64,
    /// Energy norm.
    energy: f64,
}

impl Look {
    /// Whether bounds and signs of multipliers hold to a tolerance.
    fn holds_to(&self, tolerance: f64) -> bool {
        self.violation <= tolerance * self.scale && self.wrong <= tolerance * self.energy
    }

    /// How far the active set is from a solution.
    fn merit(&self) -> f64 {
        self.violation / self.scale + self.wrong / self.energy
    }
}

impl<'a, T: Real> Inexact<'a, T> {
    pub fn new(inequality: &'a Inequality<T>, nearby: &Nearby<T>) -> Self {
        let Inequality { bounds, matrix, start, .. } = inequality;
        let n = inequality.size();
        let guess = match start {
            Start::Cold => &[],
            Start::Contact(guess) => guess.as_slice(),
        };
        let state: Vec<Contact> =
            (0..n).map(|i| rest(&bounds[i], guess.get(i).copied().unwrap_or_default())).collect();
        let near = nearby.values.as_deref().filter(|v| v.len() == n);
        let values =
            (0..n).map(|i| bounds[i].nearest(near.map_or(T::lit(0.0), |v| v[i]))).collect();
        let fingerprint =
            state.iter().enumerate().fold(0, |sum: u128, (i, &c)| sum.wrapping_add(key_of(i, c)));
        let mut iterate = Self {
            inequality,
            values,
            state,
            fixed: vec![false; n],
            diagonal: matrix.diagonal(),
            residual: vec![T::lit(0.0); n],
            fingerprint,
            seen: vec![fingerprint],
            outer: 0,
            linear: 0,
            lowest: 1.0,
            energy: 1.0,
            norm: f64::INFINITY,
        };
        iterate.rest_on_bounds();
        iterate
    }

    /// Solves; `None` where the method does not apply or did not get far enough, and factors may.
    pub fn run(mut self, settings: &ActiveSet, nearby: &Nearby<T>) -> Result<Solution<T>, Self> {
        let Some(functions) = Preconditioners::functions(self.inequality, nearby) else {
            return Err(self);
        };
        let Some(mut preconditioner) = Preconditioners::new(self.inequality, &functions) else {
            return Err(self);
        };
        match self.iterate(settings, nearby, &mut preconditioner) {
            Some(outcome) => Ok(self.into_solution(outcome, &mut preconditioner)),
            None => Err(self),
        }
    }

    /// `None` if it does not get anywhere.
    fn iterate(
        &mut self,
        settings: &ActiveSet,
        nearby: &Nearby<T>,
        preconditioner: &mut Preconditioners<'_, T>,
    ) -> Option<Outcome> {
        let tolerance = nearby.accuracy.unwrap_or(0.0).max(0.1 * T::CERTIFICATE_LIMIT);
        // a residual by itself says little: where the answer need not be good it is not asked for
        let limit = if nearby.accuracy.is_some() { f64::INFINITY } else { T::CERTIFICATE_LIMIT };
        let mut gradients = ConjugateGradients::new(self.inequality.size());
        self.energy = self.look(settings.band).energy;
        let is_linear = !self.inequality.bounds.iter().any(Bound::is_inequality);
        let (mut settled, mut refresh) = (is_linear, true);
        let mut careful = false;
        let (mut best, mut idle, mut repeats) = (f64::INFINITY, 0, 0);
        loop {
            if refresh {
                if self.outer >= settings.max_outer {
                    return Some(Outcome::IterationLimit);
                }
                self.outer += 1;
                match preconditioner.fix(&self.fixed) {
                    Ok(()) => {}
                    Err(FactorError::OutOfMemory) => return Some(Outcome::OutOfMemory),
                    // factors of the whole matrix tell why
                    Err(_) => return None,
                }
            }
            let stop = Stop {
                norm: tolerance * self.energy,
                share: if settled || careful { 0.0 } else { preconditioner.share() },
                iterations: MOST_ITERATIONS,
            };
            let run = self.solve_linear(&mut gradients, preconditioner, stop);
            match run.end {
                End::Reached => {}
                End::NotPositive => return Some(Outcome::NotCoercive),
                End::NotFinite => return Some(Outcome::NotFinite),
                End::Limit => return None,
            }
            let look = self.look(settings.band);
            if !(look.energy.is_finite() && look.scale.is_finite()) {
                return Some(Outcome::NotFinite);
            }
            self.energy = look.energy;
            self.norm = run.last;
            let is_exact = run.last <= 1.01 * tolerance * self.energy;
            if is_exact && (look.flips.is_empty() || look.holds_to(tolerance)) {
                if look.off_contact <= limit * self.energy {
                    return Some(Outcome::Converged);
                }
                // rounding has driven apart the residual and what the iteration thinks it is
                repeats += 1;
                if repeats > MOST_REPEATS {
                    return Some(Outcome::Stalled);
                }
            }
            refresh = !look.flips.is_empty();
            settled = !refresh;
            if refresh {
                settled = self.has_returned(&look.flips) || look.flips.len() < FEW;
                let merit = look.merit();
                idle = if merit < best { 0 } else { idle + 1 };
                best = best.min(merit);
                if idle > settings.patience {
                    if careful {
                        return None;
                    }
                    // perhaps the active set wanders because systems are solved too badly
                    (careful, idle) = (true, 0);
                }
                self.flip(&look.flips);
            }
        }
    }

    /// One linear system, from the iterate as it is.
    fn solve_linear(
        &mut self,
        gradients: &mut ConjugateGradients<T>,
        preconditioner: &mut dyn Preconditioner<T>,
        stop: Stop,
    ) -> Run {
        let fixed = &self.fixed;
        each_mut(&mut self.residual, |range, r| {
            for (r, &fixed) in r.iter_mut().zip(&fixed[range]) {
                if fixed {
                    *r = T::lit(0.0);
                }
            }
        });
        let iterate = (&mut self.values[..], &mut self.residual[..]);
        let run =
            gradients.solve(&self.inequality.matrix, &self.fixed, preconditioner, iterate, stop);
        self.linear += run.iterations;
        if let Some((low, _)) = run.ritz {
            self.lowest = self.lowest.min(low);
        }
        run
    }

    /// Computes the residual anew and judges every unknown.
    fn look(&mut self, band: f64) -> Look {
        let Inequality { matrix, load, .. } = self.inequality;
        let values = &self.values;
        let sizes = map_mut(&mut self.residual, |range, r| {
            let (mut energy, mut scale) = (0.0, 0.0_f64);
            for (i, r) in range.zip(r) {
                let (x, b) = (values[i].to_f64(), load[i].to_f64());
                let residual = b - matrix.row_dot_f64(i, values);
                *r = T::lit(residual);
                energy += x * (b - residual);
                scale = scale.max(x.abs());
            }
            (energy, scale)
        });
        let mut look = Look::default();
        for (energy, scale) in sizes {
            look.energy += energy;
            look.scale = look.scale.max(scale);
        }
        look.scale = if look.scale > 0.0 { look.scale } else { 1.0 };
        let noise = band * T::EPSILON * look.scale;
        let parts = map(values.len(), |range| {
            let mut part = Look::default();
            range.for_each(|i| self.judge(i, noise, band, &mut part));
            part
        });
        for part in parts {
            look.flips.extend(part.flips);
            look.violation = look.violation.max(part.violation);
            look.wrong += part.wrong;
            look.off_contact += part.off_contact;
        }
        look.wrong = look.wrong.sqrt();
        look.off_contact = look.off_contact.sqrt();
        look.energy = if look.energy > 0.0 { look.energy.sqrt() } else { self.load_energy() };
        look
    }

    #[inline(always)]
    fn judge(&self, i: usize, noise: f64, band: f64, look: &mut Look) {
        let bound = &self.inequality.bounds[i];
        if let Bound::Fixed(_) = bound {
            return;
        }
        let (x, r) = (self.values[i].to_f64(), self.residual[i].to_f64());
        let d = self.diagonal[i].to_f64();
        let pull = match self.state[i] {
            Contact::Open => {
                look.off_contact += r * r / d;
                let below = bound.lower().map_or(0.0, |l| l.to_f64() - x);
                let above = bound.upper().map_or(0.0, |u| x - u.to_f64());
                if below > noise {
                    look.flips.push((i as u32, Contact::Lower));
                    look.violation = look.violation.max(below);
                } else if above > noise {
                    look.flips.push((i as u32, Contact::Upper));
                    look.violation = look.violation.max(above);
                }
                return;
            }
            _ if bound.only_value().is_some() => return,
            Contact::Lower => r,
            Contact::Upper => -r,
        };
        if pull > 0.0 {
            look.wrong += pull * pull / d;
            if pull > self.force_noise(i, band) {
                look.flips.push((i as u32, Contact::Open));
            }
        }
    }

    /// The size of rounding in the force on an unknown.
    fn force_noise(&self, i: usize, band: f64) -> f64 {
        let (columns, entries) = self.inequality.matrix.row(i);
        let mut sum = self.inequality.load[i].to_f64().abs();
        for (&j, a) in columns.iter().zip(entries) {
            sum += (a.to_f64() * self.values[j as usize].to_f64()).abs();
        }
        band * T::EPSILON * sum
    }

    /// The energy that the load could raise, roughly: a scale where nothing else gives one.
    fn load_energy(&self) -> f64 {
        let terms = self.inequality.load.iter().zip(&self.diagonal);
        let sum: f64 =
            terms.map(|(b, d)| b.to_f64().powi(2) / d.to_f64().abs().max(f64::MIN_POSITIVE)).sum();
        if sum > 0.0 { sum.sqrt() } else { 1.0 }
    }

    /// Whether the active set after these flips has been there before.
    fn has_returned(&mut self, flips: &[(u32, Contact)]) -> bool {
        for &(i, contact) in flips {
            let before = self.state[i as usize];
            self.fingerprint = self
                .fingerprint
                .wrapping_sub(key_of(i as usize, before))
                .wrapping_add(key_of(i as usize, contact));
        }
        let returned = self.seen.contains(&self.fingerprint);
        self.seen.push(self.fingerprint);
        returned
    }

    /// Changes states, puts unknowns on their bounds and keeps the residual up to date.
    fn flip(&mut self, flips: &[(u32, Contact)]) {
        for &(i, contact) in flips {
            let i = i as usize;
            self.state[i] = contact;
            let known = known_value(&self.inequality.bounds[i], contact);
            self.fixed[i] = known.is_some();
            if let Some(value) = known {
                let change = value - self.values[i];
                self.values[i] = value;
                let (columns, entries) = self.inequality.matrix.row(i);
                for (&j, &a) in columns.iter().zip(entries) {
                    self.residual[j as usize] -= a * change;
                }
            }
        }
    }

    fn rest_on_bounds(&mut self) {
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let known = known_value(bound, self.state[i]);
            self.fixed[i] = known.is_some();
            if let Some(value) = known {
                self.values[i] = value;
            }
        }
    }

    /// The solution, with a bound on its energy error if it converged.
    fn into_solution(
        mut self,
        outcome: Outcome,
        preconditioner: &mut Preconditioners<'_, T>,
    ) -> Solution<T> {
        let is_good = outcome == Outcome::Converged;
        let bound = is_good.then(|| self.error_bound(preconditioner)).flatten();
        Solution {
            values: self.values,
            contact: self.state,
            outcome,
            outer: self.outer,
            linear: self.linear,
            linear_solver: preconditioner.name(),
            algebraic_bound: bound,
        }
    }

    /// A bound on the energy norm of the error over that of the solution, after moving every value
    /// into its bounds.
    ///
    /// For admissible `u` and multipliers `m` of the right sign that vanish off contact, half the
    /// square of the energy error is at most half of `r . inv(A) r`, `r = b + m - A u`. Wrong
    /// multipliers go into `r`. The inverse is at most the preconditioner over the smallest
    /// eigenvalue of the preconditioned matrix, for which stands the smallest Ritz value.
    fn error_bound(&mut self, preconditioner: &mut Preconditioners<'_, T>) -> Option<f64> {
        let bounds = &self.inequality.bounds;
        let mut is_moved = false;
        for (value, bound) in self.values.iter_mut().zip(bounds) {
            let nearest = bound.nearest(*value);
            is_moved |= nearest != *value;
            *value = nearest;
        }
        if is_moved {
            let values = &self.values;
            let Inequality { matrix, load, .. } = self.inequality;
            each_mut(&mut self.residual, |range, r| {
                for (i, r) in range.zip(r) {
                    *r = T::lit(load[i].to_f64() - matrix.row_dot_f64(i, values));
                }
            });
        }
        let mut is_wrong = false;
        for (i, bound) in bounds.iter().enumerate() {
            let pull = match self.state[i] {
                Contact::Open => continue,
                Contact::Lower => self.residual[i].to_f64(),
                Contact::Upper => -self.residual[i].to_f64(),
            };
            if pull > 0.0 && bound.only_value().is_none() {
                self.fixed[i] = false;
                is_wrong = true;
            }
        }
        if is_moved || is_wrong {
            for (r, &fixed) in self.residual.iter_mut().zip(&self.fixed) {
                if fixed {
                    *r = T::lit(0.0);
                }
            }
            let mut z = vec![T::lit(0.0); self.values.len()];
            preconditioner.fix(&self.fixed).ok()?;
            preconditioner.apply(&self.residual, &mut z);
            self.norm = dot(&self.residual, &mut z).max(0.0).sqrt();
        }
        Some(self.norm / (RITZ * self.lowest).sqrt() / self.energy)
    }
}
