//! A primal-dual interior point method, which finds a starting active set where the active set method
//! stagnates.
//!
//! | file | content |
//! |---|---|
//! | `mod` | [`InteriorPoint`]: the steps and the end of a run |
//! | `starting_point` | the point from which a run starts |
//! | `tapia_indicators` | which bounds are active |
//! | `complementarity_pairs` | slack and dual variable of every bound, the ratio test |
//! | `newton_system` | the linear systems |
//! | `path_expansion` | the Taylor polynomials along which a step goes |

mod complementarity_pairs;
mod newton_system;
mod path_expansion;
mod starting_point;
mod tapia_indicators;

use crate::algebra::{Contact, Inequality};
use crate::real::Real;
use complementarity_pairs::{ComplementarityPair, MAX_ORDER, mean_complementarity};
use newton_system::{MixedVector, NewtonSystem};
use path_expansion::{PREDICTOR_ORDER, PathExpansion};
use tapia_indicators::{DecidedContact, are_separated, contact_states, undecided};

/// Relative complementarity at which the method ends: where the solution is strictly complementary the smaller one of
/// slack and dual variable is then within rounding, else both are of the size of its square root.
const FINAL_COMPLEMENTARITY: f64 = 1e-18;

/// Relative complementarity at which the method ends although the Tapia indicators of some bound are not
/// separated: slacks that are as small as the reciprocal of a large penalty, times the multipliers of the same bounds,
/// are of this size.
const COMPLEMENTARITY_FLOOR: f64 = 1e-36;

/// Relative complementarity at or below which the active set is identified, if the Tapia indicators are
/// separated and gave the same active set one step before.
const IDENTIFICATION_TOL: f64 = 1e-10;

/// Relative complementarity above which stagnation counts as due to the starting point, not to
/// rounding.
const STAGNATION_TOL: f64 = 1e-8;

/// Largest number of steps.
pub(crate) const MAX_STEPS: usize = 60;

/// Steps that may pass without halving the relative complementarity before the method stagnates.
const STAGNATION_STEPS: usize = 3;

/// Least ratio of a complementarity product to the mean of all that a step may leave, in a run that resolves small
/// slacks ([`InteriorPoint`], `resolves_slacks`): slacks and multipliers differ in size by the penalty, and a product
/// far below the mean makes the steps short once the Tapia indicators of most pairs are separated.
const LEAST_SHARE: f64 = 1e-3;

/// When the method ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Identification {
    /// As soon as the Tapia indicators tell the active set; see [`IDENTIFICATION_TOL`].
    Early,
    /// At the limit of rounding.
    Final,
}

/// The point at which a run ended, from which another run may start.
pub(crate) struct RestartPoint {
    values: Vec<f64>,
    jump_multipliers: Vec<f64>,
    pairs: Vec<ComplementarityPair>,
}

/// The predictor-corrector method of Mehrotra (SIAM J. Optim. 2 (1992) 575-601) for
/// `A u - b = z_lower - z_upper` with the dual variables `z` of the bounds. It follows the central
/// path: the points at which all slacks and dual variables are positive and all complementarity
/// products equal, while their common value tends to zero.
///
/// A step follows the Taylor polynomial of the path (Monteiro, Adler, Resende, Math. Oper. Res. 15
/// (1990) 191-214). Every degree costs one solution with the factors of the step.
///
/// The matrix of a step is `A` plus a positive diagonal, so that the method applies to every matrix whose symmetric
/// part is positive semidefinite. The number of steps is one or two dozen in practice, while theory bounds those of
/// related methods with short steps by the order of the square root of the number of bounds, for each digit (Wright,
/// Primal-Dual Interior-Point Methods, SIAM 1997). The energy norm of the error of the values reaches rounding; single
/// values need not. The active set consists of the bounds whose last step kept a larger fraction of the dual variable
/// than of the slack (Tapia indicators).
///
/// Where the matrix is a [`PenalisedMatrix`](crate::algebra::PenalisedMatrix) `K + M^T S M` and a
/// static condensation is given, the jump multipliers `p = S (M u - g)` are unknowns too, and
/// `g - M u + p / s`, `s` the weight of the jump in `S`, is part of the residual. No penalty weight
/// is then added to a stiffness, and moving the starting point off its bounds does not change jump
/// multipliers.
pub(crate) struct InteriorPoint<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    system: NewtonSystem<'h, 'a, T>,
    point: MixedVector,
    /// The positive diagonal scales of all unknowns; see [`NewtonSystem::diagonal_scale`].
    diagonal: Vec<f64>,
    pairs: Vec<ComplementarityPair>,
    /// Number of steps, each with one factorisation.
    pub steps: usize,
    identification: Identification,
    /// Whether the method ended because it had identified the active set.
    is_identified: bool,
    /// Whether the method ended with an identified active set, or with complementarity products at their final size.
    has_small_complementarity: bool,
    /// Whether values are differences from bounds, steps keep near the central path ([`LEAST_SHARE`]), and the run goes
    /// on until the Tapia indicators of every bound are separated, which takes two to three times as many steps. That
    /// is needed where cells have null directions
    /// ([`has_null_directions`](crate::linear::direct::StaticCondensation::has_null_directions)): the values of
    /// different cells at one node of the contact set differ, and some of them leave the bound, by a slack that is
    /// inversely proportional to the penalty. A run without differences from bounds cannot tell such slacks from zero
    /// if the penalty is large, and can at its limit of rounding if it is not.
    resolves_slacks: bool,
    /// Whether the relative complementarity stagnated above [`FINAL_COMPLEMENTARITY`] in a run that resolves small
    /// slacks.
    is_stuck: bool,
}

