//! A primal-dual interior point method, which finds a starting active set where the active set method
//! stagnates.
//!
//! [`barrier`] contains slack and dual variable of every bound, [`barrier_system`] the linear systems,
//! [`path_expansion`] the Taylor polynomials along which a step goes.

mod barrier;
mod barrier_system;
mod path_expansion;

use crate::algebra::{Bound, Contact, Inequality};
use crate::linear::direct::StaticCondensation;
use crate::real::Real;
use barrier::{BarrierTerm, MAX_ORDER, RestartTerm, mean_complementarity};
use barrier_system::{BarrierSystem, MixedVector};
use path_expansion::{PREDICTOR_ORDER, PathExpansion};

/// Relative complementarity (the sum of all complementarity products over the energy) of the starting
/// point.
const INITIAL_COMPLEMENTARITY: f64 = 0.1;

/// Relative complementarity at which the method ends: slack and dual variable differ to all digits.
const FINAL_COMPLEMENTARITY: f64 = 1e-18;

/// Relative complementarity below which the active set is identified, if the Tapia indicators are
/// separated and gave the same active set one step before.
const IDENTIFICATION_TOL: f64 = 1e-10;

/// Factor on [`IDENTIFICATION_TOL`] at each restart: the active set was identified too early.
const IDENTIFICATION_TOL_REDUCTION: f64 = 1e-2;

/// Relative complementarity above which stagnation is due to the starting point, not to rounding.
const STAGNATION_TOL: f64 = 1e-8;

/// Least distance of the two Tapia indicators of a bound at which they count as separated.
const INDICATOR_SEPARATION: f64 = 0.5;

/// Largest number of steps.
pub(crate) const MAX_STEPS: usize = 60;

/// Steps that may pass without halving the relative complementarity before the method stagnates.
const STAGNATION_STEPS: usize = 3;

/// The data from which the method continues after it has identified an active set.
#[derive(Debug)]
pub(crate) struct Restart {
    point: MixedVector,
    terms: Vec<RestartTerm>,
    identification_tol: f64,
}

/// The predictor-corrector method of Mehrotra (SIAM J. Optim. 2 (1992) 575-601) for
/// `A u - b = z_lower - z_upper` with positive slack and dual variables `z`, whose products all equal a
/// number that tends to zero: the central path.
///
/// A step follows the Taylor polynomial of the path (Monteiro, Adler, Resende, Math. Oper. Res. 15
/// (1990) 191-214). Every order costs one solution with the factors of the step.
///
/// The matrix of a step is `A` plus a positive diagonal, so that the method applies to every matrix
/// whose symmetric part is positive semidefinite. The number of steps is one or two dozen in practice,
/// and at most of the order of the square root of the number of unknowns in theory (Wright,
/// Primal-Dual Interior-Point Methods, SIAM 1997). Values are accurate up to rounding in the energy
/// only. The active set consists of the bounds whose last step kept a larger fraction of the dual
/// variable than of the slack (Tapia indicators).
///
/// Where the matrix is a [`PenalisedMatrix`](crate::algebra::PenalisedMatrix) the jump multipliers are
/// unknowns too, and `g - M u + p / s` is part of the residual. No penalty weight is then added to a
/// stiffness, and moving the starting point off its bounds does not change jump multipliers.
pub(crate) struct InteriorPoint<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    system: BarrierSystem<'h, 'a, T>,
    point: MixedVector,
    diagonal: Vec<f64>,
    terms: Vec<BarrierTerm>,
    /// Number of linear systems solved.
    pub steps: usize,
    /// See [`IDENTIFICATION_TOL`].
    identification_tol: f64,
    /// Whether a further step cannot improve the point.
    is_final: bool,
}

impl<'h, 'a, T: Real> InteriorPoint<'h, 'a, T> {
    /// A method that starts near the central path, close to values and jump multipliers.
    pub fn new(
        inequality: &'a Inequality<T>,
        condensation: Option<&'h StaticCondensation<'a, T>>,
        values: &[T],
        jump_multipliers: &[T],
    ) -> Self {
        let bounds = inequality.bounds.iter().zip(values);
        let values = bounds.map(|(bound, &x)| bound.fixed_value().unwrap_or(x).to_f64()).collect();
        let jump_multipliers = jump_multipliers.iter().map(|p| p.to_f64()).collect();
        let restart = Restart {
            point: MixedVector { values, jump_multipliers },
            terms: Vec::new(),
            identification_tol: IDENTIFICATION_TOL,
        };
        let mut method = Self::resume(inequality, condensation, restart);
        method.move_to_central_path(INITIAL_COMPLEMENTARITY);
        method
    }

