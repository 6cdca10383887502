//! A primal-dual interior point method, which finds a starting active set where the active set method
//! stagnates.
//!
//! | file | content |
//! |---|---|
//! | `complementarity_pairs` | slack and dual variable of every bound, the ratio test |
//! | `newton_system` | the linear systems |
//! | `path_expansion` | the Taylor polynomials along which a step goes |

mod complementarity_pairs;
mod newton_system;
mod path_expansion;

use crate::algebra::{Bound, Contact, Inequality};
use crate::linear::direct::StaticCondensation;
use crate::real::Real;
use complementarity_pairs::{ComplementarityPair, MAX_ORDER, mean_complementarity};
use newton_system::{MixedVector, NewtonSystem};
use path_expansion::{PREDICTOR_ORDER, PathExpansion};

/// Relative complementarity (the sum of all complementarity products divided by the energy scale of
/// [`NewtonSystem::residual`]) of the starting point.
const INITIAL_COMPLEMENTARITY: f64 = 0.1;

/// Relative complementarity at which the method ends: the smaller one of slack and dual variable is
/// then within rounding.
const FINAL_COMPLEMENTARITY: f64 = 1e-18;

/// Relative complementarity at which the method ends although the Tapia indicators of some bound are not
/// separated: slacks that a large penalty determines, and multipliers beside them, are that small.
const LEAST_COMPLEMENTARITY: f64 = 1e-36;

/// Relative complementarity at or below which the active set is identified, if the Tapia indicators are
/// separated and gave the same active set one step before.
const IDENTIFICATION_TOL: f64 = 1e-10;

/// Relative complementarity above which stagnation counts as due to the starting point, not to
/// rounding.
const STAGNATION_TOL: f64 = 1e-8;

/// Least distance of the two Tapia indicators of a bound at which they count as separated.
const INDICATOR_SEPARATION: f64 = 0.5;

/// Largest number of steps.
pub(crate) const MAX_STEPS: usize = 60;

/// Steps that may pass without halving the relative complementarity before the method stagnates.
const STAGNATION_STEPS: usize = 3;

/// Least share of the mean that a step leaves to every complementarity product, where slacks and multipliers
/// that a penalty determines are resolved: their sizes differ by the penalty, and a product far below the
/// mean makes the steps short after most pairs are decided.
const LEAST_SHARE: f64 = 1e-3;

/// Ratio of penalty to stiffness above which the first run resolves slacks that the penalty determines. They are about
/// its reciprocal, so that [`IDENTIFICATION_TOL`] is reached before they are told from zero.
const LARGE_PENALTY: f64 = 1.0 / IDENTIFICATION_TOL;

/// When the method ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Identification {
    /// As soon as the Tapia indicators tell the active set; see [`IDENTIFICATION_TOL`].
    Early,
    /// At the limit of rounding.
    Final,
}

/// A point near the central path, at which a run ended.
pub(crate) struct CentralPoint {
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
/// The matrix of a step is `A` plus a positive diagonal, so that the method applies to every matrix
/// whose symmetric part is positive semidefinite. The number of steps is one or two dozen in practice,
/// and at most of the order of the square root of the number of unknowns in theory (Wright,
/// Primal-Dual Interior-Point Methods, SIAM 1997). Values are accurate up to rounding in the energy
/// norm only. The active set consists of the bounds whose last step kept a larger fraction of the dual
/// variable than of the slack (Tapia indicators).
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
    /// Number of linear systems solved.
    pub steps: usize,
    identification: Identification,
    /// Whether the method ended because it had identified the active set.
    is_identified: bool,
    /// Whether the method ended with an identified active set, or with complementarity products at their final size.
    has_small_complementarity: bool,
    /// Whether points are relative to bounds, steps keep near the central path and go on until every bound
    /// is decided, which takes two to three times as many steps. Where cells have null directions
    /// ([`StaticCondensation::has_null_directions`]), copies of one node within the contact set leave their bound by
    /// as little as the penalty admits: by less than other methods tell from zero where it is large, else at the limit
    /// of rounding only.
    resolves_slacks: bool,
    /// Whether steps became short before every bound was decided.
    is_stuck: bool,
}

