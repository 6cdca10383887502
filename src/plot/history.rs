//! Certificates over the work of a solve.

use super::figure::Figure;
use super::series::{Curve, Orders, Panel, Point};
use crate::study::row::{Row, distinct};
use crate::study::series::series_of;

/// Linear systems, seconds, and the largest part of the certificate.
type At = (usize, f64, Option<f64>);

/// The largest part of the certificate after each outer step on the finest level of every scheme and solver, against
/// seconds and against linear systems, with the limit of certificates where it is known; none where no solve of the scene
/// has a history of two points. A certificate of zero has no place on a logarithmic axis.
pub(crate) fn history_figure(rows: &[Row], scene: &str, limit: Option<f64>) -> Option<Figure> {
    let of_scene: Vec<&Row> = rows.iter().filter(|row| row.scene == scene).collect();
    let series = series_of(&of_scene);
    let finest: Vec<&Row> = series.iter().filter_map(|of| of.rows.last().copied()).collect();
    let levels = distinct(finest.iter().map(|row| row.level));
    let title = match levels[..] {
        [level] => format!("{scene}, level {level}"),
        _ => format!("{scene}, last levels"),
    };
    let panel = |label: &str, x: fn(&At) -> f64| {
        let curve = |(key, row): (usize, &&Row)| {
            let history = row.history.as_deref().unwrap_or_default();
            let failed = |k: usize| !row.converged() && k + 1 == history.len();
            let point = |(k, at): (usize, &At)| {
                let y = at.2.filter(|y| *y > 0.0 && !failed(k));
                (y.is_some() || failed(k)).then(|| Point { x: x(at), y, bound: None })
            };
            Curve { key, points: history.iter().enumerate().filter_map(point).collect() }
        };
        let curves = finest.iter().enumerate().map(curve);
        let y = "largest part of the certificate";
        let mut panel = Panel::of(&title, (label, y), curves, Orders::default());
        panel.limit = limit;
        panel
    };
    // the axis is logarithmic
    let panels = vec![
        panel("time of the solve in s", |at| at.1.max(1e-6)),
        panel("linear systems", |at| at.0 as f64),
    ];
    let keys = series.iter().map(|of| of.name.clone()).collect();
    panels[0].has_curves().then_some(Figure { panels, keys, columns: 2 })
}
