//! A panel of a picture: areas, lines and marks over two coordinates.

use super::axes::{
    BOTTOM, Frame, LABEL, LEFT, LINE, RIGHT, Stroke, Symbol, TICK, TITLE, TOP, draw_legend,
    draw_mark, quantity,
};
use super::colour::{Scale, labels};
use super::triangle::PlanePoint;
use crate::arrays::map_entries;
use crate::plot::pen::{Align, Colour, PAPER, Pen, ScreenPoint};
use crate::plot::style::INK;

/// Largest height of a map over its width on paper, and the height of a graph over its width.
const TALLEST: f64 = 1.4;
const RATIO: f64 = 0.5;
/// Height of the bar of colours, and of it with its labels.
const BAR: f64 = 12.0;
const BAR_ROOM: f64 = 62.0;

/// A panel.
#[derive(Clone, Debug, Default)]
pub(crate) struct Panel {
    pub title: &'static str,
    pub low: PlanePoint,
    pub high: PlanePoint,
    /// The names of the axes.
    pub axes: [&'static str; 2],
    /// Whether the second axis is not one of lengths, so that the two need not be equal.
    pub is_graph: bool,
    /// Where the coordinate axes of space point to, in place of the frame with numbers.
    pub directions: Option<[PlanePoint; 3]>,
    /// Areas of one colour each, painted in this order.
    pub fills: Vec<(Colour, Vec<PlanePoint>)>,
    /// Lines, drawn in this order.
    pub lines: Vec<(Stroke, [PlanePoint; 2])>,
    /// Points of the exact free boundary.
    pub marks: Vec<PlanePoint>,
    pub scale: Option<Scale>,
    pub legend: Vec<(Symbol, &'static str)>,
}

impl Panel {
    /// A panel of the smallest box around points.
    pub fn around(title: &'static str, points: impl Iterator<Item = PlanePoint>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for at in points {
            for k in 0..2 {
                low[k] = low[k].min(at[k]);
                high[k] = high[k].max(at[k]);
            }
        }
        Panel { title, low, high, ..Panel::default() }
    }

    /// Adds lines of one kind, and their entry in the legend if there are any. Returns whether there are.
    pub fn add_lines(
        &mut self,
        stroke: Stroke,
        lines: impl IntoIterator<Item = [PlanePoint; 2]>,
        label: &'static str,
    ) -> bool {
        let before = self.lines.len();
        self.lines.extend(lines.into_iter().map(|ends| (stroke, ends)));
        let has_lines = self.lines.len() > before;
        if has_lines {
            self.legend.push((Symbol::Line(stroke), label));
        }
        has_lines
    }

    /// Adds marks of points of the exact free boundary, and their entry in the legend.
    pub fn add_marks(&mut self, marks: Vec<PlanePoint>) {
        if !marks.is_empty() {
            self.legend.push((Symbol::Mark, "free boundary, exact"));
            self.marks = marks;
        }
    }

    /// Width and height of the data on paper where they may be this wide.
    fn data_size(&self, width: f64) -> (f64, f64) {
        if self.is_graph {
            return (width, RATIO * width);
        }
        let ratio = (self.high[1] - self.low[1]) / (self.high[0] - self.low[0]);
        let height = (width * ratio).min(TALLEST * width);
        (height / ratio, height)
    }

    /// Height of the panel.
    pub fn height(&self, width: f64) -> f64 {
        let of_bar = if self.scale.is_some() { BAR_ROOM } else { 0.0 };
        let below = of_bar.max(self.legend.len() as f64 * LINE + 8.0);
        TOP + self.data_size(width - LEFT - RIGHT).1 + BOTTOM + below
    }

    /// Draws the panel with its upper left corner at a position.
    pub fn draw(&self, pen: &mut Pen, at: ScreenPoint, width: f64) {
        let room = width - LEFT - RIGHT;
        let size = self.data_size(room);
        let left = at.0 + LEFT + 0.5 * (room - size.0);
        let frame = Frame { origin: (left, at.1 + TOP), size, low: self.low, high: self.high };
        let middle = left + 0.5 * size.0;
        pen.text(self.title, (middle, at.1 + TOP / 2.0), TITLE, INK, Align::Centre);
        for (colour, corners) in &self.fills {
            let corners: Vec<ScreenPoint> = corners.iter().map(|&c| frame.place(c)).collect();
            pen.fill(&corners, *colour);
        }
        // below the lines, some of which run along it
        match self.directions {
            Some(directions) => draw_directions(pen, &directions, (at.0, at.1 + TOP + size.1)),
            None => frame.draw(pen, self.axes),
        }
        let lines =
            || self.lines.iter().map(|&(stroke, ends)| (stroke, ends.map(|x| frame.place(x))));
        // what separates exact lines from those below
        for (_, [from, to]) in lines().filter(|(stroke, _)| *stroke == Stroke::EXACT) {
            pen.line(from, to, 4.0, PAPER);
        }
        lines().for_each(|(stroke, [from, to])| stroke.draw(pen, from, to));
        self.marks.iter().for_each(|&mark| draw_mark(pen, frame.place(mark)));
        let below = at.1 + TOP + size.1 + BOTTOM;
        if let Some(scale) = &self.scale {
            draw_bar(pen, scale, (at.0 + LEFT, below + 6.0), room);
        }
        draw_legend(pen, &self.legend, (at.0 + LEFT, below + 4.0))
    }
}

/// Draws short coordinate axes in the corner at the lower left of the data.
fn draw_directions(pen: &mut Pen, directions: &[PlanePoint; 3], (left, bottom): ScreenPoint) {
    let origin = (left + 30.0, bottom);
    for (direction, name) in directions.iter().zip(["x", "y", "z"]) {
        let at = |length: f64| (origin.0 + length * direction[0], origin.1 - length * direction[1]);
        pen.line(origin, at(24.0), 1.2, INK);
        pen.text(name, at(33.0), TICK, INK, Align::Centre);
    }
}

/// Draws the bar of colours with numbers and the name of the quantity.
fn draw_bar(pen: &mut Pen, scale: &Scale, (left, top): ScreenPoint, width: f64) {
    let bottom = top + BAR;
    let at = |share: f64| left + share * width;
    for band in 0..scale.bands() {
        let ends = map_entries([band, band + 1], |k| at(scale.position(scale.levels[k])));
        let [a, b] = ends;
        pen.fill(&[(a, top), (b, top), (b, bottom), (a, bottom)], scale.colour(band));
    }
    let right = at(1.0);
    pen.outline(&[(left, top), (right, top), (right, bottom), (left, bottom)], 0.8, INK);
    let (low, high) = (scale.levels[0], scale.levels[scale.bands()]);
    let most = if width < 300.0 { 4 } else { 8 };
    let (ticks, power) = labels(low, high, most);
    for (value, text) in ticks {
        let x = at(scale.position(value));
        pen.line((x, bottom), (x, bottom + 3.0), 0.8, INK);
        pen.text(&text, (x, bottom + 12.0), TICK, INK, Align::Centre);
    }
    let middle = (left + 0.5 * width, bottom + 33.0);
    pen.text(&quantity("u", power), middle, LABEL, INK, Align::Centre)
}
