//! Frame, ticks and labels of linear axes, and the lines of a legend.

use super::colour::labels;
use super::triangle::PlanePoint;
use crate::plot::pen::{Align, Colour, PAPER, Pen, ScreenPoint};
use crate::plot::style::{INK, colour};

/// Sizes of text.
pub(crate) const TITLE: f64 = 17.0;
pub(crate) const LABEL: f64 = 16.5;
pub(crate) const TICK: f64 = 15.5;

/// Room for ticks and labels beside and below the data.
pub(crate) const LEFT: f64 = 58.0;
pub(crate) const RIGHT: f64 = 14.0;
pub(crate) const TOP: f64 = 26.0;
pub(crate) const BOTTOM: f64 = 44.0;
/// Height of a line of the legend.
pub(crate) const LINE: f64 = 21.0;

/// The contact set found.
pub(crate) const CONTACT: Colour = Colour(150, 190, 222);
/// The exact free boundary.
const EXACT: Colour = Colour(213, 94, 0);
/// What is behind.
pub(crate) const FAINT: Colour = Colour(205, 205, 205);

/// The width and the colour of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke(pub f64, pub Colour);

impl Stroke {
    /// An edge of the mesh.
    pub const MESH: Self = Stroke(0.5, FAINT);
    /// The boundary of the domain.
    pub const RIM: Self = Stroke(0.8, INK);
    /// The boundary of the discrete contact set.
    pub const FOUND: Self = Stroke(2.0, INK);
    /// A piece of the boundary in contact.
    pub const TOUCHING: Self = Stroke(7.0, CONTACT);
    /// The exact free boundary, or the exact contact set on a boundary.
    pub const EXACT: Self = Stroke(1.8, EXACT);
    /// An obstacle in a graph.
    pub const OBSTACLE: Self = Stroke(4.0, FAINT);
    /// The discrete solution in a graph.
    pub fn solution() -> Self {
        Stroke(1.6, colour(0))
    }
    /// Draws a segment.
    pub fn draw(self, pen: &mut Pen, from: ScreenPoint, to: ScreenPoint) {
        pen.line(from, to, self.0, self.1);
    }
}

/// The symbol of an entry of the legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Symbol {
    Area(Colour),
    Line(Stroke),
    Mark,
}

/// The mark of a point of the exact free boundary: a diamond.
pub(crate) fn draw_mark(pen: &mut Pen, (x, y): ScreenPoint) {
    let diamond = |r: f64| [(x + r, y), (x, y + r), (x - r, y), (x, y - r)];
    pen.fill(&diamond(7.0), PAPER);
    pen.fill(&diamond(5.0), EXACT)
}

/// Draws the lines of a legend below a position of the upper left corner.
pub(crate) fn draw_legend(pen: &mut Pen, entries: &[(Symbol, &str)], (x, y): ScreenPoint) {
    const WIDTH: f64 = 26.0;
    for (k, &(symbol, label)) in entries.iter().enumerate() {
        let middle = y + (k as f64 + 0.5) * LINE;
        match symbol {
            Symbol::Area(colour) => {
                let (top, bottom) = (middle - 6.0, middle + 6.0);
                let corners = [(x, top), (x + WIDTH, top), (x + WIDTH, bottom), (x, bottom)];
                pen.fill(&corners, colour);
            }
            Symbol::Line(stroke) => stroke.draw(pen, (x, middle), (x + WIDTH, middle)),
            Symbol::Mark => draw_mark(pen, (x + WIDTH / 2.0, middle)),
        }
        pen.text(label, (x + WIDTH + 7.0, middle), LABEL, INK, Align::Left);
    }
}

/// The name of a quantity whose numbers are divided by a power of ten.
pub(crate) fn quantity(name: &str, power: i32) -> String {
    match power {
        0 => name.to_owned(),
        p => format!("{name} / 1e{p}").replace('-', "\u{2212}"),
    }
}

/// The area of the data: position, size, and range of the data.
pub(crate) struct Frame {
    /// Upper left corner.
    pub origin: ScreenPoint,
    /// Width and height.
    pub size: (f64, f64),
    pub low: PlanePoint,
    pub high: PlanePoint,
}

impl Frame {
    /// Position of a point of the data.
    pub fn place(&self, at: PlanePoint) -> ScreenPoint {
        let share = |k: usize| (at[k] - self.low[k]) / (self.high[k] - self.low[k]);
        let (width, height) = self.size;
        (self.origin.0 + share(0) * width, self.origin.1 + (1.0 - share(1)) * height)
    }

    /// Draws outline, ticks, their labels and the names of the axes.
    pub fn draw(&self, pen: &mut Pen, names: [&str; 2]) {
        let (left, top) = self.origin;
        let (right, bottom) = (left + self.size.0, top + self.size.1);
        let (ticks, power) = labels(self.low[0], self.high[0], 5);
        for (value, text) in ticks {
            let (x, _) = self.place([value, self.low[1]]);
            pen.line((x, bottom), (x, bottom - 4.0), 0.8, INK);
            pen.text(&text, (x, bottom + 11.0), TICK, INK, Align::Centre);
        }
        let below = (0.5 * (left + right), bottom + 30.0);
        pen.text(&quantity(names[0], power), below, LABEL, INK, Align::Centre);
        let most = if self.size.1 < 120.0 { 3 } else { 5 };
        let (ticks, power) = labels(self.low[1], self.high[1], most);
        for (value, text) in ticks {
            let (_, y) = self.place([self.low[0], value]);
            pen.line((left, y), (left + 4.0, y), 0.8, INK);
            pen.text(&text, (left - 5.0, y), TICK, INK, Align::Right);
        }
        let beside = (left - LEFT + 10.0, 0.5 * (top + bottom));
        pen.text(&quantity(names[1], power), beside, LABEL, INK, Align::Upwards);
        pen.outline(&[(left, top), (right, top), (right, bottom), (left, bottom)], 0.8, INK)
    }
}
