//! Barrier terms, one for each bound, and the ratio test along Taylor polynomials.

/// Highest order of a Taylor polynomial of the central path.
pub(crate) const MAX_ORDER: usize = 8;

/// Fraction of the distance to the first zero of a slack or dual variable that a step takes.
const STEP_FRACTION: f64 = 0.995;

/// Factor that shortens a step as long as a slack or dual variable is not positive after it.
const BACKTRACKING: f64 = 0.9;

/// Subintervals searched for a sign change, and bisections of the first that has one.
const SUBINTERVALS: usize = 32;
const BISECTIONS: usize = 40;

/// Coefficients of `t, t^2, ...` of a polynomial without constant term.
type Coefficients = [f64; MAX_ORDER];

/// The barrier term of one bound of one unknown `u_i`.
///
/// The slack is `side (u_i - bound)`, `side` being 1 for a lower bound and -1 for an upper one; the
/// dual variable is the multiplier of the bound. Both stay positive. After a step of length `t` they
/// are `slack + sum_k slack_coefficients[k] t^(k+1)` and likewise for the dual variable.
#[derive(Debug)]
pub(crate) struct BarrierTerm {
    pub unknown: usize,
    pub side: f64,
    pub slack: f64,
    pub dual: f64,
    slack_coefficients: Coefficients,
    dual_coefficients: Coefficients,
    /// The Tapia indicators: slack and dual variable after the last step over those before it; one
    /// before the first step.
    pub indicators: [f64; 2],
}

/// A barrier term between two steps, without the polynomials of the last one.
#[derive(Debug)]
pub(crate) struct RestartTerm {
    unknown: usize,
    side: f64,
    slack: f64,
    dual: f64,
    indicators: [f64; 2],
}

impl From<BarrierTerm> for RestartTerm {
    fn from(BarrierTerm { unknown, side, slack, dual, indicators, .. }: BarrierTerm) -> Self {
        Self { unknown, side, slack, dual, indicators }
    }
}

impl From<RestartTerm> for BarrierTerm {
    fn from(RestartTerm { unknown, side, slack, dual, indicators }: RestartTerm) -> Self {
        Self { indicators, ..Self::new(unknown, side, slack, dual) }
    }
}

impl BarrierTerm {
    /// A term before its first step.
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

    /// The part of the coefficient of `t^(k+1)` of the complementarity product that comes from lower
    /// coefficients of slack and dual variable.
    pub fn lower_order_product(&self, k: usize) -> f64 {
        (0..k).map(|i| self.slack_coefficients[i] * self.dual_coefficients[k - 1 - i]).sum()
    }

    /// Sets the coefficients of `t^(k+1)`: the given one of the slack, and that of the dual variable
    /// for which the complementarity product has the coefficient `rate` beside its lower-order part.
    pub fn set_coefficient(&mut self, k: usize, of_slack: f64, rate: f64) {
        self.slack_coefficients[k] = of_slack;
        self.dual_coefficients[k] = (rate - self.dual * of_slack) / self.slack;
    }

    /// Slack and dual variable after a step of length `t` along polynomials of an order.
    fn at(&self, t: f64, order: usize) -> [f64; 2] {
        let slack = self.slack + increment(&self.slack_coefficients[..order], t);
        [slack, self.dual + increment(&self.dual_coefficients[..order], t)]
    }

    /// Makes a step of length `t` along polynomials of an order.
    pub fn advance(&mut self, t: f64, order: usize) {
        let [slack, dual] = self.at(t, order);
        self.indicators = [slack / self.slack, dual / self.dual];
        (self.slack, self.dual) = (slack, dual);
    }
}

