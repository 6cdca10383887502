//! Figures of a report: error against mesh size, and error against time.

use super::layout::{FigureLayout, Sign};
use super::panel::draw_panel;
use super::pen::Pen;
use super::series::{Panel, Quantity, with_curves};
use crate::study::row::distinct;
use crate::study::series::{by_scene, series_of};
use crate::study::{Row, Series};

/// A drawing that can be written as SVG.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The panels, row by row.
    pub(super) panels: Vec<Panel>,
    /// The entries of the legend, shared by the panels.
    pub(super) keys: Vec<String>,
    /// Number of panels in a row.
    pub(super) columns: usize,
}

/// Error against mesh size, with reference slopes: for each scene one panel for the L2 error and
/// one for the error in the broken H1 seminorm. With adaptive meshes error in the broken energy norm and bound
/// against the number of unknowns. A band goes from each error in the energy norm up to the bound on it; where no
/// error is known the bound itself is shown.
pub fn convergence(rows: &[Row]) -> Figure {
    let series = series_of(rows);
    let names = names(&series);
    let scenes = by_scene(&series);
    let panels: Vec<Panel> = scenes
        .iter()
        .flat_map(|(scene, series)| {
            let (size, errors) = match is_adaptive(series) {
                true => (Quantity::Unknowns, [Quantity::Energy, Quantity::Bound]),
                false => (Quantity::MeshSize, [Quantity::L2, Quantity::H1]),
            };
            let panel = |error| Panel::new((scene, series), &names, size, error);
            match has_errors(series) {
                true => with_curves(errors.map(panel).into()),
                false => with_curves(vec![panel(Quantity::Bound)]),
            }
        })
        .collect();
    Figure::new(panels, names)
}

/// The most panels of [`convergence`] that a first screen shows whole.
const MOST_PANELS: usize = 4;
/// The most scenes of a first screen.
const MOST_SCENES: usize = 4;

/// Whether a first screen has all that [`work_precision`] and [`convergence`] show.
pub(crate) fn shows_all(rows: &[Row]) -> [bool; 2] {
    let scenes = distinct(rows.iter().map(|row| &*row.scene)).len();
    [scenes <= MOST_SCENES, convergence(rows).panels.len() <= MOST_PANELS]
}

/// The two figures of a first screen with their captions, of the first scenes: error against time, one panel for each
/// scene, and errors against mesh size or unknowns, of many panels those of the same error.
pub(crate) fn overview(rows: &[Row]) -> [(String, Figure); 2] {
    let all = distinct(rows.iter().map(|row| &*row.scene));
    let first = &all[..all.len().min(MOST_SCENES)];
    let of: Vec<Row> = rows.iter().filter(|row| first.contains(&&*row.scene)).cloned().collect();
    let time = work_precision(&of);
    let Figure { mut panels, keys, .. } = convergence(&of);
    if panels.len() > MOST_PANELS {
        panels.retain(|panel| time.panels.iter().any(|other| other.y == panel.y));
    }
    let size = Figure::new(panels, keys);
    let caption = |figure: &Figure| {
        let of = |get: fn(&Panel) -> &str| distinct(figure.panels.iter().map(get)).join(" or ");
        let scenes = match all.len() > first.len() {
            true => format!(", on the first {} of {} scenes", first.len(), all.len()),
            false => String::new(),
        };
        format!("{} against {}{scenes}", of(|panel| &panel.y), of(|panel| &panel.x))
    };
    [time, size].map(|figure| (caption(&figure), figure))
}

/// L2 error against the seconds a run took altogether, one panel for each scene. With adaptive meshes, and where no
/// error is known, the error bound against the seconds with those of the bound. Runs that did not converge are marked.
pub fn work_precision(rows: &[Row]) -> Figure {
    let series = series_of(rows);
    let names = names(&series);
    let scenes = by_scene(&series);
    let panels = scenes
        .iter()
        .map(|(scene, series)| {
            let (time, error) = match is_adaptive(series) || !has_errors(series) {
                true => (Quantity::SecondsWithBound, Quantity::Bound),
                false => (Quantity::Seconds, Quantity::L2),
            };
            Panel::new((scene, series), &names, time, error)
        })
        .flat_map(|panel| with_curves(vec![panel]))
        .collect();
    Figure::new(panels, names)
}

/// The names of series, each once: a scheme on several scenes has one.
fn names(series: &[Series<'_>]) -> Vec<String> {
    distinct(series.iter().map(|series| series.name.clone()))
}

/// Whether some meshes of a scene are adaptive.
fn is_adaptive(series: &[&Series<'_>]) -> bool {
    series.iter().any(|s| s.variant.theta.is_some())
}

/// Whether some error of a scene is known.
fn has_errors(series: &[&Series<'_>]) -> bool {
    series.iter().flat_map(|s| &s.rows).any(|row| row.error.l2.is_some())
}

impl Figure {
    /// Panels side by side.
    fn new(panels: Vec<Panel>, keys: Vec<String>) -> Self {
        let columns = match panels.len() {
            0 | 1 => 1,
            2..=8 => 2,
            _ => 4,
        };
        Figure { panels, keys, columns }
    }

    /// The signs that panels show.
    fn signs(&self) -> Vec<Sign> {
        let has_orders = |p: &Panel| p.has_curves() && !p.orders.orders.is_empty();
        let shows = |sign: &Sign, p: &Panel| match sign {
            Sign::Failed => p.points().any(|point| point.y.is_none()),
            Sign::Promised => has_orders(p) && p.orders.are_promised,
            Sign::Compared => has_orders(p) && !p.orders.are_promised,
            Sign::Limit => p.limit.is_some(),
            Sign::Band => p.has_bands(),
        };
        Sign::ALL.into_iter().filter(|sign| self.panels.iter().any(|p| shows(sign, p))).collect()
    }

    /// The figure as the text of an SVG file.
    pub fn to_svg(&self) -> String {
        let signs = self.signs();
        let layout = FigureLayout::new(self.panels.len(), self.columns, &self.keys, &signs);
        let mut pen = Pen::new(layout.size, false);
        for (panel, &at) in self.panels.iter().zip(&layout.panels) {
            draw_panel(&mut pen, panel, at);
        }
        layout.draw_legend(&mut pen, &self.keys, &signs);
        pen.finish()
    }
}