impl<'h, 'a, T: Real> InteriorPoint<'h, 'a, T> {
    /// A method that starts near the central path, close to the given values and jump multipliers;
    /// jump multipliers that are not given are zero.
    pub fn new(
        inequality: &'a Inequality<T>,
        condensation: Option<&'h StaticCondensation<'a, T>>,
        (values, jump_multipliers): (&[T], &[T]),
        identification: Identification,
    ) -> Self {
        let bounds = inequality.bounds.iter().zip(values);
        let mut values: Vec<f64> =
            bounds.map(|(bound, &x)| bound.fixed_value().unwrap_or(x).to_f64()).collect();
        let penalised = inequality.penalised.as_ref().filter(|_| condensation.is_some());
        let n_jumps = penalised.map_or(0, |penalised| penalised.n_jumps());
        let mut jump_multipliers: Vec<f64> = jump_multipliers.iter().map(|p| p.to_f64()).collect();
        jump_multipliers.resize(n_jumps, 0.0);
        let mut system = NewtonSystem::new(inequality, condensation);
        let is_large = || penalised.is_some_and(|p| p.largest_ratio() > LARGE_PENALTY);
        let resolves_slacks =
            system.has_null_directions() && (identification == Identification::Final || is_large());
        if resolves_slacks {
            let bounds = inequality.bounds.iter().zip(&values);
            system = system.with_reference(bounds.map(|(b, &x)| nearer_bound(b, x)).collect());
            values.iter_mut().enumerate().for_each(|(i, x)| *x -= system.reference(i));
        }
        let diagonal = (0..inequality.size()).map(|i| system.diagonal_scale(i)).collect();
        let mut method = Self {
            inequality,
            system,
            point: MixedVector { values, jump_multipliers },
            diagonal,
            pairs: Vec::new(),
            steps: 0,
            identification,
            is_identified: false,
            has_small_complementarity: false,
            resolves_slacks,
            is_stuck: false,
        };
        method.leave_out_large_jump_multipliers();
        method.move_to_central_path(INITIAL_COMPLEMENTARITY);
        method
    }

    /// Starts without jump multipliers where the residual is smaller without them: those of an arbitrary active set
    /// exceed all loads by the penalty, and the Jacobi values of such residuals are far off. With cells of linears,
    /// which have no null directions, penalties do not add up to that.
    fn leave_out_large_jump_multipliers(&mut self) {
        if !self.system.has_null_directions() {
            return;
        }
        let mut residual = self.point.clone();
        let with = self.size_of_residual(&mut residual);
        let none = vec![0.0; self.point.jump_multipliers.len()];
        let given = std::mem::replace(&mut self.point.jump_multipliers, none);
        if with <= self.size_of_residual(&mut residual) {
            self.point.jump_multipliers = given;
        }
    }

    /// The square of the residual of values in the dual norm of the diagonal scales, and the residual.
    fn size_of_residual(&self, residual: &mut MixedVector) -> f64 {
        self.residual(residual);
        let square = |&i: &u32| residual.values[i as usize].powi(2) / self.diagonal[i as usize];
        self.system.free().iter().map(square).sum()
    }

    /// A method to the limit of rounding that starts from the point at which another one ended, and resolves the
    /// slacks that this left small.
    pub fn resumed(
        inequality: &'a Inequality<T>,
        condensation: Option<&'h StaticCondensation<'a, T>>,
        CentralPoint { values, jump_multipliers, pairs }: CentralPoint,
    ) -> Self {
        let rounded: Vec<T> = values.iter().map(|&x| T::lit(x)).collect();
        let mut method =
            Self::new(inequality, condensation, (&rounded, &[]), Identification::Final);
        method.point.jump_multipliers = jump_multipliers;
        for (i, x) in method.point.values.iter_mut().enumerate() {
            *x = values[i] - method.system.reference(i);
        }
        for pair in &pairs {
            let bound = &inequality.bounds[pair.unknown];
            let bound = if pair.side > 0.0 { bound.lower() } else { bound.upper() };
            // the difference from this bound has the digits of the slack
            if bound.is_some_and(|b| b.to_f64() == method.system.reference(pair.unknown)) {
                method.point.values[pair.unknown] = pair.side * pair.slack;
            }
        }
        method.pairs = pairs;
        method
    }

