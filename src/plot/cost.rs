//! Errors against cost: one column of panels, as wide as a column of text.

use super::figure::Figure;
use super::series::{Curve, Orders, Panel, Point, Quantity, title, with_curves};
use crate::study::series::Series;

/// The panels of a scene over seconds or unknowns, one for each norm in which there are errors and one for bounds,
/// below each other; energy only where it is not the H1 seminorm.
pub(crate) fn cost_figure(scene: &str, series: &[&Series<'_>], cost: Quantity) -> Figure {
    let rows = || series.iter().flat_map(|of| of.rows.iter().copied());
    let panel = |y: Quantity| {
        let x = match (cost, y) {
            (Quantity::Seconds, Quantity::Bound) => Quantity::SecondsWithBound,
            _ => cost,
        };
        let curves = series.iter().enumerate().map(|(key, of)| Curve {
            key,
            points: of.rows.iter().filter_map(|row| Point::of(row, x, y)).collect(),
        });
        // an order in the mesh size is that order over the dimension in the number of unknowns
        let dimension = rows().next().map(|r| r.dimension as u32);
        let orders = match dimension.filter(|_| cost == Quantity::Unknowns) {
            None => Orders::default(),
            falls_over => Orders { falls_over, ..y.orders(rows()) },
        };
        Panel::of(&title(scene, rows()), (x.label(), y.label()), curves, orders)
    };
    let mut shown = vec![Quantity::L2, Quantity::H1, Quantity::Energy];
    if rows().all(|row| row.error.is_energy_h1()) {
        shown.pop();
    }
    shown.push(Quantity::Bound);
    Figure {
        panels: with_curves(shown.into_iter().map(panel).collect()),
        keys: series.iter().map(|of| of.name.clone()).collect(),
        columns: 1,
    }
}
