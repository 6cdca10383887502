//! Observed orders compared with the orders that theory promises.

use super::report::Report;
use super::row::Row;
use super::table::distinct;
use crate::inequality::Outcome;
use crate::measure::{ErrorNorm, observed_order};
use crate::readable_debug::debug_by_display;
use crate::scheme::ExpectedOrders;

/// An error of this share of the mesh size, of solutions whose size is one, is rounding.
const ROUNDING: f64 = 1e-8;

/// Observed orders of one scheme on one scene, on its two finest levels that converged.
///
/// Coarser levels do not count, since promised orders hold in the limit. Levels whose solve did not
/// converge do not count either.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ObservedOrders {
    /// Name of the scene.
    pub scene: String,
    /// Name of the scheme.
    pub scheme: String,
    /// Where the scheme imposes bounds.
    pub constraint: String,
    /// The two levels, coarse and fine; none if fewer converged.
    pub levels: Option<[usize; 2]>,
    /// Order in L2 and in the broken H1 seminorm; none where there is no error to compare.
    pub observed: ExpectedOrders,
    /// The orders that theory promises.
    pub promised: ExpectedOrders,
    /// Norms in which the error on the finer level is rounding: the scheme has the exact solution
    /// in its space, and there is no order to observe.
    pub exact: Vec<ErrorNorm>,
    /// Levels that did not converge, with the typed reason.
    pub failures: Vec<(usize, Outcome)>,
}

/// The norms in which theory promises orders.
pub(crate) const PROMISED: [ErrorNorm; 2] = [ErrorNorm::L2, ErrorNorm::H1];

/// The order in a norm; none in norms without promises.
pub(crate) fn order_in(norm: ErrorNorm, orders: &ExpectedOrders) -> Option<f64> {
    match norm {
        ErrorNorm::L2 => orders.l2,
        ErrorNorm::H1 => orders.h1,
        ErrorNorm::Energy => None,
    }
}

/// A promise that was not kept.
#[derive(Clone, PartialEq, thiserror::Error)]
pub enum OrderMissed {
    /// The observed order is below the promised one.
    #[error(
        "{scheme} ({constraint}) on {scene}: order {observed:.3} in {norm} from level {coarse} to {fine}, promised {promised}"
    )]
    Below {
        /// Name of the scene.
        scene: String,
        /// Name of the scheme.
        scheme: String,
        /// Where the scheme imposes bounds.
        constraint: String,
        /// The coarser of the two levels.
        coarse: usize,
        /// The finer one: that of the row that misses.
        fine: usize,
        /// The norm.
        norm: ErrorNorm,
        /// The order observed.
        observed: f64,
        /// The order promised.
        promised: f64,
    },
    /// An order is promised, and there are no two levels to observe it.
    #[error(
        "{scheme} ({constraint}) on {scene}: order {promised} in {norm} is promised, but fewer than two levels converged with an error"
    )]
    Unobserved {
        /// Name of the scene.
        scene: String,
        /// Name of the scheme.
        scheme: String,
        /// Where the scheme imposes bounds.
        constraint: String,
        /// The norm.
        norm: ErrorNorm,
        /// The order promised.
        promised: f64,
    },
}

/// All promises of a report that were not kept; at least one.
#[derive(Clone, PartialEq, thiserror::Error)]
#[error("{}", self.0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct OrdersMissed(pub Vec<OrderMissed>);

// so that a `main` that returns it prints what was missed, and not fields
debug_by_display!(OrderMissed, OrdersMissed);

impl ObservedOrders {
    /// The promises that are missed by more than the tolerance.
    pub fn missed(&self, tolerance: f64) -> Vec<OrderMissed> {
        let [scene, scheme, constraint] = [&self.scene, &self.scheme, &self.constraint];
        let miss = |norm: ErrorNorm| {
            let promised =
                order_in(norm, &self.promised).filter(|_| !self.exact.contains(&norm))?;
            match (order_in(norm, &self.observed), self.levels) {
                (Some(observed), Some([coarse, fine])) => {
                    (observed < promised - tolerance).then(|| OrderMissed::Below {
                        scene: scene.clone(),
                        scheme: scheme.clone(),
                        constraint: constraint.clone(),
                        coarse,
                        fine,
                        norm,
                        observed,
                        promised,
                    })
                }
                _ => Some(OrderMissed::Unobserved {
                    scene: scene.clone(),
                    scheme: scheme.clone(),
                    constraint: constraint.clone(),
                    norm,
                    promised,
                }),
            }
        };
        PROMISED.into_iter().filter_map(miss).collect()
    }

    /// The observed orders of the rows of one scheme on one scene.
    fn of(rows: &[&Row]) -> Option<Self> {
        let mut sorted = rows.to_vec();
        sorted.sort_by_key(|row| row.level);
        let failed = sorted.iter().filter(|row| !row.converged());
        let failures = failed.map(|row| (row.level, row.status)).collect();
        let finest = *sorted.last()?;
        sorted.retain(|row| row.converged());
        let pair = sorted.last_chunk::<2>();
        let order = |norm: fn(&Row) -> Option<f64>| {
            let [coarse, fine] = pair?;
            observed_order(norm(coarse)?, norm(fine)?, coarse.mesh_size, fine.mesh_size)
        };
        let errors = [(ErrorNorm::L2, finest.error.l2), (ErrorNorm::H1, finest.error.h1)];
        let is_rounding = |error: Option<f64>| {
            error.is_some_and(|error| error <= ROUNDING * finest.mesh_size.min(1.0))
        };
        Some(Self {
            scene: finest.scene.clone(),
            scheme: finest.scheme.clone(),
            constraint: finest.constraint.clone(),
            levels: pair.map(|pair| pair.map(|row| row.level)),
            observed: ExpectedOrders { l2: order(|r| r.error.l2), h1: order(|r| r.error.h1) },
            promised: finest.expected_order,
            exact: errors.into_iter().filter(|e| is_rounding(e.1)).map(|e| e.0).collect(),
            failures,
        })
    }
}

impl Report {
    /// Observed orders of every scheme on every scene, in the order of the rows. A scheme counts
    /// once for every placement of bounds, every penalty and every solver.
    pub fn observed_orders(&self) -> Vec<ObservedOrders> {
        let key = |row: &Row| {
            let Row { scene, scheme, constraint, parameters, solver, .. } = row.clone();
            (scene, scheme, constraint, parameters, solver)
        };
        let keys = distinct(self.rows.iter().map(key));
        let rows_of = |wanted| self.rows.iter().filter(|row| key(row) == wanted).collect();
        keys.into_iter()
            .map(rows_of)
            .filter_map(|rows: Vec<&Row>| ObservedOrders::of(&rows))
            .collect()
    }

    /// Tests every promise of theory: orders observed on the two finest levels of a scheme on a
    /// scene that converged may fall below the promised ones by at most the tolerance. Where
    /// nothing is promised, nothing is tested; a promise that cannot be tested is missed.
    ///
    /// ```
    /// use unilateral::prelude::*;
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let study = Study::<f64, 2>::new(scenes::signorini_2d()).scheme(ConformingP1);
    /// study.levels([8, 16]).run()?.assert_orders(0.1)?;
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