/// The ratio test: the longest step, at most one, after which all slack and dual variables are
/// positive, shortened by [`STEP_FRACTION`].
pub(crate) fn ratio_test(terms: &[BarrierTerm], order: usize) -> f64 {
    let longest = terms.iter().fold(1.0, |longest, term| {
        let longest = first_root(term.slack, &term.slack_coefficients[..order], longest);
        first_root(term.dual, &term.dual_coefficients[..order], longest)
    });
    let mut length = if longest < 1.0 { STEP_FRACTION * longest } else { 1.0 };
    // a polynomial may be negative between two sampled points and positive at both
    while terms.iter().any(|term| term.at(length, order).iter().any(|&variable| variable <= 0.0)) {
        length *= BACKTRACKING;
    }
    length
}

/// The mean complementarity product after a step of length `t`.
pub(crate) fn mean_complementarity(terms: &[BarrierTerm], t: f64, order: usize) -> f64 {
    let product = |term: &BarrierTerm| {
        let [slack, dual] = term.at(t, order);
        slack * dual
    };
    terms.iter().map(product).sum::<f64>() / terms.len().max(1) as f64
}

/// The polynomial without constant term at `t`.
fn increment(coefficients: &[f64], t: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| t * (sum + coefficient))
}

/// The smallest root in `(0, end)` of the polynomial with a positive constant term, or `end`. Two
/// roots within one of the [`SUBINTERVALS`] are not found.
fn first_root(constant: f64, coefficients: &[f64], end: f64) -> f64 {
    let largest_change = coefficients.iter().rev().fold(0.0, |sum, c| end * (sum + c.abs()));
    if largest_change < constant {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn term(slack_coefficients: Coefficients, dual_coefficients: Coefficients) -> BarrierTerm {
        BarrierTerm { slack_coefficients, dual_coefficients, ..BarrierTerm::new(0, 1.0, 2.0, 3.0) }
    }

    #[test]
    fn steps_end_short_of_the_first_bound() {
        let mut cubic = [0.0; MAX_ORDER];
        // 2 (1 - 4 t^3): zero at the cube root of a quarter
        cubic[2] = -8.0;
        let terms = [term([0.0; MAX_ORDER], cubic), term(cubic, [0.0; MAX_ORDER])];
        let root = 0.25_f64.cbrt();
        assert!((ratio_test(&terms, 3) - STEP_FRACTION * root).abs() < 1e-12);
        assert_eq!(ratio_test(&terms, 2), 1.0);
        let mean = mean_complementarity(&terms, 0.5, 3);
        assert!((mean - 0.5 * (2.0 * (3.0 - 1.0) + (2.0 - 1.0) * 3.0)).abs() < 1e-14);
    }

    /// The complementarity product has the coefficients it is given, whatever those of the slack.
    #[test]
    fn products_follow_their_rates() {
        let mut term = BarrierTerm::new(0, 1.0, 2.0, 3.0);
        let rates = [-12.0, 6.0, 0.0, 0.0];
        for (k, (rate, of_slack)) in rates.into_iter().zip([0.5, -0.25, 0.75, 1.0]).enumerate() {
            let rate = rate - term.lower_order_product(k);
            term.set_coefficient(k, of_slack, rate);
        }
        // 6 (1 - t)^2 up to the fifth power
        let terms = std::slice::from_ref(&term);
        let error = |t: f64| (mean_complementarity(terms, t, 4) - 6.0 * (1.0 - t).powi(2)).abs();
        assert!(error(1e-2) < 1e-8, "{}", error(1e-2));
        assert!(error(1e-2) > 16.0 * error(5e-3));
    }

    /// A polynomial is negative between two sampled points only.
    #[test]
    fn no_step_ends_beyond_a_bound() {
        let minimum = STEP_FRACTION * 0.5;
        let mut slack = [0.0; MAX_ORDER];
        // 2 (t / minimum - 1)^2 - tiny, and a dual variable with its root at one half
        (slack[0], slack[1]) = (-4.0 / minimum, 2.0 / minimum.powi(2));
        let mut dual = [0.0; MAX_ORDER];
        dual[0] = -6.0;
        let mut touching = term(slack, dual);
        touching.slack -= 1e-9;
        let length = ratio_test(std::slice::from_ref(&touching), 2);
        assert!(touching.at(length, 2).iter().all(|&variable| variable > 0.0), "{length}");
    }
}