impl<T: Real> InteriorPoint<'_, '_, T> {
    /// The point at which the method ended, from which another run may resolve small slacks; `None` if the inequality
    /// has no slacks that a penalty makes small, or if the method ended by stagnation.
    pub fn into_restart_point(self) -> Option<RestartPoint> {
        let is_restartable = self.has_small_complementarity && self.leaves_small_slacks();
        let Self { system, point, pairs, .. } = self;
        let MixedVector { mut values, jump_multipliers } = point;
        values.iter_mut().enumerate().for_each(|(i, x)| *x += system.reference(i));
        is_restartable.then_some(RestartPoint { values, jump_multipliers, pairs })
    }

    /// Iterates until the active set is identified, no step improves the point, or [`MAX_STEPS`]
    /// are done. Returns the contact states, or `None` if a matrix has no factors, a number is not
    /// finite, or the first step has length zero.
    pub fn run(&mut self) -> Option<Vec<Contact>> {
        let n = self.point.values.len();
        let mut residual = self.point.clone();
        // the relative complementarity when it was halved last, and the number of steps since
        let (mut last_halved, mut stagnant_steps) = (f64::INFINITY, 0);
        let mut previous_contact = Vec::new();
        let mut is_recentred = false;
        let mut last_contact = None;
        let mut decided = DecidedContact::default();
        while self.steps < MAX_STEPS {
            let energy = self.residual(&mut residual);
            let mean = mean_complementarity(&self.pairs, 0.0, 0);
            if !mean.is_finite() || !energy.is_finite() {
                return None;
            }
            let relative = mean * self.pairs.len() as f64 / energy;
            stagnant_steps = if relative < 0.5 * last_halved { 0 } else { stagnant_steps + 1 };
            last_halved = if stagnant_steps == 0 { relative } else { last_halved };
            let contact = contact_states(&self.pairs, n);
            self.is_identified = self.identification == Identification::Early
                && relative <= IDENTIFICATION_TOL
                && are_separated(&self.pairs)
                && contact == previous_contact;
            if self.resolves_slacks && relative <= FINAL_COMPLEMENTARITY {
                decided.keep_if_better(undecided(&self.pairs), &contact);
            }
            previous_contact = contact;
            let stagnates = stagnant_steps > STAGNATION_STEPS;
            if relative > STAGNATION_TOL && stagnates && !is_recentred {
                // steps stay short from a starting point too close to the bounds
                (is_recentred, stagnant_steps, last_halved) = (true, 0, f64::INFINITY);
                self.move_to_central_path(1.0);
                continue;
            }
            self.is_stuck = self.resolves_slacks && stagnates && relative > FINAL_COMPLEMENTARITY;
            let is_decided = !self.resolves_slacks
                || are_separated(&self.pairs)
                || relative <= COMPLEMENTARITY_FLOOR;
            let is_final = relative <= FINAL_COMPLEMENTARITY && is_decided;
            self.has_small_complementarity = self.is_identified || is_final;
            if self.has_small_complementarity || stagnates {
                break;
            }
            if !self.step(&residual, mean)? {
                return decided.contact.or(last_contact);
            }
            last_contact = Some(contact_states(&self.pairs, n));
        }
        Some(decided.contact.unwrap_or_else(|| contact_states(&self.pairs, n)))
    }

