//! Plots of a report: error against mesh size, and error against time.
//!
//! What is drawn ([`series`]), where it stands ([`axis`], [`layout`]) and how ([`panel`], [`pen`],
//! [`style`]) are kept apart from the file formats ([`render`]), so that SVG and PNG show the same.

mod axis;
mod cost;
mod layout;
mod panel;
mod pen;
mod picture;
mod render;
mod series;
mod slopes;
mod style;

use crate::study::Row;
pub(crate) use cost::{Cost, NamedCurve, cost_figure};
use layout::Layout;
pub(crate) use pen::{Align, Drawn, Pen, Place, text_width};
pub use picture::{Picture, Slice, solve_level};
pub(crate) use render::{Drawing, draw_png, draw_svg};
use series::{Key, Panel, Quantity, keys, scenes};
pub(crate) use style::{INK, PAPER, colour};

/// A drawing that can be written as SVG or PNG.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The panels, row by row.
    panels: Vec<Panel>,
    /// The entries of the legend, shared by the panels.
    keys: Vec<Key>,
    /// How many panels stand in a row.
    columns: usize,
}

/// Error against mesh size, with reference slopes: for each scene one panel for the L2 error and one
/// for the error in the broken H1 seminorm.
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
        .flat_map(|scene| [Quantity::L2, Quantity::H1].map(|error| (scene, error)))
        .map(|(scene, error)| Panel::new(rows, &keys, scene, Quantity::MeshSize, error))
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
        .collect();
    Figure { panels, keys, columns }
}

impl Figure {
    /// Whether a run that is shown did not converge.
    fn has_failures(&self) -> bool {
        self.panels.iter().any(|p| p.curves.iter().any(|c| c.points.iter().any(|q| !q.converged)))
    }

    /// Where everything stands.
    fn layout(&self) -> Layout {
        Layout::new(self.panels.len(), self.columns, &self.keys, self.has_failures())
    }
}
