//! Numbers over the parameter of a sweep.

use super::figure::Figure;
use super::series::{Curve, Orders, Panel, Point};
use crate::study::row::distinct;

/// A number at a place of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SweepPoint {
    /// Title of the panel.
    pub title: String,
    /// Names of parameter and number.
    pub axes: [String; 2],
    /// The curve.
    pub series: String,
    /// Value of the parameter.
    pub at: f64,
    /// The number; none if there is none.
    pub value: Option<f64>,
    /// The largest number allowed.
    pub limit: Option<f64>,
}

/// Panels of the same title and axes side by side; none without a panel that has a curve. Only positive
/// numbers are drawn.
pub(crate) fn sweep_figure(points: &[SweepPoint]) -> Option<Figure> {
    let series = distinct(points.iter().map(|p| &p.series));
    let panel = |(title, axes): (&String, &[String; 2])| {
        let here = || points.iter().filter(|p| (&p.title, &p.axes) == (title, axes));
        let curves = series.iter().enumerate().map(|(key, name)| {
            let point = |p: &SweepPoint| Point {
                x: p.at,
                y: p.value.filter(|y| *y > 0.0),
                bound: None,
                converged: p.value.is_some(),
            };
            let mine = here().filter(|p| p.series == **name).map(point);
            let mut points: Vec<Point> = mine.filter(|p| p.y.is_some() || !p.converged).collect();
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
            Curve { key, points }
        });
        let mut panel = Panel::of(title, (&axes[0], &axes[1]), curves, Orders::default());
        panel.limits = distinct(here().filter_map(|p| p.limit).filter(|limit| *limit > 0.0));
        panel
    };
    let mut panels: Vec<Panel> = distinct(points.iter().map(|p| (&p.title, &p.axes)))
        .into_iter()
        .map(panel)
        .filter(Panel::has_curves)
        .collect();
    // the legend names the curves that are drawn
    let is_drawn = |key: usize| panels.iter().any(|p| p.curves.iter().any(|c| c.key == key));
    let drawn: Vec<usize> = (0..series.len()).filter(|&key| is_drawn(key)).collect();
    for curve in panels.iter_mut().flat_map(|panel| &mut panel.curves) {
        curve.key = drawn.iter().position(|&key| key == curve.key).unwrap_or(0);
    }
    let columns = match panels.len() {
        0 | 1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    let keys = drawn.iter().map(|&key| series[key].clone()).collect();
    (!panels.is_empty()).then_some(Figure { panels, keys, columns })
}
