//! Taylor polynomials of the central path.

use super::barrier::{BarrierTerm, mean_complementarity, ratio_test};
use super::barrier_system::{BarrierFactors, BarrierSystem, MixedVector};
use crate::real::Real;

/// Order of the first expansion of a step, which determines the target of the second.
pub(crate) const PREDICTOR_ORDER: usize = 2;

/// A further order is kept if it multiplies the complementarity after the step by less than this:
/// otherwise it is not worth a solution with the factors of the step.
const ORDER_GAIN: f64 = 0.95;

/// Consecutive orders without gain after which the expansion ends.
const MAX_ORDERS_WITHOUT_GAIN: usize = 3;

/// The Taylor polynomial of the central path at the current point, and the step along it.
pub(crate) struct PathExpansion {
    /// The coefficients of `t, t^2, ...` of values and jump multipliers.
    coefficients: Vec<MixedVector>,
    /// The step length that the ratio test admits.
    pub length: f64,
    /// The mean complementarity product after the step.
    pub complementarity: f64,
}

impl PathExpansion {
    /// The Taylor polynomial of the curve on which the residual and the differences of all
    /// complementarity products from `target` are `(1 - t)^2` times what they are now. The order, at
    /// most `max_order`, increases as long as the complementarity after the step gains from it. Sets the
    /// coefficients of the barrier terms.
    pub fn new<T: Real>(
        system: &BarrierSystem<'_, '_, T>,
        factors: &BarrierFactors<T>,
        terms: &mut [BarrierTerm],
        residual: &MixedVector,
        target: f64,
        max_order: usize,
    ) -> Self {
        let mut best =
            Self { coefficients: Vec::new(), length: 0.0, complementarity: f64::INFINITY };
        let mut without_gain = Vec::new();
        for k in 0..max_order {
            without_gain.push(coefficient(system, factors, terms, residual, target, k));
            let order = k + 1;
            // the linear polynomial alone may admit no step
            if order < PREDICTOR_ORDER {
                continue;
            }
            let length = ratio_test(terms, order);
            let complementarity = mean_complementarity(terms, length, order);
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

/// The coefficient of `t^(k+1)` of the path, given all lower ones; sets those of the barrier terms.
fn coefficient<T: Real>(
    system: &BarrierSystem<'_, '_, T>,
    factors: &BarrierFactors<T>,
    terms: &mut [BarrierTerm],
    residual: &MixedVector,
    target: f64,
    k: usize,
) -> MixedVector {
    // 1 - (1 - t)^2 = 2 t - t^2
    let fraction = [2.0, -1.0].get(k).copied().unwrap_or(0.0);
    let rate =
        |term: &BarrierTerm| fraction * (target - term.product()) - term.lower_order_product(k);
    let rates: Vec<f64> = terms.iter().map(rate).collect();
    let mut right = residual.clone();
    let MixedVector { values, jump_multipliers } = &mut right;
    values.iter_mut().chain(jump_multipliers).for_each(|r| *r *= fraction);
    let coefficient = newton_direction(system, factors, terms, right, &rates);
    for (term, rate) in terms.iter_mut().zip(rates) {
        term.set_coefficient(k, term.side * coefficient.values[term.unknown], rate);
    }
    coefficient
}

/// The Newton direction: the solution of `(A + D) x = r + sum side rate / slack`, along which
/// complementarity products change at given rates.
fn newton_direction<T: Real>(
    system: &BarrierSystem<'_, '_, T>,
    factors: &BarrierFactors<T>,
    terms: &[BarrierTerm],
    mut right: MixedVector,
    rates: &[f64],
) -> MixedVector {
    for (term, rate) in terms.iter().zip(rates) {
        right.values[term.unknown] += term.side * rate / term.slack;
    }
    system.solve(factors, &mut right);
    right
}