    /// A method that continues from the point of an earlier one.
    pub fn resume(
        inequality: &'a Inequality<T>,
        condensation: Option<&'h StaticCondensation<'a, T>>,
        restart: Restart,
    ) -> Self {
        let Restart { point, terms, identification_tol } = restart;
        let terms = terms.into_iter().map(BarrierTerm::from).collect();
        let system = BarrierSystem::new(inequality, condensation);
        let diagonal = (0..inequality.size()).map(|i| system.diagonal_scale(i)).collect();
        Self {
            inequality,
            system,
            point,
            diagonal,
            terms,
            steps: 0,
            identification_tol,
            is_final: false,
        }
    }

    /// The restart with a smaller identification tolerance; `None` if no further step is possible.
    pub fn into_restart(self) -> Option<Restart> {
        let identification_tol = IDENTIFICATION_TOL_REDUCTION * self.identification_tol;
        let terms = self.terms.into_iter().map(RestartTerm::from);
        (!self.is_final).then(|| Restart {
            point: self.point,
            terms: terms.collect(),
            identification_tol,
        })
    }

    /// Iterates until the active set is identified. Returns the contact states, or `None` if a matrix
    /// has no factors, a number is not finite, or the first step has length zero.
    pub fn run(&mut self) -> Option<Vec<Contact>> {
        let mut residual = self.point.clone();
        let (mut least, mut stagnant_steps) = (f64::INFINITY, 0);
        let mut previous_contact = Vec::new();
        let mut is_recentred = false;
        // the terms of a restart carry the indicators of its last step
        let has_indicators = self.terms.iter().any(|term| term.indicators != [1.0; 2]);
        let mut last_contact = has_indicators.then(|| self.contact());
        while self.steps < MAX_STEPS {
            let energy = self.residual(&mut residual);
            let mean = mean_complementarity(&self.terms, 0.0, 0);
            if !mean.is_finite() || !energy.is_finite() {
                return None;
            }
            let relative = mean * self.terms.len() as f64 / energy;
            stagnant_steps = if relative < 0.5 * least { 0 } else { stagnant_steps + 1 };
            least = if stagnant_steps == 0 { relative } else { least };
            let contact = self.contact();
            let is_identified = relative <= self.identification_tol
                && self.indicators_are_separated()
                && contact == previous_contact;
            previous_contact = contact;
            let stagnates = stagnant_steps > STAGNATION_STEPS;
            if relative > STAGNATION_TOL && stagnates && !is_recentred {
                // steps stay short from a starting point too close to the bounds
                (is_recentred, stagnant_steps, least) = (true, 0, f64::INFINITY);
                self.move_to_central_path(1.0);
                continue;
            }
            self.is_final = relative <= FINAL_COMPLEMENTARITY || stagnates;
            if is_identified || self.is_final {
                break;
            }
            if !self.step(&residual, mean)? {
                self.is_final = true;
                return last_contact;
            }
            last_contact = Some(self.contact());
        }
        Some(self.contact())
    }

    /// The jump multipliers.
    pub fn jump_multipliers(&self) -> Vec<T> {
        self.point.jump_multipliers.iter().map(|&p| T::lit(p)).collect()
    }

    /// The values, projected onto their bounds.
    pub fn values(&self) -> Vec<T> {
        let nearest = |(x, bound): (&f64, &Bound<T>)| bound.nearest(T::lit(*x));
        self.point.values.iter().zip(&self.inequality.bounds).map(nearest).collect()
    }

