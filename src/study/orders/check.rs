//! Observed orders compared with the orders that theory promises.

use std::fmt;

use crate::inequality::Outcome;
use crate::measure::{ErrorNorm, Errors, FittedOrder, fit_order};
use crate::readable_debug::debug_by_display;
use crate::scheme::ExpectedOrders;
use crate::study::report::Report;
use crate::study::row::{Orders, Row};

/// An error of this share of the mesh size, of solutions whose size is one, is rounding.
const ROUNDING: f64 = 1e-8;
/// Fewer levels give no verdict: with three, one degree of freedom is left for the spread, and a
/// single cell that the free boundary cuts differently decides.
const LEAST_LEVELS: usize = 4;
/// A fitted order of a larger spread decides only where the limit lies outside of the spread.
const LARGEST_SPREAD: f64 = 0.3;

/// The verdict on a promised order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OrderVerdict {
    /// The fitted order is not below the promised one by more than tolerance and half the spread.
    Kept,
    /// It is.
    Missed,
    /// Further levels decide: the spread exceeds 0.3 and the promised order less the tolerance lies
    /// inside of it, or the fitted order is below it while the local orders
    /// [rise](FittedOrder::rises_to) to it.
    Undecided,
    /// Fewer than four levels converged with an error.
    TooFewLevels,
    /// The error on the finest level is rounding: the scheme has the exact solution in its space, and
    /// there is no order to observe.
    Exact,
    /// Theory promises nothing.
    NothingPromised,
}

impl OrderVerdict {
    /// All, in the order of tables.
    pub const ALL: [Self; 6] = [
        Self::Kept,
        Self::Missed,
        Self::Undecided,
        Self::TooFewLevels,
        Self::Exact,
        Self::NothingPromised,
    ];

    /// The words of tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::Missed => "missed",
            Self::Undecided => "undecided",
            Self::TooFewLevels => "too few levels",
            Self::Exact => "exact",
            Self::NothingPromised => "nothing promised",
        }
    }

    /// The verdict on an order, promised for small mesh sizes as `e <= C h^promised`.
    fn on(fitted: Option<&FittedOrder>, promised: f64, tolerance: f64) -> Self {
        let Some(fitted) = fitted.filter(|fitted| fitted.local.len() + 1 >= LEAST_LEVELS) else {
            return Self::TooFewLevels;
        };
        let limit = promised - tolerance;
        let (above, half) = (fitted.order - limit, 0.5 * fitted.spread);
        match above.abs() < half && fitted.spread > LARGEST_SPREAD {
            true => Self::Undecided,
            false if above >= -half => Self::Kept,
            false if fitted.rises_to(limit) => Self::Undecided,
            false => Self::Missed,
        }
    }
}

/// Observed orders of one scheme on one scene, fitted over all levels that converged.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ObservedOrders {
    /// Name of the scene.
    pub scene: String,
    /// Label of the scheme.
    pub label: String,
    /// Where the scheme imposes bounds.
    pub constraint: String,
    /// The levels that converged, the finest last.
    pub levels: Vec<usize>,
    /// The order in L2; none where there are no two errors.
    pub l2: Option<FittedOrder>,
    /// The order in the broken H1 seminorm.
    pub h1: Option<FittedOrder>,
    /// The orders that theory promises.
    pub promised: ExpectedOrders,
    /// Norms in which the error on the finest level, or on all levels, is rounding.
    pub exact: Vec<ErrorNorm>,
    /// Levels that did not converge, with the typed reason.
    pub failures: Vec<(usize, Outcome)>,
}

/// The norms in which theory promises orders.
const PROMISED: [ErrorNorm; 2] = [ErrorNorm::L2, ErrorNorm::H1];

/// A promise that was not seen to be kept.
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub struct OrderMissed {
    /// The orders observed, of which this one is missed.
    pub observed: ObservedOrders,
    /// The norm.
    pub norm: ErrorNorm,
    /// The order promised.
    pub promised: f64,
    /// Why it does not count as kept.
    pub verdict: OrderVerdict,
}

impl fmt::Display for OrderMissed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { observed, norm, promised, verdict } = self;
        let ObservedOrders { scene, label, constraint, levels, .. } = observed;
        let levels = levels_in_words(levels);
        write!(f, "{label} ({constraint}) on {scene}: {}: ", verdict.name())?;
        match (observed.fitted(*norm), verdict) {
            (Some(fitted), OrderVerdict::Missed | OrderVerdict::Undecided) => {
                write!(f, "order {} in {norm} over levels {levels}", order_in_words(fitted))?;
            }
            _ => write!(f, "{levels} converged with an error in {norm}, four are needed")?,
        }
        write!(f, ", promised {promised}")
    }
}

impl std::error::Error for OrderMissed {}

/// All promises of a report that were not seen to be kept; at least one.
#[derive(Clone, PartialEq, thiserror::Error)]
#[error("{}", self.0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct OrdersMissed(pub Vec<OrderMissed>);

// so that a `main` that returns it prints what was missed, and not fields
debug_by_display!(OrderMissed, OrdersMissed);

/// First and last level, with their number.
fn levels_in_words(levels: &[usize]) -> String {
    match levels {
        [] => "none".to_owned(),
        [only] => format!("{only} (1)"),
        [first, .., last] => format!("{first} to {last} ({})", levels.len()),
    }
}

