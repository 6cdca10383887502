//! The Taylor polynomial of the central path along which a step goes.

use super::complementarity_pairs::{ComplementarityPair, mean_complementarity, ratio_test};
use super::newton_system::{MixedVector, NewtonFactors, NewtonSystem};
use crate::real::Real;

/// Order of the first expansion of a step, which determines the target of the second.
pub(crate) const PREDICTOR_ORDER: usize = 2;

/// A higher order is kept if the mean complementarity product after its step is less than this fraction of the smallest
/// so far: otherwise the gain does not justify another solution with the factors of the step.
const ORDER_GAIN: f64 = 0.95;

/// Consecutive orders without gain after which the expansion ends.
const MAX_ORDERS_WITHOUT_GAIN: usize = 3;

/// The Taylor polynomial of the central path at the current point, and the step along it.
pub(crate) struct PathExpansion {
    /// The coefficients of `t`, `t^2`, ... of values and jump multipliers; none if no order was kept.
    coefficients: Vec<MixedVector>,
    /// The step length that the ratio test admits.
    pub length: f64,
    /// The mean complementarity product after the step.
    pub complementarity: f64,
}

impl PathExpansion {
    /// The Taylor polynomial of the curve on which the residual, and the difference of each complementarity product
    /// from `target`, are `(1 - t)^2` times their values at the current point. The order increases up to `max_order`,
    /// but not beyond [`MAX_ORDERS_WITHOUT_GAIN`] orders without a smaller mean complementarity product after the step;
    /// the best order is kept. `least_share` is that of [`ratio_test`]. Sets the coefficients of the complementarity
    /// pairs.
    pub fn new<T: Real>(
        system: &NewtonSystem<'_, '_, T>,
        factors: &NewtonFactors<T>,
        pairs: &mut [ComplementarityPair],
        residual: &MixedVector,
        target: f64,
        max_order: usize,
        least_share: f64,
    ) -> Self {
        let mut best =
            Self { coefficients: Vec::new(), length: 0.0, complementarity: f64::INFINITY };
        let mut without_gain = Vec::new();
        for k in 0..max_order {
            without_gain.push(coefficient(system, factors, pairs, residual, target, k));
            let order = k + 1;
            // the linear polynomial alone may admit no step
            if order < PREDICTOR_ORDER {
                continue;
            }
            let length = ratio_test(pairs, order, least_share);
            let complementarity = mean_complementarity(pairs, length, order);
            if complementarity < ORDER_GAIN * best.complementarity {
                (best.length, best.complementarity) = (length, complementarity);
                best.coefficients.append(&mut without_gain);
            } else if without_gain.len() >= MAX_ORDERS_WITHOUT_GAIN {
                break;
            }
        }
        best
    }

    /// The order of the polynomial.
    pub fn order(&self) -> usize {
        self.coefficients.len()
    }

    /// Moves a point along the polynomial by the step length.
    pub fn advance(&self, point: &mut MixedVector) {
        let advance = |x: &mut [f64], of: &dyn Fn(&MixedVector) -> &[f64]| {
            let coefficients: Vec<&[f64]> = self.coefficients.iter().map(of).collect();
            for (i, x) in x.iter_mut().enumerate() {
                *x += coefficients.iter().rev().fold(0.0, |sum, c| self.length * (sum + c[i]));
            }
        };
        advance(&mut point.values, &|c| &c.values);
        advance(&mut point.jump_multipliers, &|c| &c.jump_multipliers);
    }
}

/// The coefficient of `t^(k+1)` of values and jump multipliers, given the coefficients of `t` to `t^k`;
/// sets the coefficients of `t^(k+1)` of the complementarity pairs.
fn coefficient<T: Real>(
    system: &NewtonSystem<'_, '_, T>,
    factors: &NewtonFactors<T>,
    pairs: &mut [ComplementarityPair],
    residual: &MixedVector,
    target: f64,
    k: usize,
) -> MixedVector {
    // 1 - (1 - t)^2 = 2 t - t^2
    let fraction = [2.0, -1.0].get(k).copied().unwrap_or(0.0);
    let right_side = |pair: &ComplementarityPair| {
        fraction * (target - pair.product()) - pair.lower_order_product(k)
    };
    let right_sides: Vec<f64> = pairs.iter().map(right_side).collect();
    let mut right = residual.clone();
    let MixedVector { values, jump_multipliers } = &mut right;
    values.iter_mut().chain(jump_multipliers).for_each(|r| *r *= fraction);
    let coefficient = newton_direction(system, factors, pairs, right, &right_sides);
    for (pair, right_side) in pairs.iter_mut().zip(right_sides) {
        pair.set_coefficient(k, pair.side * coefficient.values[pair.unknown], right_side);
    }
    coefficient
}

/// The Newton direction: the solution of `(A + D) x = r + sum side right_side / slack`, the sum
/// over the pairs of each unknown. `right_sides` are the right-hand sides of the linearised
/// complementarity conditions, one for each pair:
/// `slack * (change of dual) + dual * (change of slack) = right_side`.
fn newton_direction<T: Real>(
    system: &NewtonSystem<'_, '_, T>,
    factors: &NewtonFactors<T>,
    pairs: &[ComplementarityPair],
    mut right: MixedVector,
    right_sides: &[f64],
) -> MixedVector {
    for (pair, right_side) in pairs.iter().zip(right_sides) {
        right.values[pair.unknown] += pair.side * right_side / pair.slack;
    }
    system.solve(factors, &mut right);
    right
}