    /// Moves the point to the central path with a given relative complementarity, as close to the
    /// current values as the path admits.
    fn move_to_central_path(&mut self, relative_complementarity: f64) {
        self.terms.clear();
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

    /// Moves unknown `i` to a given complementarity product and adds its barrier terms.
    ///
    /// Without its neighbours the unknown would move to the Jacobi value `u_i + r_i / d_i`. With the
    /// distance `y` of that value from the bound, the slack `x` is the positive root of
    /// `x - product / (d_i x) = y`. Between two bounds the Jacobi value is clamped instead.
    fn centre_unknown(&mut self, i: usize, residual: &[f64], product: f64) {
        let bound = &self.inequality.bounds[i];
        let (lower, upper) = (bound.lower().map(T::to_f64), bound.upper().map(T::to_f64));
        let jacobi = self.point.values[i] + residual[i] / self.diagonal[i];
        let square = product / self.diagonal[i];
        let slack = |y: f64| 0.5 * y.hypot(2.0 * square.sqrt()) + 0.5 * y;
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
                self.terms.push(BarrierTerm::new(i, side, slack, product / slack));
            }
        }
    }

    /// One predictor-corrector step. False if its length is zero; `None` if the matrix has no factors.
    fn step(&mut self, residual: &MixedVector, mean: f64) -> Option<bool> {
        self.steps += 1;
        let mut diagonal = vec![0.0; self.point.values.len()];
        for term in &self.terms {
            diagonal[term.unknown] += term.dual / term.slack;
        }
        let factors = self.system.factor(&diagonal).ok()?;
        let mut expand = |target: f64, max_order: usize| {
            PathExpansion::new(&self.system, &factors, &mut self.terms, residual, target, max_order)
        };
        // Mehrotra's centring: the cube of the reduction that the predictor achieves
        let predicted = expand(0.0, PREDICTOR_ORDER).complementarity;
        let target = mean * (predicted / mean).clamp(0.0, 1.0).powi(3);
        let expansion = expand(target, MAX_ORDER);
        // no order is kept if the coefficients are not finite
        if expansion.order() == 0 || expansion.length <= 0.0 {
            return Some(false);
        }
        expansion.advance(&mut self.point);
        let (length, order) = (expansion.length, expansion.order());
        self.terms.iter_mut().for_each(|term| term.advance(length, order));
        Some(true)
    }

    /// Computes the residual `b - A u + z_lower - z_upper`; returns a scale of the energy.
    fn residual(&self, residual: &mut MixedVector) -> f64 {
        let energy = self.system.residual(&self.point, residual);
        for term in &self.terms {
            residual.values[term.unknown] += term.side * term.dual;
        }
        energy
    }

    /// Whether the Tapia indicators are separated at every bound: in the limit one is one and the other
    /// zero (El-Bakry, Tapia, Zhang, SIAM Rev. 36 (1994) 45-72).
    fn indicators_are_separated(&self) -> bool {
        let distance = |term: &BarrierTerm| (term.indicators[0] - term.indicators[1]).abs();
        self.terms.iter().all(|term| distance(term) > INDICATOR_SEPARATION)
    }

    /// The contact states: a bound is active if its indicator of the dual variable is the larger one.
    fn contact(&self) -> Vec<Contact> {
        let mut contact = vec![Contact::Inactive; self.point.values.len()];
        for term in self.terms.iter().filter(|term| term.indicators[1] > term.indicators[0]) {
            contact[term.unknown] = if term.side > 0.0 { Contact::Lower } else { Contact::Upper };
        }
        contact
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{SparseMatrix, Start};

    /// Two coupled unknowns above zero, with a load whose double overflows the scalar: the direction of
    /// the first step is not finite.
    fn overflowing() -> Inequality<f32> {
        let (row_starts, columns) = (vec![0, 2, 4], vec![0, 1, 0, 1]);
        Inequality {
            matrix: SparseMatrix { row_starts, columns, values: vec![1.0, -0.9, -0.9, 1.0] },
            symmetric: true,
            bounds: vec![Bound::Lower(0.0); 2],
            load: vec![3e38; 2],
            supports: vec![],
            points: vec![],
            start: Start::Cold,
            penalised: None,
        }
    }

    #[test]
    fn a_first_step_of_length_zero_gives_no_active_set() {
        let inequality = overflowing();
        let mut method = InteriorPoint::new(&inequality, None, &[0.0; 2], &[]);
        let before = method.point.values.clone();
        assert_eq!(method.run(), None);
        assert_eq!((method.point.values.clone(), method.steps), (before, 1));
        assert!(method.into_restart().is_none());
    }

    #[test]
    fn a_later_step_of_length_zero_keeps_the_active_set() {
        let inequality = overflowing();
        let mut method = InteriorPoint::new(&inequality, None, &[0.0; 2], &[]);
        let indicators = [[0.1, 1.0], [1.0, 0.1]];
        method.terms.iter_mut().zip(indicators).for_each(|(term, values)| term.indicators = values);
        let restart = method.into_restart().unwrap();
        let mut method = InteriorPoint::resume(&inequality, None, restart);
        let before = method.point.values.clone();
        assert_eq!(method.run(), Some(vec![Contact::Lower, Contact::Inactive]));
        assert_eq!(method.steps, 1);
        assert_eq!(method.point.values, before);
        assert!(method.into_restart().is_none());
    }
}
