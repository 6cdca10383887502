//! The limits of energy, contact measure and contact force as the mesh size tends to zero, from three levels.

use std::borrow::Borrow;
use std::collections::BTreeMap;

use super::row::Row;
use super::series::{Series, Variant, series_of};
use crate::measure::Rounding;

/// The limit of a figure as the mesh size tends to zero.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Limit {
    /// The limit.
    pub value: f64,
    /// The order `p` of the error `C h^p` of the three figures; none for figures that are equal up to
    /// rounding.
    pub order: Option<f64>,
}

/// Figures that differ by less than this share of their size are equal: a solve is no more accurate.
const EQUAL: f64 = 1e-9;
/// The orders that are searched. Figures whose differences fall more slowly have not begun to tend to a limit: a contact
/// set, say, that grows by whole cells. Their extrapolation would lie far from all three.
const ORDERS: [f64; 2] = [0.5, 12.0];

/// The limit of three figures as [`Report::extrapolated`](crate::study::Report::extrapolated) has it; for halved mesh
/// sizes the formula of Aitken.
fn limit(figures: [f64; 3], mesh_sizes: [f64; 3]) -> Option<Limit> {
    let ([a, b, c], [h, k, l]) = (figures, mesh_sizes);
    let is_refined = h > k && k > l && l > 0.0;
    if !is_refined || ![a, b, c].iter().all(|x| x.is_finite()) {
        return None;
    }
    let size = a.abs().max(b.abs()).max(c.abs());
    if (a - b).abs().max((b - c).abs()) <= EQUAL * size {
        return Some(Limit { value: c, order: None });
    }
    // mesh sizes over the finest one: their powers do not underflow
    let [h, k] = [h / l, k / l];
    let quotient = |p: f64| (h.powf(p) - k.powf(p)) / (k.powf(p) - 1.0);
    let wanted = (a - b) / (b - c);
    let [mut low, mut high] = ORDERS;
    // the quotient grows with the order
    if !(quotient(low) < wanted && wanted < quotient(high)) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if quotient(middle) < wanted { low = middle } else { high = middle }
    }
    let value = c - (b - c) / (k.powf(low) - 1.0);
    Some(Limit { value, order: Some(low) })
}

/// The limits of the figures of one series of rows.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Extrapolated {
    /// Name of the scene.
    pub scene: String,
    /// Label of the rows.
    pub label: String,
    /// Solver of the rows.
    pub solver: String,
    /// Limit of the energy.
    pub energy: Option<Limit>,
    /// Limit of the measure of the contact set.
    pub contact_measure: Option<Limit>,
    /// Limit of the total contact force.
    pub resultant: Option<Limit>,
    /// Limits of values by name; reports of problems that ask for none do not have the key.
    #[cfg_attr(feature = "report", serde(skip_serializing_if = "BTreeMap::is_empty"))]
    pub values: BTreeMap<String, Option<Limit>>,
}

/// The limits of [`Report::extrapolated`](crate::study::Report::extrapolated); figures that are all rounding have none.
pub(crate) fn extrapolate<R: Borrow<Row>>(rows: &[R]) -> Vec<Extrapolated> {
    let of_series = |series: Series<'_>| {
        let levels: Vec<&Row> = series.rows.iter().copied().filter(|r| r.converged()).collect();
        let three: &[&Row; 3] = levels.last_chunk()?;
        let of = |figure: &dyn Fn(&Row) -> Option<f64>, rounding: fn(&Rounding) -> f64| {
            let [a, b, c] = three.map(figure);
            let figures = [a?, b?, c?];
            let rounding = three.map(|r| r.rounding.as_ref().map_or(0.0, rounding));
            let rounding = rounding.into_iter().fold(0.0, f64::max);
            let is_within = |x: f64| rounding > 0.0 && x.abs() <= rounding;
            let [a, b, c] = figures;
            if figures.into_iter().all(is_within) {
                return None;
            }
            match is_within(a - b) && is_within(b - c) {
                true => Some(Limit { value: c, order: None }),
                false => limit(figures, three.map(|r| r.mesh_size)),
            }
        };
        let Variant { scene, label, solver, .. } = series.variant;
        Some(Extrapolated {
            scene,
            label,
            solver,
            energy: of(&|r| r.energy, |rounding| rounding.energy),
            contact_measure: of(&|r| r.contact_measure, |_| 0.0),
            resultant: of(&|r| r.resultant, |rounding| rounding.force),
            values: three[2]
                .values
                .keys()
                .map(|name| (name.clone(), of(&|r| *r.values.get(name)?, |_| 0.0)))
                .collect(),
        })
    };
    let uniform = series_of(rows).into_iter().filter(|s| s.variant.theta.is_none());
    uniform.filter_map(of_series).collect()
}
