//! One panel: frame, ticks, curves, marks.

use super::axis::{LogAxis, Tick};
use super::layout::PANEL;
use super::pen::{Align, Pen, ScreenPoint};
use super::series::{Panel, Point};
use super::slopes::draw_slopes;
use super::style::{GRID, INK, colour, draw_failed, draw_limit, draw_mark, segment};

/// Room around the data for title, labels and ticks.
const LEFT: f64 = 70.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 48.0;
/// Width and height of the area of the data.
const SIZE: (f64, f64) = (PANEL.0 - LEFT - RIGHT, PANEL.1 - TOP - BOTTOM);

/// Distance of the cross of a failure from the upper edge.
const EDGE: f64 = 10.0;

const TITLE: f64 = 16.0;
const LABEL: f64 = 15.0;
const TICK: f64 = 14.0;

/// A panel with its axes.
struct Frame<'a> {
    panel: &'a Panel,
    x: LogAxis,
    y: LogAxis,
    /// The upper left corner of the area of the data.
    origin: ScreenPoint,
}

impl Frame<'_> {
    /// The height at which a value of the second axis stands.
    fn height(&self, y: f64) -> f64 {
        self.origin.1 + (1.0 - self.y.position(y.log10())) * SIZE.1
    }

    /// Where a point stands: a run that failed at the upper edge.
    fn place(&self, point: &Point) -> ScreenPoint {
        let x = self.origin.0 + self.x.position(point.x.log10()) * SIZE.0;
        (x, point.y.map_or(self.origin.1 + EDGE, |y| self.height(y)))
    }
}

/// Draws a panel with its upper left corner at a position.
pub(crate) fn draw_panel(pen: &mut Pen, panel: &Panel, at: ScreenPoint) {
    let frame = Frame {
        panel,
        x: LogAxis::over(&panel.points().map(|p| p.x).collect::<Vec<_>>()),
        y: LogAxis::over(&panel.errors()),
        origin: (at.0 + LEFT, at.1 + TOP),
    };
    draw_frame(pen, &frame, at);
    if panel.has_curves() {
        draw_curves(pen, &frame);
    }
}

/// Title, labels, ticks, slopes and limit; or why there are no curves.
fn draw_frame(pen: &mut Pen, frame: &Frame<'_>, at: ScreenPoint) {
    let (panel, (left, top)) = (frame.panel, frame.origin);
    let (right, bottom) = (left + SIZE.0, top + SIZE.1);
    let middle = (left + SIZE.0 / 2.0, top + SIZE.1 / 2.0);
    pen.text(&panel.title, (middle.0, at.1 + TOP / 2.0 + 1.0), TITLE, INK, Align::Centre);
    pen.text(&panel.x, (middle.0, at.1 + PANEL.1 - 14.0), LABEL, INK, Align::Centre);
    pen.text(&panel.y, (at.0 + 12.0, middle.1), LABEL, INK, Align::Upwards);
    if panel.has_curves() {
        draw_ticks(pen, frame);
        if let Some(limit) = panel.limit {
            let y = frame.height(limit);
            draw_limit(pen, (left, y), (right, y));
        }
        draw_slopes(pen, &panel.orders, (&frame.x, &frame.y), SIZE, frame.origin);
    } else {
        let why = match panel.has_errors() {
            true => "one level: no curve",
            // a point without an error is a run that failed
            false if panel.points().next().is_some() => "no run converged",
            false => "no exact solution: no errors",
        };
        pen.text(why, middle, LABEL, INK, Align::Centre);
    }
    pen.outline(&[(left, top), (right, top), (right, bottom), (left, bottom)], 1.0, INK);
}

/// Lines behind the data, ticks and their labels.
fn draw_ticks(pen: &mut Pen, frame: &Frame<'_>) {
    let (left, top) = frame.origin;
    let (right, bottom) = (left + SIZE.0, top + SIZE.1);
    let length = |tick: Tick| if tick.digit == 1 { 5.0 } else { 2.5 };
    for tick in frame.x.ticks(6) {
        let x = left + SIZE.0 * frame.x.position(tick.log());
        if tick.digit == 1 {
            pen.line((x, top), (x, bottom), 0.8, GRID);
        }
        pen.line((x, bottom), (x, bottom - length(tick)), 0.8, INK);
        if tick.labelled {
            let label = tick.label(frame.x.is_plain());
            pen.text(&label, (x, bottom + 12.0), TICK, INK, Align::Centre);
        }
    }
    for tick in frame.y.ticks(8) {
        let y = bottom - SIZE.1 * frame.y.position(tick.log());
        if tick.digit == 1 {
            pen.line((left, y), (right, y), 0.8, GRID);
        }
        pen.line((left, y), (left + length(tick), y), 0.8, INK);
        if tick.labelled {
            let label = tick.label(frame.y.is_plain());
            pen.text(&label, (left - 6.0, y), TICK, INK, Align::Right);
        }
    }
}

/// Bands first, then lines, then marks, then failures: what matters most is on top. A line ends where a run failed.
fn draw_curves(pen: &mut Pen, frame: &Frame<'_>) {
    let curves = &frame.panel.curves;
    let pairs = || curves.iter().flat_map(|c| c.points.windows(2).map(|ends| (c.key, ends)));
    for (key, ends) in pairs() {
        if let [Some(left), Some(right)] = [ends[0].bound, ends[1].bound] {
            let ends = [frame.place(&ends[0]), frame.place(&ends[1])];
            let corners = [(ends[1].0, frame.height(right)), (ends[0].0, frame.height(left))];
            pen.fill_faintly(&[ends[0], ends[1], corners[0], corners[1]], colour(key));
        }
    }
    for (key, ends) in pairs() {
        if ends.iter().all(|point| point.y.is_some()) {
            segment(pen, key, frame.place(&ends[0]), frame.place(&ends[1]));
        }
    }
    for is_failed in [false, true] {
        for curve in curves {
            for point in curve.points.iter().filter(|point| point.y.is_none() == is_failed) {
                let at = frame.place(point);
                // the cross marks the failure, the small mark on it the scheme
                if is_failed {
                    draw_failed(pen, at);
                }
                draw_mark(pen, curve.key, at, if is_failed { 0.7 } else { 1.0 });
            }
        }
    }
}
