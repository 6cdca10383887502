//! Complementarity pairs, a slack and a dual variable for each bound, and the ratio test along their
//! Taylor polynomials.

/// Highest order of a Taylor polynomial of the central path.
pub(crate) const MAX_ORDER: usize = 8;

/// Fraction of the distance to the first zero of a slack or dual variable that a step takes.
const STEP_FRACTION: f64 = 0.995;

/// Factor by which a step is shortened, repeatedly, while a slack or dual variable is not positive
/// after it.
const BACKTRACKING: f64 = 0.9;

/// Length of a step, divided by the length with which all slack and dual variables are positive, from which the step is
/// no longer shortened to stay near the central path.
const LEAST_LENGTH_FRACTION: f64 = 0.1;

/// Number of subintervals of a step at whose ends a polynomial is evaluated to find a sign change.
const SUBINTERVALS: usize = 32;

/// Number of bisections of the first subinterval with a sign change.
const BISECTIONS: usize = 40;

/// Coefficients of `t, t^2, ...` of a polynomial without constant term.
type Coefficients = [f64; MAX_ORDER];

/// The complementarity pair of one bound of one unknown `u_i`: slack and dual variable, whose
/// product is zero at the solution.
///
/// The slack is `side (u_i - bound)`, `side` being 1 for a lower bound and -1 for an upper one; the
/// dual variable is the multiplier of the bound. Both stay positive. After a step of length `t` the
/// slack is `slack + sum_k slack_coefficients[k] t^(k+1)`, the dual variable
/// `dual + sum_k dual_coefficients[k] t^(k+1)`.
#[derive(Debug)]
pub(crate) struct ComplementarityPair {
    pub unknown: usize,
    pub side: f64,
    pub slack: f64,
    pub dual: f64,
    slack_coefficients: Coefficients,
    dual_coefficients: Coefficients,
    /// The Tapia indicators: the ratios of slack and dual variable after the last step to their values
    /// before it; one before the first step.
    pub indicators: [f64; 2],
}

impl ComplementarityPair {
    /// A pair before its first step: coefficients zero, indicators one.
    pub fn new(unknown: usize, side: f64, slack: f64, dual: f64) -> Self {
        let zero = [0.0; MAX_ORDER];
        Self {
            unknown,
            side,
            slack,
            dual,
            slack_coefficients: zero,
            dual_coefficients: zero,
            indicators: [1.0; 2],
        }
    }

    /// The complementarity product, slack times dual variable.
    pub fn product(&self) -> f64 {
        self.slack * self.dual
    }

    /// The part of the coefficient of `t^(k+1)` of the complementarity product that comes from the
    /// coefficients of `t` to `t^k` of slack and dual variable.
    pub fn lower_order_product(&self, k: usize) -> f64 {
        (0..k).map(|i| self.slack_coefficients[i] * self.dual_coefficients[k - 1 - i]).sum()
    }

    /// Sets the coefficients of `t^(k+1)`: the slack has `slack_coefficient`, and the dual variable the
    /// one for which the coefficient of the complementarity product is
    /// `lower_order_product(k) + right_side`.
    pub fn set_coefficient(&mut self, k: usize, slack_coefficient: f64, right_side: f64) {
        self.slack_coefficients[k] = slack_coefficient;
        self.dual_coefficients[k] = (right_side - self.dual * slack_coefficient) / self.slack;
    }

    /// Slack and dual variable after a step of length `t` along their Taylor polynomials of degree
    /// `order`.
    fn at(&self, t: f64, order: usize) -> [f64; 2] {
        let slack = self.slack + increment(&self.slack_coefficients[..order], t);
        [slack, self.dual + increment(&self.dual_coefficients[..order], t)]
    }

    /// Makes a step of length `t` along the Taylor polynomials of degree `order`: updates slack, dual
    /// variable and indicators.
    pub fn advance(&mut self, t: f64, order: usize) {
        let [slack, dual] = self.at(t, order);
        self.indicators = [slack / self.slack, dual / self.dual];
        (self.slack, self.dual) = (slack, dual);
    }
}

