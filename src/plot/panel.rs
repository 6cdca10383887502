//! One panel: frame, ticks, curves, marks.

use super::axis::{LogAxis, Tick};
use super::layout::PANEL;
use super::pen::{Align, Pen, ScreenPoint};
use super::series::{Panel, Point};
use super::slopes::Slopes;
use super::style::{GRID, INK, colour, draw_failed, draw_limit, draw_mark, segment};

/// Room around the data for title, labels and ticks.
const LEFT: f64 = 70.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 48.0;
/// Width and height of the area of the data.
const SIZE: (f64, f64) = (PANEL.0 - LEFT - RIGHT, PANEL.1 - TOP - BOTTOM);

/// Width of the cross of a failure, and distance of its centre from an edge.
const CROSS: f64 = 17.0;
const EDGE: f64 = 10.0;

const TITLE: f64 = 16.0;
const LABEL: f64 = 15.0;
const TICK: f64 = 14.0;

/// A panel with its axes.
struct Frame<'a> {
    panel: &'a Panel,
    x: LogAxis,
    y: LogAxis,
    slopes: Option<Slopes>,
}

impl<'a> Frame<'a> {
    /// Axes around the data, with room for the reference slopes.
    fn new(panel: &'a Panel) -> Self {
        let x = LogAxis::over(&panel.points().map(|p| p.x).collect::<Vec<_>>());
        let y = LogAxis::over(&panel.errors());
        let mut frame = Frame { panel, x, y, slopes: None };
        if panel.has_curves() && !panel.orders.orders.is_empty() {
            for _ in 0..8 {
                let axes = (&frame.x, &frame.y);
                frame.slopes = Slopes::place(&panel.orders, axes, SIZE, &frame.occupied());
                if frame.slopes.is_some() {
                    return frame;
                }
                frame.y.low -= 0.08 * (frame.y.high - frame.y.low);
            }
            // Nowhere to put them: better none than on top of the data.
            frame.y = y;
        }
        frame
    }

    /// How far a value of the second axis is below the upper edge of the area.
    fn depth(&self, y: f64) -> f64 {
        (1.0 - self.y.position(y.log10())) * SIZE.1
    }

    /// A point relative to the upper left corner of the area. One with an error beyond the axis
    /// stands at the edge it is beyond, one without an error at the upper edge, where failures are
    /// looked for.
    fn place(&self, point: &Point) -> ScreenPoint {
        let x = self.x.position(point.x.log10()) * SIZE.0;
        let y = match point.y.map(|y| self.depth(y)) {
            Some(y) if y > SIZE.1 => SIZE.1 - EDGE,
            Some(y) if y >= 0.0 => y,
            _ => EDGE,
        };
        (x, y)
    }

    /// Places of all points, curve by curve. Failures without an error are moved down until they do
    /// not hide another failure.
    fn places(&self) -> Vec<Vec<ScreenPoint>> {
        let failed = |p: &Point| !p.converged && p.y.is_some();
        let mut taken: Vec<ScreenPoint> =
            self.panel.points().filter(failed).map(|p| self.place(&p)).collect();
        let mut place = |point: &Point| {
            let (x, mut y) = self.place(point);
            if point.y.is_none() {
                let hides =
                    |t: &ScreenPoint, y: f64| (t.0 - x).abs() < CROSS && (t.1 - y).abs() < CROSS;
                while y < SIZE.1 - EDGE && taken.iter().any(|t| hides(t, y)) {
                    y += 1.0;
                }
                taken.push((x, y));
            }
            (x, y)
        };
        self.panel.curves.iter().map(|c| c.points.iter().map(&mut place).collect()).collect()
    }

    /// Pixels that marks and lines occupy.
    fn occupied(&self) -> Vec<ScreenPoint> {
        let mut occupied = Vec::new();
        for places in self.places() {
            occupied.extend(&places);
            for pair in places.windows(2) {
                occupied.extend((1..16).map(|i| {
                    let t = f64::from(i) / 16.0;
                    (
                        pair[0].0 + t * (pair[1].0 - pair[0].0),
                        pair[0].1 + t * (pair[1].1 - pair[0].1),
                    )
                }));
            }
        }
        occupied
    }
}

/// Draws a panel with its upper left corner at a position.
pub(crate) fn draw_panel(pen: &mut Pen, panel: &Panel, at: ScreenPoint) {
    let frame = Frame::new(panel);
    let origin = (at.0 + LEFT, at.1 + TOP);
    draw_frame(pen, &frame, at, origin);
    if panel.has_curves() {
        draw_curves(pen, &frame, origin);
    }
}

