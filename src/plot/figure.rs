//! Figures of a report: error against mesh size, and error against time.

use super::layout::{FigureLayout, Sign};
use super::series::{Key, Panel, Quantity, keys, scenes, with_curves};
use crate::study::Row;

/// A drawing that can be written as SVG or PNG.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The panels, row by row.
    pub(super) panels: Vec<Panel>,
    /// The entries of the legend, shared by the panels.
    pub(super) keys: Vec<Key>,
    /// Number of panels in a row.
    pub(super) columns: usize,
}

/// Error against mesh size, with reference slopes: for each scene one panel for the L2 error and
/// one for the error in the broken H1 seminorm.
pub fn convergence(rows: &[Row]) -> Figure {
    let keys = keys(rows);
    let scenes = scenes(rows);
    let columns = match scenes.len() {
        0..=3 => 2,
        4..=16 => 4,
        _ => 6,
    };
    let panels = scenes
        .iter()
        .flat_map(|scene| {
            let panel = |error| Panel::new(rows, &keys, scene, Quantity::MeshSize, error);
            with_curves([Quantity::L2, Quantity::H1].map(panel).into())
        })
        .collect();
    Figure { panels, keys, columns }
}

/// L2 error against the seconds a run took altogether, one panel for each scene. Runs that did not
/// converge are marked.
pub fn work_precision(rows: &[Row]) -> Figure {
    let keys = keys(rows);
    let scenes = scenes(rows);
    let columns = match scenes.len() {
        0 | 1 => 1,
        2 | 4 => 2,
        3 | 5 | 6 | 9 => 3,
        7..=16 => 4,
        _ => 6,
    };
    let panels = scenes
        .iter()
        .map(|scene| Panel::new(rows, &keys, scene, Quantity::Seconds, Quantity::L2))
        .flat_map(|panel| with_curves(vec![panel]))
        .collect();
    Figure { panels, keys, columns }
}

impl Figure {
    /// Whether a run that is shown did not converge.
    fn has_failures(&self) -> bool {
        self.panels.iter().any(|p| p.curves.iter().any(|c| c.points.iter().any(|q| !q.converged)))
    }

    /// Whether a panel with curves shows orders, which theory promises or not.
    fn has_orders(&self, are_promised: bool) -> bool {
        let shows = |p: &Panel| p.has_curves() && !p.orders.orders.is_empty();
        self.panels.iter().any(|p| shows(p) && p.orders.are_promised == are_promised)
    }

    /// Whether a panel shows limits.
    fn has_limits(&self) -> bool {
        self.panels.iter().any(|p| !p.limits.is_empty())
    }

    /// Positions of panels and legend.
    pub(super) fn layout(&self) -> FigureLayout {
        let mut signs = Vec::new();
        signs.extend(self.has_failures().then_some(Sign::Failed));
        signs.extend(self.has_orders(true).then_some(Sign::Promised));
        signs.extend(self.has_orders(false).then_some(Sign::Compared));
        signs.extend(self.has_limits().then_some(Sign::Limit));
        FigureLayout::new(self.panels.len(), self.columns, &self.keys, &signs)
    }
}