    /// Whether another run, to the limit of rounding, may find a better active set.
    pub fn may_improve(&self) -> bool {
        self.is_identified
            || self.identification == Identification::Early
                && (self.is_stuck || self.leaves_small_slacks())
    }

    /// Whether there may be slacks that are inversely proportional to a penalty and that this run does not resolve.
    pub fn leaves_small_slacks(&self) -> bool {
        self.system.has_null_directions() && !self.resolves_slacks
    }

    /// The jump multipliers.
    pub fn jump_multipliers(&self) -> Vec<T> {
        self.point.jump_multipliers.iter().map(|&p| T::lit(p)).collect()
    }

    /// The values, projected onto their bounds.
    pub fn values(&self) -> Vec<T> {
        let value = |i: usize| T::lit(self.system.reference(i) + self.point.values[i]);
        let bounds = self.inequality.bounds.iter().enumerate();
        bounds.map(|(i, bound)| bound.nearest(value(i))).collect()
    }

    /// One predictor-corrector step, which moves the point and the pairs. `Some(false)` if its
    /// length is zero: the point is then unchanged; `None` if the matrix has no factors.
    fn step(&mut self, residual: &MixedVector, mean: f64) -> Option<bool> {
        self.steps += 1;
        let mut diagonal = vec![0.0; self.point.values.len()];
        for pair in &self.pairs {
            diagonal[pair.unknown] += pair.dual / pair.slack;
        }
        let factors = self.system.factor(&diagonal).ok()?;
        let share = if self.resolves_slacks { LEAST_SHARE } else { 0.0 };
        let mut expand = |target: f64, max_order: usize| {
            let pairs = &mut self.pairs;
            PathExpansion::new(&self.system, &factors, pairs, residual, target, max_order, share)
        };
        // Mehrotra's centring: the cube of the reduction that the predictor achieves
        let predicted = expand(0.0, PREDICTOR_ORDER).complementarity;
        let target = mean * (predicted / mean).clamp(0.0, 1.0).powi(3);
        let expansion = expand(target, MAX_ORDER);
        // no degree is kept if the coefficients are not finite; false for a length that is NaN
        let is_step = expansion.order() > 0 && expansion.length > 0.0;
        if !is_step {
            return Some(false);
        }
        expansion.advance(&mut self.point);
        let (length, order) = (expansion.length, expansion.order());
        self.pairs.iter_mut().for_each(|pair| pair.advance(length, order));
        Some(true)
    }

    /// Computes the residual `b - A u + z_lower - z_upper`; returns the energy scale of
    /// [`NewtonSystem::residual`].
    fn residual(&self, residual: &mut MixedVector) -> f64 {
        let energy = self.system.residual(&self.point, residual);
        for pair in &self.pairs {
            residual.values[pair.unknown] += pair.side * pair.dual;
        }
        energy
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{Bound, SparseMatrix};

    /// Two coupled unknowns with lower bounds zero, and a load twice which overflows the scalar: the
    /// direction of the first step is not finite.
    fn overflowing() -> Inequality<f32> {
        let (row_starts, columns) = (vec![0, 2, 4], vec![0, 1, 0, 1]);
        let matrix = SparseMatrix { row_starts, columns, values: vec![1.0, -0.9, -0.9, 1.0] };
        Inequality::new(matrix, true, vec![3e38; 2], vec![Bound::Lower(0.0); 2])
    }

    #[test]
    fn a_first_step_of_length_zero_gives_no_active_set() {
        let inequality = overflowing();
        let start = (&[0.0; 2][..], &[][..]);
        let mut method = InteriorPoint::new(&inequality, None, start, Identification::Early);
        let before = method.point.values.clone();
        assert_eq!(method.run(), None);
        assert_eq!((method.point.values.clone(), method.steps), (before, 1));
    }
}
