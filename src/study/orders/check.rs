//! Observed orders compared with the orders that theory promises.

use std::fmt;

use crate::measure::{ErrorNorm, FittedOrder, fit_order};
use crate::readable_debug::debug_by_display;
use crate::study::report::Report;
use crate::study::row::Row;
use crate::study::series::Series;

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

/// The order of the error of one series in one norm, fitted over all levels that converged, beside the promised one.
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub struct ObservedOrder {
    /// Name of the scene.
    pub scene: String,
    /// Label of the scheme.
    pub label: String,
    /// Where the scheme imposes bounds.
    pub constraint: String,
    /// The norm: L2, or the broken H1 seminorm.
    pub norm: ErrorNorm,
    /// The levels that converged, the finest last.
    pub levels: Vec<usize>,
    /// The order; none where there are no two errors above rounding.
    pub fitted: Option<FittedOrder>,
    /// The order that theory promises.
    pub promised: Option<f64>,
    /// The verdict.
    pub verdict: OrderVerdict,
}

impl fmt::Display for ObservedOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, label, constraint, norm, levels, .. } = self;
        let levels = match &levels[..] {
            [] => "none".to_owned(),
            [only] => format!("{only} (1)"),
            [first, .., last] => format!("{first} to {last} ({})", levels.len()),
        };
        write!(f, "{label} ({constraint}) on {scene}: {}: ", self.verdict.name())?;
        match &self.fitted {
            Some(FittedOrder { order, spread, .. })
                if self.verdict != OrderVerdict::TooFewLevels =>
            {
                write!(f, "order {order:.2} ± {:.2} in {norm} over levels {levels}", 0.5 * spread)?;
            }
            _ => write!(f, "{levels} converged with an error in {norm}, four are needed")?,
        }
        self.promised.map_or(Ok(()), |promised| write!(f, ", promised {promised}"))
    }
}

/// All promises of a report that were not seen to be kept; at least one.
#[derive(Clone, PartialEq, thiserror::Error)]
#[error("{}", self.0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct OrdersMissed(pub Vec<ObservedOrder>);

// so that a `main` that returns it prints what was missed, and not fields
impl fmt::Debug for ObservedOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}
debug_by_display!(OrdersMissed);

impl ObservedOrder {
    /// The orders of a series in L2 and H1.
    fn of(series: &Series<'_>, tolerance: f64) -> [Self; 2] {
        let rows: Vec<&Row> = series.rows.iter().copied().filter(|row| row.converged()).collect();
        let finest = series.rows[series.rows.len() - 1];
        [ErrorNorm::L2, ErrorNorm::H1].map(|norm| {
            let in_norm = |l2: Option<f64>, h1: Option<f64>| match norm {
                ErrorNorm::L2 => l2,
                _ => h1,
            };
            let error = |row: &Row| in_norm(row.error.l2, row.error.h1);
            // errors that are rounding tell no order
            let above = |row: &Row| {
                let above = row.errors_above_rounding();
                in_norm(above.l2, above.h1)
            };
            let points: Vec<_> =
                rows.iter().filter_map(|row| Some((row.size(), above(row)?))).collect();
            let fitted = match rows.iter().all(|row| error(row).is_some()) {
                true => fit_order(&points),
                false => None,
            };
            let is_small = |error: f64| error <= ROUNDING * finest.mesh_size.min(1.0);
            let last = rows.last().and_then(|row| error(row));
            let promised = in_norm(finest.expected_order.l2, finest.expected_order.h1);
            let verdict = match promised {
                _ if last.is_some_and(|e| is_small(e) || points.is_empty()) => OrderVerdict::Exact,
                None => OrderVerdict::NothingPromised,
                Some(promised) => OrderVerdict::on(fitted.as_ref(), promised, tolerance),
            };
            Self {
                scene: finest.scene.clone(),
                label: finest.label.clone(),
                constraint: finest.constraint.clone(),
                norm,
                levels: rows.iter().map(|row| row.level).collect(),
                fitted,
                promised,
                verdict,
            }
        })
    }
}

impl Report {
    /// Observed orders of every [series](Report::series) in L2 and H1, each with the verdict for this tolerance.
    pub fn observed_orders(&self, tolerance: f64) -> Vec<ObservedOrder> {
        self.series().iter().flat_map(|series| ObservedOrder::of(series, tolerance)).collect()
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
    /// [`OrdersMissed`], naming every order that misses.
    pub fn assert_orders(&self, tolerance: f64) -> Result<(), OrdersMissed> {
        use OrderVerdict::{Exact, Kept, NothingPromised};
        let mut missed = self.observed_orders(tolerance);
        missed.retain(|of| !matches!(of.verdict, Kept | Exact | NothingPromised));
        if missed.is_empty() { Ok(()) } else { Err(OrdersMissed(missed)) }
    }
}
