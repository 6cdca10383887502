//! The rates, effectivities and times of adaptive steps, in one line for each series.

use crate::measure::fit_order;
use crate::study::row::Row;
use crate::study::series::{Series, series_of};

/// The orders of bound and error over the last half of the steps of each adaptive series, by least squares, the
/// range of effectivities, and the time of all steps over that of the last one.
pub(crate) fn rates(rows: &[&Row]) -> Vec<String> {
    let of_series = |series: Series<'_>| {
        let steps: Vec<&Row> = series.rows.iter().copied().filter(|r| r.converged()).collect();
        let ([.., before, last], half) = (&steps[..], &steps[steps.len() / 2..]) else {
            return None;
        };
        let order = |error: fn(&Row) -> Option<f64>| {
            let points: Option<Vec<_>> =
                half.iter().map(|row| Some((row.size(), error(row)?))).collect();
            points.and_then(|points| fit_order(&points)).map(|fitted| fitted.order)
        };
        let mut words = Vec::new();
        let broken_energy = |row: &Row| {
            let is_rounding = row.errors_above_rounding().h1.is_none();
            row.error.broken_energy.filter(|_| !is_rounding)
        };
        let bound = |row: &Row| row.errors_above_rounding().bound;
        let orders = [("bound", order(bound)), ("energy norm", order(broken_energy))];
        let orders = orders.iter().filter_map(|(name, p)| Some(format!("{name} {:.2}", (*p)?)));
        let orders: Vec<String> = orders.collect();
        if !orders.is_empty() {
            words.push(format!("order {} from step {} on", orders.join(", "), half[0].level));
        }
        let effectivities = || steps.iter().filter_map(|row| row.bound.effectivity);
        let least = effectivities().fold(f64::INFINITY, f64::min);
        if least.is_finite() {
            let largest = effectivities().fold(0.0, f64::max);
            words.push(format!("effectivity {least:.2} to {largest:.2}"));
        }
        let (all, step) = (last.seconds.total, last.seconds.total - before.seconds.total);
        if step > 0.0 {
            words.push(format!("all steps take {:.1} times the last", all / step));
        }
        Some(format!("{}: {}", series.name, words.join("; ")))
    };
    let adaptive = series_of(rows).into_iter().filter(|s| s.variant.meshes.is_adaptive());
    adaptive.filter_map(of_series).collect()
}