/// The ratio test: a step length in `(0, 1]` after which all slack and dual variables are positive,
/// along their Taylor polynomials of degree `order`.
///
/// The length is [`STEP_FRACTION`] times the smallest root of any of the polynomials in `(0, 1]`, or one if
/// [`first_root`] finds no root there. While a slack or dual variable is not positive after the step, because a root
/// was not found, the length is multiplied by [`BACKTRACKING`].
///
/// The length is multiplied by [`BACKTRACKING`] also while a complementarity product after the step is less than
/// `least_share` times the mean of all products, and less than before the step: a product far below the mean makes all
/// later steps short (the neighbourhood of the central path in Wright, Primal-Dual Interior-Point Methods, SIAM 1997).
/// This ends as soon as the length is at most [`LEAST_LENGTH_FRACTION`] times the length before.
///
/// All slack and dual variables must be positive before the step; otherwise the search does not end.
pub(crate) fn ratio_test(pairs: &[ComplementarityPair], order: usize, least_share: f64) -> f64 {
    let bernstein = BernsteinBasis::new(order);
    let longest = pairs.iter().fold(1.0, |longest, pair| {
        let longest =
            first_root(pair.slack, &pair.slack_coefficients[..order], longest, &bernstein);
        first_root(pair.dual, &pair.dual_coefficients[..order], longest, &bernstein)
    });
    let mut length = if longest < 1.0 { STEP_FRACTION * longest } else { 1.0 };
    // `first_root` does not find two roots between neighbouring points of evaluation
    while pairs.iter().any(|pair| pair.at(length, order).iter().any(|&variable| variable <= 0.0)) {
        length *= BACKTRACKING;
    }
    let least_length = if least_share > 0.0 { LEAST_LENGTH_FRACTION * length } else { length };
    while length > least_length {
        let least = least_share * mean_complementarity(pairs, length, order);
        let is_too_small = |pair: &ComplementarityPair| {
            let [slack, dual] = pair.at(length, order);
            slack * dual < least.min(pair.product())
        };
        if !pairs.iter().any(is_too_small) {
            break;
        }
        length *= BACKTRACKING;
    }
    length
}

/// The mean complementarity product after a step of length `t` along polynomials of degree `order`;
/// zero without pairs.
pub(crate) fn mean_complementarity(pairs: &[ComplementarityPair], t: f64, order: usize) -> f64 {
    let product = |pair: &ComplementarityPair| {
        let [slack, dual] = pair.at(t, order);
        slack * dual
    };
    pairs.iter().map(product).sum::<f64>() / pairs.len().max(1) as f64
}

/// The value at `t` of the polynomial with these coefficients of `t, t^2, ...` and without constant term.
fn increment(coefficients: &[f64], t: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| t * (sum + coefficient))
}

/// A lower estimate of the smallest root in `(0, end)` of the polynomial with the positive constant
/// term `constant`, or `end` if none is found. Two roots within one of the [`SUBINTERVALS`] are not
/// found.
fn first_root(constant: f64, coefficients: &[f64], end: f64, bernstein: &BernsteinBasis) -> f64 {
    let largest_change = coefficients.iter().rev().fold(0.0, |sum, c| end * (sum + c.abs()));
    if largest_change < constant || bernstein.is_positive(constant, coefficients, end) {
        return end;
    }
    let is_past_root = |t: f64| constant + increment(coefficients, t) <= 0.0;
    let width = end / SUBINTERVALS as f64;
    let Some(right) = (1..=SUBINTERVALS).find(|&k| is_past_root(k as f64 * width)) else {
        return end;
    };
    let (mut low, mut high) = ((right - 1) as f64 * width, right as f64 * width);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        *(if is_past_root(middle) { &mut high } else { &mut low }) = middle;
    }
    low
}

/// The Bernstein basis of polynomials of one degree.
struct BernsteinBasis {
    /// `quotients[j][k]` is the binomial coefficient `(j, k)` divided by `(degree, k)`.
    quotients: [[f64; MAX_ORDER + 1]; MAX_ORDER + 1],
}

impl BernsteinBasis {
    /// The basis of a degree of at most [`MAX_ORDER`].
    fn new(degree: usize) -> Self {
        let mut quotients = [[0.0; MAX_ORDER + 1]; MAX_ORDER + 1];
        for (j, row) in quotients.iter_mut().enumerate().take(degree + 1) {
            row[0] = 1.0;
            for k in 0..j {
                row[k + 1] = row[k] * (j - k) as f64 / (degree - k) as f64;
            }
        }
        Self { quotients }
    }

