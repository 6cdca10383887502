//! The active set method with inexact linear solutions: no factors of the matrix.

use super::cycles::key_of;
use super::iterate::{known_value, rest};
use super::kkt_evaluation::Look;
use super::{ActiveSet, LastResort, check_definite};
use crate::algebra::{Bound, Contact, Inequality, Start};
use crate::inequality::initial_guess::InitialGuess;
use crate::inequality::{Outcome, Solution};
use crate::linear::FactorError;
use crate::linear::krylov::{KrylovMethod, KrylovRun, StopReason, StoppingRule, symmetric_part};
use crate::linear::precondition::{AnyPreconditioner, Preconditioner};
use crate::parallel::vectors::{for_each_chunk, zeros};
use crate::real::Real;

/// Condition number of the preconditioned matrix beyond which the preconditioner does not fit: the
/// norm of its residual then says little of the error, and factors are the better choice.
const WORST_CONDITION: f64 = 1e4;

/// Most iterations for one linear system.
pub(crate) const MOST_ITERATIONS: usize = 500;

/// Fewer changes of state than this hardly change the error: the next system is solved well.
const FEW: usize = 16;

/// Most times a system is solved again because of rounding.
const MOST_REPEATS: usize = 3;

/// The current iterate.
pub(crate) struct Inexact<'a, T> {
    pub inequality: &'a Inequality<T>,
    pub values: Vec<T>,
    pub state: Vec<Contact>,
    /// Whether an unknown has a known value: a Dirichlet datum or a bound it rests on.
    pub(crate) fixed: Vec<bool>,
    pub diagonal: Vec<T>,
    /// `b - A u`, zero where fixed while linear systems are solved.
    pub residual: Vec<T>,
    fingerprint: u128,
    seen: Vec<u128>,
    pub outer: usize,
    pub linear: usize,
    /// Whether the active set did not settle.
    is_unsettled: bool,
    /// Smallest Ritz value so far.
    pub(crate) lowest: f64,
    /// Energy norm of the iterate.
    pub(crate) energy: f64,
    /// Preconditioned norm of the residual after the last linear system.
    pub(crate) norm: f64,
}

/// What was done before factors were asked to take over.
#[derive(Default)]
pub(crate) struct InVain {
    pub outer: usize,
    pub linear: usize,
    /// Contact, where it did not settle.
    pub unsettled: Option<Vec<Contact>>,
}

/// How the active set fares.
struct Course {
    /// Whether it changed after the last linear system.
    has_moved: bool,
    /// Whether the next system is to be solved well, and whether all are.
    settled: bool,
    careful: bool,
    best: f64,
    idle: usize,
    repeats: usize,
    /// Fewest changes of state, and systems since they were half of what they had been.
    fewest: usize,
    hesitant: usize,
}

impl Course {
    fn new(settled: bool) -> Self {
        let best = f64::INFINITY;
        let fewest = usize::MAX;
        let has_moved = true;
        Self { has_moved, settled, careful: false, best, idle: 0, repeats: 0, fewest, hesitant: 0 }
    }

    fn is_careful(&self) -> bool {
        self.settled || self.careful
    }

    /// Whether changes of state become fewer so slowly that something else is quicker.
    fn hesitates(&mut self, flips: usize, hesitation: usize) -> bool {
        if 2 * flips <= self.fewest {
            (self.fewest, self.hesitant) = (flips, 0);
        } else if flips > 0 {
            self.hesitant += 1;
        }
        self.hesitant > hesitation
    }

    /// Whether it may still arrive.
    fn goes_on(&mut self, look: &Look, returned: bool, patience: usize) -> bool {
        self.has_moved = !look.flips.is_empty();
        self.settled = returned || look.flips.len() < FEW;
        if !self.has_moved {
            return true;
        }
        let merit = look.merit();
        self.idle = if merit < self.best { 0 } else { self.idle + 1 };
        self.best = self.best.min(merit);
        if self.idle > patience {
            if self.careful {
                return false;
            }
            // perhaps the active set wanders because systems are solved too badly
            (self.careful, self.idle) = (true, 0);
        }
        true
    }
}