    /// The point at which the method ended, from which another one may resolve small slacks; `None` if there are none,
    /// or if the method ended because its steps were short.
    pub fn into_central_point(self) -> Option<CentralPoint> {
        let is_start = self.has_small_complementarity && self.leaves_small_slacks();
        let Self { system, point, pairs, .. } = self;
        let MixedVector { mut values, jump_multipliers } = point;
        values.iter_mut().enumerate().for_each(|(i, x)| *x += system.reference(i));
        is_start.then_some(CentralPoint { values, jump_multipliers, pairs })
    }

    /// Iterates until the active set is identified, no step improves the point, or [`MAX_STEPS`]
    /// are done. Returns the contact states, or `None` if a matrix has no factors, a number is not
    /// finite, or the first step has length zero.
    pub fn run(&mut self) -> Option<Vec<Contact>> {
        let mut residual = self.point.clone();
        let (mut least, mut stagnant_steps) = (f64::INFINITY, 0);
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
            stagnant_steps = if relative < 0.5 * least { 0 } else { stagnant_steps + 1 };
            least = if stagnant_steps == 0 { relative } else { least };
            let contact = self.contact();
            self.is_identified = self.identification == Identification::Early
                && relative <= IDENTIFICATION_TOL
                && self.indicators_are_separated()
                && contact == previous_contact;
            if self.resolves_slacks && relative <= FINAL_COMPLEMENTARITY {
                decided.keep_if_better(self.undecided(), &contact);
            }
            previous_contact = contact;
            let stagnates = stagnant_steps > STAGNATION_STEPS;
            if relative > STAGNATION_TOL && stagnates && !is_recentred {
                // steps stay short from a starting point too close to the bounds
                (is_recentred, stagnant_steps, least) = (true, 0, f64::INFINITY);
                self.move_to_central_path(1.0);
                continue;
            }
            self.is_stuck = self.resolves_slacks && stagnates && relative > FINAL_COMPLEMENTARITY;
            let is_decided = !self.resolves_slacks
                || self.indicators_are_separated()
                || relative <= LEAST_COMPLEMENTARITY;
            let is_final = relative <= FINAL_COMPLEMENTARITY && is_decided;
            self.has_small_complementarity = self.is_identified || is_final;
            if self.has_small_complementarity || stagnates {
                break;
            }
            if !self.step(&residual, mean)? {
                return decided.contact.or(last_contact);
            }
            last_contact = Some(self.contact());
        }
        Some(decided.contact.unwrap_or_else(|| self.contact()))
    }

    /// Whether another run, to the limit of rounding, may find a better active set.
    pub fn may_improve(&self) -> bool {
        self.is_identified
            || self.identification == Identification::Early
                && (self.is_stuck || self.leaves_small_slacks())
    }

    /// Whether there may be slacks that are small because a penalty determines them, and that this run does not resolve.
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

    /// Moves every free unknown off its bounds, close to its Jacobi value, and sets its pairs anew
    /// so that all complementarity products are equal and their sum, relative to the energy scale,
    /// is about `relative_complementarity`.
    fn move_to_central_path(&mut self, relative_complementarity: f64) {
        self.pairs.clear();
        let mut residual = self.point.clone();
        let energy = self.residual(&mut residual);
        let bounds = &self.inequality.bounds;
        let free = self.system.free();
        let bounded = free.iter().filter(|&&i| bounds[i as usize].is_inequality()).count();
        let product = relative_complementarity * energy / bounded.max(1) as f64;
        for k in 0..free.len() {
            self.centre_unknown(self.system.free()[k] as usize, &residual.values, product);
        }
    }

    /// Moves unknown `i` to a given complementarity product and adds its complementarity pairs.
    ///
    /// Without its neighbours the unknown would move to the Jacobi value `u_i + r_i / d_i`. With the
    /// signed distance `y` of that value from the bound, the slack `x` is the positive root of
    /// `x - product / (d_i x) = y`. Between two bounds the Jacobi value is clamped instead.
    fn centre_unknown(&mut self, i: usize, residual: &[f64], product: f64) {
        let bound = &self.inequality.bounds[i];
        let relative = |bound: T| bound.to_f64() - self.system.reference(i);
        let (lower, upper) = (bound.lower().map(relative), bound.upper().map(relative));
        let jacobi = self.point.values[i] + residual[i] / self.diagonal[i];
        let square = product / self.diagonal[i];
        // of a Jacobi value far beyond the bound a difference of equal numbers would leave no slack
        let slack = |y: f64| {
            let root = 0.5 * y.hypot(2.0 * square.sqrt()) + 0.5 * y.abs();
            if y < 0.0 { square / root } else { root }
        };
        self.point.values[i] = match (lower, upper) {
            (Some(l), Some(u)) => {
                let margin = slack(0.0).min(0.25 * (u - l));
                jacobi.clamp(l + margin, u - margin)
            }
            (Some(l), None) => l + slack(jacobi - l),
            (None, Some(u)) => u - slack(u - jacobi),
            (None, None) => return,
        };
        for (bound, side) in [(lower, 1.0), (upper, -1.0)] {
            if let Some(bound) = bound {
                let slack = side * (self.point.values[i] - bound);
                self.pairs.push(ComplementarityPair::new(i, side, slack, product / slack));
            }
        }
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
        // no degree is kept if the coefficients are not finite
        if expansion.order() == 0 || expansion.length <= 0.0 {
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

    /// Whether the two Tapia indicators are separated at every bound: in the limit one of them is
    /// one, the other zero (El-Bakry, Tapia, Zhang, SIAM Rev. 36 (1994) 45-72).
    fn indicators_are_separated(&self) -> bool {
        self.undecided() == 0
    }

    /// The number of bounds whose two Tapia indicators are not separated.
    fn undecided(&self) -> usize {
        let distance = |pair: &ComplementarityPair| (pair.indicators[0] - pair.indicators[1]).abs();
        self.pairs.iter().filter(|pair| distance(pair) <= INDICATOR_SEPARATION).count()
    }

    /// The contact states: a bound is active if the indicator of its dual variable is larger than the
    /// indicator of its slack.
    fn contact(&self) -> Vec<Contact> {
        let mut contact = vec![Contact::Inactive; self.point.values.len()];
        for pair in self.pairs.iter().filter(|pair| pair.indicators[1] > pair.indicators[0]) {
            contact[pair.unknown] = if pair.side > 0.0 { Contact::Lower } else { Contact::Upper };
        }
        contact
    }
}

/// The contact states of the step with the fewest undecided bounds: the indicators of a short step tell
/// nothing.
#[derive(Default)]
struct DecidedContact {
    undecided: usize,
    contact: Option<Vec<Contact>>,
}

impl DecidedContact {
    /// Keeps contact states with as many undecided bounds as those so far, or fewer.
    fn keep_if_better(&mut self, undecided: usize, contact: &[Contact]) {
        if self.contact.is_none() || undecided <= self.undecided {
            (self.undecided, self.contact) = (undecided, Some(contact.to_vec()));
        }
    }
}

/// The bound nearer to the value, zero without bounds.
fn nearer_bound<T: Real>(bound: &Bound<T>, x: f64) -> f64 {
    let bounds = [bound.lower(), bound.upper()].into_iter().flatten().map(T::to_f64);
    bounds.min_by(|a, b| f64::total_cmp(&(x - a).abs(), &(x - b).abs())).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::SparseMatrix;

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