    /// Whether all Bernstein coefficients on `[0, end]` are positive. The polynomial, which is a convex combination of
    /// them at every point (G. Farin, Curves and Surfaces for CAGD, 2002, section 6.2), is then positive; the converse
    /// does not hold.
    fn is_positive(&self, constant: f64, coefficients: &[f64], end: f64) -> bool {
        let mut scaled = [0.0; MAX_ORDER];
        let mut power = 1.0;
        for (scaled, coefficient) in scaled.iter_mut().zip(coefficients) {
            power *= end;
            *scaled = coefficient * power;
        }
        (1..=coefficients.len()).all(|j| {
            let terms = self.quotients[j][1..=j].iter().zip(&scaled);
            constant + terms.map(|(quotient, c)| quotient * c).sum::<f64>() > 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(
        slack_coefficients: Coefficients,
        dual_coefficients: Coefficients,
    ) -> ComplementarityPair {
        ComplementarityPair {
            slack_coefficients,
            dual_coefficients,
            ..ComplementarityPair::new(0, 1.0, 2.0, 3.0)
        }
    }

    #[test]
    fn steps_end_short_of_the_first_bound() {
        let mut cubic = [0.0; MAX_ORDER];
        // 2 (1 - 4 t^3): zero at the cube root of a quarter
        cubic[2] = -8.0;
        let pairs = [pair([0.0; MAX_ORDER], cubic), pair(cubic, [0.0; MAX_ORDER])];
        let root = 0.25_f64.cbrt();
        assert!((ratio_test(&pairs, 3, 0.0) - STEP_FRACTION * root).abs() < 1e-12);
        assert_eq!(ratio_test(&pairs, 2, 0.0), 1.0);
        let mean = mean_complementarity(&pairs, 0.5, 3);
        assert!((mean - 0.5 * (2.0 * (3.0 - 1.0) + (2.0 - 1.0) * 3.0)).abs() < 1e-14);
    }

    /// Bernstein coefficients of `(1 - t)^2 + 1/100` are positive on the unit interval; those of
    /// `(1 - 2 t)^2 + 1/100` are on its first half only, though the polynomial has no root.
    #[test]
    fn positive_bernstein_coefficients_exclude_roots() {
        let bernstein = BernsteinBasis::new(2);
        assert!(bernstein.is_positive(1.01, &[-2.0, 1.0], 1.0));
        assert!(bernstein.is_positive(1.01, &[-4.0, 4.0], 0.5));
        assert!(!bernstein.is_positive(1.01, &[-4.0, 4.0], 1.0));
        assert!(!bernstein.is_positive(1.0, &[-2.0, 1.0], 1.0));
        // t (1 - t) (2 - t) (3 - t) / 24 + 1/50 (1 - t), by its powers
        let quartic = BernsteinBasis::new(4);
        let of =
            |end: f64| quartic.is_positive(0.02, &[0.23, -11.0 / 24.0, 0.25, -1.0 / 24.0], end);
        assert!(of(0.99) && !of(1.01));
    }

    /// The complementarity product has the given coefficients for any coefficients of the slack.
    #[test]
    fn products_have_the_given_coefficients() {
        let mut pair = ComplementarityPair::new(0, 1.0, 2.0, 3.0);
        let products = [-12.0, 6.0, 0.0, 0.0];
        for (k, (product, slack_coefficient)) in
            products.into_iter().zip([0.5, -0.25, 0.75, 1.0]).enumerate()
        {
            let right_side = product - pair.lower_order_product(k);
            pair.set_coefficient(k, slack_coefficient, right_side);
        }
        // 6 (1 - t)^2 up to the fifth power
        let pairs = std::slice::from_ref(&pair);
        let error = |t: f64| (mean_complementarity(pairs, t, 4) - 6.0 * (1.0 - t).powi(2)).abs();
        assert!(error(1e-2) < 1e-8, "{}", error(1e-2));
        assert!(error(1e-2) > 16.0 * error(5e-3));
    }

    /// A polynomial is negative between two points of evaluation only.
    #[test]
    fn no_step_ends_beyond_a_bound() {
        let minimum = STEP_FRACTION * 0.5;
        let mut slack = [0.0; MAX_ORDER];
        // 2 (t / minimum - 1)^2 - tiny, and a dual variable with its root at one half
        (slack[0], slack[1]) = (-4.0 / minimum, 2.0 / minimum.powi(2));
        let mut dual = [0.0; MAX_ORDER];
        dual[0] = -6.0;
        let mut touching = pair(slack, dual);
        touching.slack -= 1e-9;
        let length = ratio_test(std::slice::from_ref(&touching), 2, 0.0);
        assert!(touching.at(length, 2).iter().all(|&variable| variable > 0.0), "{length}");
    }
}