/// The order and half its spread.
fn order_in_words(fitted: &FittedOrder) -> String {
    let FittedOrder { order, spread, .. } = fitted;
    match spread.is_finite() {
        true => format!("{order:.2} ± {:.2}", 0.5 * spread),
        false => format!("{order:.2}"),
    }
}

impl ObservedOrders {
    /// The order in a norm; none in norms without promises.
    pub fn fitted(&self, norm: ErrorNorm) -> Option<&FittedOrder> {
        match norm {
            ErrorNorm::L2 => self.l2.as_ref(),
            ErrorNorm::H1 => self.h1.as_ref(),
            ErrorNorm::Energy | ErrorNorm::Bound => None,
        }
    }
    /// The order that theory promises in a norm.
    pub fn promised(&self, norm: ErrorNorm) -> Option<f64> {
        match norm {
            ErrorNorm::L2 => self.promised.l2,
            ErrorNorm::H1 => self.promised.h1,
            ErrorNorm::Energy | ErrorNorm::Bound => None,
        }
    }
    /// The verdict in a norm.
    pub fn verdict(&self, norm: ErrorNorm, tolerance: f64) -> OrderVerdict {
        match self.promised(norm) {
            _ if self.exact.contains(&norm) => OrderVerdict::Exact,
            None => OrderVerdict::NothingPromised,
            Some(promised) => OrderVerdict::on(self.fitted(norm), promised, tolerance),
        }
    }
    /// The promises that are missed by more than the tolerance, or that cannot be tested.
    pub fn missed(&self, tolerance: f64) -> Vec<OrderMissed> {
        let miss = |norm: ErrorNorm| {
            let verdict = self.verdict(norm, tolerance);
            let passes = [OrderVerdict::Kept, OrderVerdict::Exact, OrderVerdict::NothingPromised];
            let promised = self.promised(norm).filter(|_| !passes.contains(&verdict))?;
            Some(OrderMissed { observed: self.clone(), norm, promised, verdict })
        };
        PROMISED.into_iter().filter_map(miss).collect()
    }

    /// The observed orders of a series, whose rows go from coarse to fine.
    fn of(mut sorted: Vec<&Row>) -> Option<Self> {
        let failed = sorted.iter().filter(|row| !row.converged());
        let failures = failed.map(|row| (row.level, row.status)).collect();
        let finest = *sorted.last()?;
        sorted.retain(|row| row.converged());
        // errors that are rounding tell no order
        let fit = |norm: fn(&Errors) -> Option<f64>, above: fn(&Orders) -> Option<f64>| {
            sorted.iter().map(|row| norm(&row.error)).collect::<Option<Vec<_>>>()?;
            let point = |row: &&Row| Some((row.size(), above(&row.errors_above_rounding())?));
            fit_order(&sorted.iter().filter_map(point).collect::<Vec<_>>())
        };
        let is_exact = |norm: fn(&Errors) -> Option<f64>, above: fn(&Orders) -> Option<f64>| {
            let is_small = |error: f64| error <= ROUNDING * finest.mesh_size.min(1.0);
            let are_rounding =
                || sorted.iter().all(|r| above(&r.errors_above_rounding()).is_none());
            let finest = sorted.last().and_then(|row| norm(&row.error));
            finest.is_some_and(|error| is_small(error) || are_rounding())
        };
        let exact = [
            (ErrorNorm::L2, is_exact(|e| e.l2, |above| above.l2)),
            (ErrorNorm::H1, is_exact(|e| e.h1, |above| above.h1)),
        ];
        Some(Self {
            scene: finest.scene.clone(),
            label: finest.label.clone(),
            constraint: finest.constraint.clone(),
            levels: sorted.iter().map(|row| row.level).collect(),
            l2: fit(|e| e.l2, |above| above.l2),
            h1: fit(|e| e.h1, |above| above.h1),
            promised: finest.expected_order,
            exact: exact.into_iter().filter(|e| e.1).map(|e| e.0).collect(),
            failures,
        })
    }
}

impl Report {
    /// Observed orders of every [series](Report::series).
    pub fn observed_orders(&self) -> Vec<ObservedOrders> {
        self.series().into_iter().filter_map(|series| ObservedOrders::of(series.rows)).collect()
    }

    /// Tests every promise of theory. An order is fitted over the levels on which a scheme converged on a
    /// scene, at least four; the fitted order may fall below the promised order by at most the tolerance
    /// and half the spread of the fit. Where nothing is promised, nothing is tested; a promise that cannot be tested is
    /// missed.
    ///
    /// ```
    /// use unilateral::prelude::*;
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let study = Study::<2>::new(scenes::signorini_2d()).scheme(ConformingP1);
    /// study.levels([2, 4, 8, 16]).run()?.assert_orders(0.1)?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`OrdersMissed`], naming every row that misses.
    pub fn assert_orders(&self, tolerance: f64) -> Result<(), OrdersMissed> {
        let observed = self.observed_orders();
        let missed: Vec<_> = observed.iter().flat_map(|o| o.missed(tolerance)).collect();
        if missed.is_empty() { Ok(()) } else { Err(OrdersMissed(missed)) }
    }
}
