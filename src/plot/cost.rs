//! Errors against cost: one column of panels, as wide as a column of text.

use super::figure::Figure;
use super::series::{Orders, Panel, Quantity, with_curves};
use crate::study::series::Series;

/// The panels of a scene over seconds or unknowns, one for each norm in which there are errors and one for bounds,
/// below each other; energy only where it is not the H1 seminorm.
pub(crate) fn cost_figure(scene: &str, series: &[&Series<'_>], cost: Quantity) -> Figure {
    let keys: Vec<String> = series.iter().map(|of| of.name.clone()).collect();
    let rows = || series.iter().flat_map(|of| of.rows.iter().copied());
    let panel = |y: Quantity| {
        let x = match (cost, y) {
            (Quantity::Seconds, Quantity::Bound) => Quantity::SecondsWithBound,
            _ => cost,
        };
        let mut panel = Panel::new((scene, series), &keys, x, y);
        if cost == Quantity::Unknowns {
            // errors of the order h^p are of the order N^(-p/D) in the number N of unknowns
            let falls_over = rows().map(|row| row.dimension as u32).next();
            panel.orders = Orders { falls_over, ..y.orders(rows()) };
        }
        panel
    };
    let mut shown = vec![Quantity::L2, Quantity::H1, Quantity::Energy];
    if rows().all(|row| row.error.is_energy_h1()) {
        shown.pop();
    }
    shown.push(Quantity::Bound);
    let panels = with_curves(shown.into_iter().map(panel).collect());
    Figure { panels, keys, columns: 1 }
}
