//! Slack and dual variable of every bound, and the ratio test.

use crate::algebra::Inequality;
use crate::real::Real;

/// The slack and the dual variable of one bound of one unknown `u_i`, both positive. At the solution the slack is
/// `side (u_i - bound)`, `side` being 1 for a lower bound and -1 for an upper one, and its product with the dual
/// variable, the multiplier of the bound, is zero.
#[derive(Clone, Debug)]
pub(super) struct BoundPair {
    pub unknown: usize,
    pub side: f64,
    pub bound: f64,
    pub slack: f64,
    pub dual: f64,
    /// The direction of slack and dual variable.
    pub change: [f64; 2],
}

impl BoundPair {
    /// The pairs of the unknowns that are not fixed, ascending by unknown, without slacks and dual variables.
    pub fn of<T: Real>(inequality: &Inequality<T>) -> Vec<Self> {
        let free = inequality.free_unknowns();
        let of_unknown = |&unknown: &u32| {
            let unknown = unknown as usize;
            let bound = &inequality.bounds[unknown];
            [(bound.lower(), 1.0), (bound.upper(), -1.0)].into_iter().filter_map(
                move |(bound, side)| {
                    let bound = bound?.to_f64();
                    Some(Self { unknown, side, bound, slack: 0.0, dual: 0.0, change: [0.0; 2] })
                },
            )
        };
        free.iter().flat_map(of_unknown).collect()
    }

    /// The distance of a value from the bound, negative beyond it.
    pub fn gap(&self, value: f64) -> f64 {
        self.side * (value - self.bound)
    }

    /// The product of slack and dual variable after a step of length `t`.
    fn product(&self, t: f64) -> f64 {
        (self.slack + t * self.change[0]) * (self.dual + t * self.change[1])
    }

    /// Sets the direction: the slack changes by `slack_change`, and the dual variable so that the product of both, up to
    /// the product of their changes, changes by `product_change`.
    pub fn set_change(&mut self, slack_change: f64, product_change: f64) {
        self.change = [slack_change, (product_change - self.dual * slack_change) / self.slack];
    }

    /// Makes a step of length `t`.
    pub fn advance(&mut self, t: f64) {
        self.slack += t * self.change[0];
        self.dual += t * self.change[1];
    }
}

/// The mean product of slack and dual variable after a step of length `t`; zero without pairs.
pub(super) fn mean_product(pairs: &[BoundPair], t: f64) -> f64 {
    pairs.iter().map(|pair| pair.product(t)).sum::<f64>() / pairs.len().max(1) as f64
}

/// The ratio test: the largest length in `(0, 1]` of a step after which no slack and no dual variable is negative.
pub(super) fn ratio_test(pairs: &[BoundPair]) -> f64 {
    let ratio = |value: f64, change: f64| if change < 0.0 { -value / change } else { 1.0 };
    pairs.iter().fold(1.0, |length: f64, pair| {
        let [slack, dual] = pair.change;
        length.min(ratio(pair.slack, slack)).min(ratio(pair.dual, dual))
    })
}
