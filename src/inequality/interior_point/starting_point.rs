//! The point from which the method starts: near the central path and close to given values, or the point at which
//! another run ended.

use super::complementarity_pairs::ComplementarityPair;
use super::newton_system::{MixedVector, NewtonSystem};
use super::{IDENTIFICATION_TOL, Identification, InteriorPoint, RestartPoint};
use crate::algebra::{Bound, Inequality};
use crate::linear::direct::StaticCondensation;
use crate::real::Real;

/// Relative complementarity (the sum of all complementarity products divided by the energy scale of
/// [`NewtonSystem::residual`]) of the starting point.
const INITIAL_COMPLEMENTARITY: f64 = 0.1;

/// Ratio of penalty to stiffness above which the first run resolves slacks that are inversely proportional to the
/// penalty: the complementarity reaches [`IDENTIFICATION_TOL`] before such slacks can be distinguished from zero.
const LARGE_PENALTY: f64 = 1.0 / IDENTIFICATION_TOL;

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
        method.drop_large_jump_multipliers();
        method.move_to_central_path(INITIAL_COMPLEMENTARITY);
        method
    }

    /// Sets the jump multipliers to zero if the residual is then smaller. The jump multipliers of an arbitrary active
    /// set may exceed all loads by a factor of the size of the penalty; the Jacobi values of such a residual are far
    /// from the solution. Without null directions, as on cells with linear functions, the given jump multipliers are
    /// kept.
    fn drop_large_jump_multipliers(&mut self) {
        if !self.system.has_null_directions() {
            return;
        }
        let mut residual = self.point.clone();
        let with_given = self.squared_residual_norm(&mut residual);
        let none = vec![0.0; self.point.jump_multipliers.len()];
        let given = std::mem::replace(&mut self.point.jump_multipliers, none);
        if with_given <= self.squared_residual_norm(&mut residual) {
            self.point.jump_multipliers = given;
        }
    }

    /// Computes the residual; returns `sum r_i^2 / d_i` over the free unknowns, with the diagonal scales `d`.
    fn squared_residual_norm(&self, residual: &mut MixedVector) -> f64 {
        self.residual(residual);
        let square = |&i: &u32| residual.values[i as usize].powi(2) / self.diagonal[i as usize];
        self.system.free().iter().map(square).sum()
    }

    /// A run to the limit of rounding from the point at which another run ended, to resolve the small slacks that the
    /// other run did not resolve.
    pub fn resumed(
        inequality: &'a Inequality<T>,
        condensation: Option<&'h StaticCondensation<'a, T>>,
        RestartPoint { values, jump_multipliers, pairs }: RestartPoint,
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
            // the difference of the rounded value and the bound has fewer correct digits than the slack
            if bound.is_some_and(|b| b.to_f64() == method.system.reference(pair.unknown)) {
                method.point.values[pair.unknown] = pair.side * pair.slack;
            }
        }
        method.pairs = pairs;
        method
    }

    /// Moves every free unknown off its bounds, close to its Jacobi value, and creates its pairs anew so that all
    /// complementarity products are equal and their sum is about `relative_complementarity` times the energy scale of
    /// [`NewtonSystem::residual`].
    pub(super) fn move_to_central_path(&mut self, relative_complementarity: f64) {
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
    /// Without its neighbours the unknown would move to the Jacobi value `u_i + r_i / d_i`. With the signed distance
    /// `y` of that value from the bound, the slack `x` is the positive root of `x - product / (d_i x) = y`. Between two
    /// bounds the Jacobi value is clamped instead.
    fn centre_unknown(&mut self, i: usize, residual: &[f64], product: f64) {
        let bound = &self.inequality.bounds[i];
        let relative = |bound: T| bound.to_f64() - self.system.reference(i);
        let (lower, upper) = (bound.lower().map(relative), bound.upper().map(relative));
        let jacobi = self.point.values[i] + residual[i] / self.diagonal[i];
        let square = product / self.diagonal[i];
        // if the Jacobi value is far beyond the bound, the difference of square root and `|y|` has no correct digit
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
}

/// The bound nearer to the value; zero without bounds.
fn nearer_bound<T: Real>(bound: &Bound<T>, x: f64) -> f64 {
    let bounds = [bound.lower(), bound.upper()].into_iter().flatten().map(T::to_f64);
    bounds.min_by(|a, b| f64::total_cmp(&(x - a).abs(), &(x - b).abs())).unwrap_or(0.0)
}
