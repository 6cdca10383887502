//! Errors against cost: one column of panels, as wide as a column of text.

use super::figure::Figure;
use super::series::{Curve, Key, Orders, Panel, Point, Quantity, title, with_curves};
use crate::study::row::Row;

/// A measure of the cost of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cost {
    Seconds,
    Unknowns,
}

impl Cost {
    /// Name of the measure in names of files.
    pub fn name(self) -> &'static str {
        match self {
            Cost::Seconds => "time",
            Cost::Unknowns => "unknowns",
        }
    }

    fn quantity(self) -> Quantity {
        match self {
            Cost::Seconds => Quantity::Seconds,
            Cost::Unknowns => Quantity::Unknowns,
        }
    }
}

/// A curve with its entry in the legend; rows from coarse to fine.
pub(crate) struct NamedCurve<'a> {
    pub label: String,
    pub rows: Vec<&'a Row>,
}

/// The panels of a scene, one for each norm in which there are errors and one for bounds, below each other;
/// energy only where it is not the H1 seminorm.
pub(crate) fn cost_figure(scene: &str, named: &[NamedCurve<'_>], cost: Cost) -> Figure {
    let panel = |y: Quantity| {
        let x = match (cost, y) {
            (Cost::Seconds, Quantity::Bound) => Quantity::SecondsWithBound,
            _ => cost.quantity(),
        };
        let curves = named.iter().enumerate().map(|(key, curve)| Curve {
            key,
            points: curve.rows.iter().filter_map(|row| Point::of(row, x, y)).collect(),
        });
        let rows = || named.iter().flat_map(|c| &c.rows).copied();
        // an order in the mesh size is that order over the dimension in the number of unknowns
        let dimension = rows().next().map(|r| r.dimension as u32);
        let orders = match dimension.filter(|_| cost == Cost::Unknowns) {
            None => Orders::default(),
            falls_over => Orders { falls_over, ..y.orders(rows()) },
        };
        Panel::of(&title(scene, rows()), (x.label(), y.label()), curves, orders)
    };
    let mut shown = vec![Quantity::L2, Quantity::H1, Quantity::Energy];
    if named.iter().flat_map(|c| &c.rows).all(|row| row.error.is_energy_h1()) {
        shown.pop();
    }
    shown.push(Quantity::Bound);
    Figure {
        panels: with_curves(shown.into_iter().map(panel).collect()),
        keys: named.iter().map(|c| Key::labelled(&c.label)).collect(),
        columns: 1,
    }
}