impl<'a, T: Real> Inexact<'a, T> {
    pub fn new(inequality: &'a Inequality<T>, nearby: &InitialGuess<T>) -> Self {
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
            residual: zeros(n),
            fingerprint,
            seen: vec![fingerprint],
            outer: 0,
            linear: 0,
            is_unsettled: false,
            lowest: 1.0,
            energy: 1.0,
            norm: f64::INFINITY,
        };
        iterate.rest_on_bounds();
        iterate
    }

    /// Solves; an error where the method does not apply or did not get far enough, and factors may.
    pub fn run(
        mut self,
        settings: &ActiveSet,
        nearby: &InitialGuess<T>,
    ) -> Result<Solution<T>, InVain> {
        let inequality = self.inequality;
        let matrix = symmetric_part(inequality);
        let Some(functions) =
            AnyPreconditioner::coarse_spaces(&matrix, inequality, &nearby.functions)
        else {
            return Err(self.in_vain());
        };
        let Some(mut preconditioner) =
            AnyPreconditioner::new(&matrix, &inequality.supports, &functions, inequality.symmetric)
        else {
            return Err(self.in_vain());
        };
        let mut ended = self.iterate(settings, nearby, &mut preconditioner);
        if ended == Some(Outcome::Converged) && !inequality.symmetric {
            ended = self.sound(&matrix, &mut preconditioner);
        }
        if ended == Some(Outcome::NotCoercive) && !inequality.symmetric {
            // rounding may be why; factors that take over do not see the symmetric part
            ended = check_definite(inequality).err();
        }
        match ended {
            Some(outcome) => Ok(self.into_solution(outcome, &mut preconditioner)),
            None if self.is_unsettled => {
                let unsettled = Some(std::mem::take(&mut self.state));
                Err(InVain { unsettled, ..self.in_vain() })
            }
            None => Err(self.in_vain()),
        }
    }

    fn in_vain(&self) -> InVain {
        InVain { outer: self.outer, linear: self.linear, unsettled: None }
    }

    /// `None` if it does not get anywhere.
    fn iterate(
        &mut self,
        settings: &ActiveSet,
        nearby: &InitialGuess<T>,
        preconditioner: &mut AnyPreconditioner<'_, T>,
    ) -> Option<Outcome> {
        let tolerance = nearby.accuracy.unwrap_or(0.0).max(0.1 * T::CERTIFICATE_LIMIT);
        // a residual by itself says little: where the answer need not be good it is not asked for
        let limit = if nearby.accuracy.is_some() { f64::INFINITY } else { T::CERTIFICATE_LIMIT };
        let mut krylov = KrylovMethod::new(self.inequality);
        self.energy = self.look(settings.band).energy;
        let is_linear = !self.inequality.bounds.iter().any(Bound::is_inequality);
        let mut course = Course::new(is_linear);
        loop {
            if course.has_moved {
                if self.outer >= settings.max_outer {
                    return Some(Outcome::IterationLimit);
                }
                self.outer += 1;
                match preconditioner.set_fixed(&self.fixed) {
                    Ok(()) => {}
                    Err(FactorError::OutOfMemory) => return Some(Outcome::OutOfMemory),
                    Err(FactorError::NotPositive) if !self.inequality.symmetric => {
                        return Some(Outcome::NotCoercive);
                    }
                    // factors of the whole matrix tell why
                    Err(_) => return None,
                }
            }
            let stop = StoppingRule {
                norm: tolerance * self.energy,
                reduction: if course.is_careful() {
                    0.0
                } else {
                    preconditioner.inexact_reduction()
                },
                max_iterations: MOST_ITERATIONS,
            };
            let run = self.solve_linear(&mut krylov, preconditioner, stop);
            match self.judge_run(&run)? {
                Outcome::Converged => {}
                other => return Some(other),
            }
            let look = self.look(settings.band);
            if !(look.energy.is_finite() && look.scale.is_finite()) {
                return Some(Outcome::NotFinite);
            }
            self.energy = look.energy;
            self.norm = run.norm;
            let is_exact = run.norm <= stop.norm.min(1.01 * tolerance * self.energy);
            if is_exact && (look.flips.is_empty() || look.holds_to(tolerance)) {
                if look.off_contact <= limit * self.energy {
                    return Some(Outcome::Converged);
                }
                // rounding has driven apart the residual and what the iteration thinks it is
                course.repeats += 1;
                if course.repeats > MOST_REPEATS {
                    // where forces of jumps are kept beside values there is less rounding
                    if self.inequality.penalised.is_some() {
                        return None;
                    }
                    return Some(Outcome::Stalled);
                }
            }
            // from a cold start contact spreads layer by layer, which is slow but cheap
            if settings.last_resort == LastResort::WhenUnsettled
                && self.inequality.start != Start::Cold
                && course.hesitates(look.flips.len(), self.patience(settings, nearby))
            {
                self.is_unsettled = true;
                return None;
            }
            let returned = self.has_returned(&look.flips);
            if !course.goes_on(&look, returned, settings.patience) {
                return None;
            }
            self.flip(&look.flips);
        }
    }

    /// One linear system, from the iterate as it is.
    fn solve_linear(
        &mut self,
        krylov: &mut KrylovMethod<'_, T>,
        preconditioner: &mut dyn Preconditioner<T>,
        stop: StoppingRule,
    ) -> KrylovRun {
        let fixed = &self.fixed;
        for_each_chunk(&mut self.residual, |range, r| {
            for (r, &fixed) in r.iter_mut().zip(&fixed[range]) {
                if fixed {
                    *r = T::lit(0.0);
                }
            }
        });
        let iterate = (&mut self.values[..], &mut self.residual[..]);
        let run = krylov.solve(&self.fixed, preconditioner, iterate, stop);
        self.linear += run.iterations;
        run
    }

    /// How a linear system ended; `None` if the preconditioner does not fit.
    pub(crate) fn judge_run(&mut self, run: &KrylovRun) -> Option<Outcome> {
        let is_symmetric = self.inequality.symmetric;
        let (low, high) = run.ritz.unwrap_or((1.0, 1.0));
        self.lowest = self.lowest.min(low);
        match run.reason {
            // whether it is so is asked again
            StopReason::NotPositive if !is_symmetric => Some(Outcome::NotCoercive),
            _ if high > WORST_CONDITION * low => None,
            StopReason::Converged => Some(Outcome::Converged),
            StopReason::NotPositive => Some(Outcome::NotCoercive),
            StopReason::NotFinite => Some(Outcome::NotFinite),
            StopReason::IterationLimit => None,
        }
    }

    /// Whether the active set after these flips has been there before.
    fn has_returned(&mut self, flips: &[(u32, Contact)]) -> bool {
        if flips.is_empty() {
            return false;
        }
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
                // a row stands for the column
                if !self.inequality.symmetric {
                    continue;
                }
                let (columns, entries) = self.inequality.matrix.row(i);
                for (&j, &a) in columns.iter().zip(entries) {
                    self.residual[j as usize] -= a * change;
                }
            }
        }
        if !self.inequality.symmetric {
            self.renew_residual();
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
}