/// Title, labels, ticks, slopes and limits; or why there are no curves.
fn draw_frame(pen: &mut Pen, frame: &Frame, at: ScreenPoint, origin: ScreenPoint) {
    let panel = frame.panel;
    let middle = (origin.0 + SIZE.0 / 2.0, origin.1 + SIZE.1 / 2.0);
    pen.text(&panel.title, (middle.0, at.1 + TOP / 2.0 + 1.0), TITLE, INK, Align::Centre);
    pen.text(&panel.x, (middle.0, at.1 + PANEL.1 - 14.0), LABEL, INK, Align::Centre);
    pen.text(&panel.y, (at.0 + 12.0, middle.1), LABEL, INK, Align::Upwards);
    let why = match panel.has_errors() {
        _ if panel.has_curves() => None,
        true => Some("one level: no curve"),
        false => Some("no exact solution: no errors"),
    };
    if let Some(why) = why {
        pen.text(why, middle, LABEL, INK, Align::Centre);
    } else {
        draw_ticks(pen, frame, origin);
        for limit in &panel.limits {
            let y = origin.1 + frame.depth(*limit);
            draw_limit(pen, (origin.0, y), (origin.0 + SIZE.0, y));
        }
    }
    if let Some(slopes) = &frame.slopes {
        slopes.draw(pen, origin);
    }
    let (right, bottom) = (origin.0 + SIZE.0, origin.1 + SIZE.1);
    pen.outline(&[origin, (right, origin.1), (right, bottom), (origin.0, bottom)], 1.0, INK);
}

/// Lines behind the data, ticks and their labels.
fn draw_ticks(pen: &mut Pen, frame: &Frame, (left, top): ScreenPoint) {
    let (right, bottom) = (left + SIZE.0, top + SIZE.1);
    let length = |tick: Tick| if tick.digit == 1 { 5.0 } else { 2.5 };
    for tick in frame.x.ticks(6) {
        let x = left + SIZE.0 * frame.x.position(tick.log());
        if tick.digit == 1 {
            pen.line((x, top), (x, bottom), 0.8, GRID);
        }
        pen.line((x, bottom), (x, bottom - length(tick)), 0.8, INK);
        if tick.labelled {
            let (base, exponent) = tick.label(frame.x.is_plain());
            pen.power(&base, &exponent, (x, bottom + 12.0), TICK, INK, Align::Centre);
        }
    }
    for tick in frame.y.ticks(8) {
        let y = bottom - SIZE.1 * frame.y.position(tick.log());
        if tick.digit == 1 {
            pen.line((left, y), (right, y), 0.8, GRID);
        }
        pen.line((left, y), (left + length(tick), y), 0.8, INK);
        if tick.labelled {
            let (base, exponent) = tick.label(frame.y.is_plain());
            pen.power(&base, &exponent, (left - 6.0, y), TICK, INK, Align::Right);
        }
    }
}

/// Bands first, then lines, then marks, then failures: what matters most is on top. A line ends where a run
/// did not converge.
fn draw_curves(pen: &mut Pen, frame: &Frame, origin: ScreenPoint) {
    let places: Vec<Vec<ScreenPoint>> = frame
        .places()
        .into_iter()
        .map(|c| c.into_iter().map(|(x, y)| (origin.0 + x, origin.1 + y)).collect())
        .collect();
    let curves = || frame.panel.curves.iter().zip(&places);
    for (curve, places) in curves() {
        for (points, ends) in curve.points.windows(2).zip(places.windows(2)) {
            let bound = |k: usize| {
                let y = points[k].bound.filter(|_| points[k].y.is_some())?;
                Some((ends[k].0, origin.1 + frame.depth(y).clamp(0.0, SIZE.1)))
            };
            if let (Some(left), Some(right)) = (bound(0), bound(1)) {
                pen.fill_faintly(&[ends[0], ends[1], right, left], colour(curve.key));
            }
        }
    }
    for (curve, places) in curves() {
        for (points, ends) in curve.points.windows(2).zip(places.windows(2)) {
            if points[0].converged && points[1].converged {
                segment(pen, curve.key, ends[0], ends[1]);
            }
        }
    }
    for converged in [true, false] {
        for (curve, places) in curves() {
            for (point, &at) in curve.points.iter().zip(places) {
                if point.converged != converged {
                    continue;
                }
                if converged {
                    draw_mark(pen, curve.key, at, 1.0);
                } else {
                    // the cross marks the failure, the small mark on it the scheme
                    draw_failed(pen, at);
                    draw_mark(pen, curve.key, at, 0.7);
                }
            }
        }
    }
}
