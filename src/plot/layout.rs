//! Positions of panels and legend.

use super::pen::{Align, Pen, ScreenPoint, text_width};
use super::style::{GREY, INK, draw_failed, draw_limit, draw_mark, draw_slope, segment};

/// Width and height of a panel with its labels.
pub(crate) const PANEL: (f64, f64) = (380.0, 300.0);

const MARGIN: f64 = 10.0;
const LINE: f64 = 22.0;
const SYMBOL: f64 = 34.0;
const GAP: f64 = 22.0;
const TEXT: f64 = 15.0;

/// A sign that the legend explains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    /// The cross of a run that did not converge.
    Failed,
    /// A triangle with the slopes of promised orders.
    Promised,
    /// A dotted triangle with slopes to compare with.
    Compared,
    /// The line of a limit.
    Limit,
    /// The band between an error and the bound on it.
    Band,
}

impl Sign {
    /// All, in the order of legends.
    pub const ALL: [Self; 5] =
        [Self::Failed, Self::Promised, Self::Compared, Self::Limit, Self::Band];

    fn label(self) -> &'static str {
        match self {
            Sign::Failed => "did not converge",
            Sign::Promised => "orders promised by theory",
            Sign::Compared => "slopes for comparison",
            Sign::Limit => "limit",
            Sign::Band => "band: up to the bound on the error",
        }
    }

    /// Draws the sign beside its label, to the right of a position.
    fn draw(self, pen: &mut Pen, (x, y): ScreenPoint) {
        let (right, low, high) = (x + SYMBOL, y + 6.0, y - 6.0);
        match self {
            Sign::Failed => draw_failed(pen, (x + SYMBOL / 2.0, y)),
            Sign::Promised | Sign::Compared => {
                let (tip, corner, end) = ((x + 4.0, low), (right - 4.0, low), (right - 4.0, high));
                pen.line(tip, corner, 0.8, GREY);
                pen.line(corner, end, 0.8, GREY);
                draw_slope(pen, tip, end, self == Sign::Promised);
            }
            Sign::Band => {
                pen.fill_faintly(&[(x, low), (right, low), (right, high), (x, high)], INK)
            }
            Sign::Limit => draw_limit(pen, (x, y), (right, y)),
        }
    }
}

/// Positions of panels and of the entries of the legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FigureLayout {
    /// Width and height of the figure.
    pub size: (f64, f64),
    /// Upper left corners of the panels.
    pub panels: Vec<ScreenPoint>,
    legend: Vec<ScreenPoint>,
}

impl FigureLayout {
    /// Panels in a grid, the legend below them in columns of equal width.
    pub fn new(panels: usize, columns: usize, keys: &[String], signs: &[Sign]) -> Self {
        let rows = panels.max(1).div_ceil(columns);
        let places = (0..panels).map(|i| {
            (MARGIN + (i % columns) as f64 * PANEL.0, MARGIN + (i / columns) as f64 * PANEL.1)
        });
        let labels = keys.iter().map(|key| &key[..]).chain(signs.iter().map(|sign| sign.label()));
        let widest = labels.map(|label| text_width(label, TEXT)).fold(0.0, f64::max);
        let entry = SYMBOL + 6.0 + widest + GAP;
        // an entry of the legend may be wider than the panels
        let width = 2.0 * MARGIN + entry.max(columns as f64 * PANEL.0);
        let entries = keys.len() + signs.len();
        let of_line = (((width - 2.0 * MARGIN) / entry) as usize).clamp(1, entries.max(1));
        let left = (width - of_line as f64 * entry + GAP) / 2.0;
        let top = MARGIN + rows as f64 * PANEL.1 + LINE / 2.0;
        let place =
            |k: usize| (left + (k % of_line) as f64 * entry, top + (k / of_line) as f64 * LINE);
        let bottom = top + entries.max(1).div_ceil(of_line) as f64 * LINE;
        FigureLayout {
            size: (width, bottom - LINE / 2.0 + MARGIN),
            panels: places.collect(),
            legend: (0..entries).map(place).collect(),
        }
    }

    /// Draws the legend of these curves and signs.
    pub fn draw_legend(&self, pen: &mut Pen, keys: &[String], signs: &[Sign]) {
        let (of_curves, of_signs) = self.legend.split_at(keys.len());
        let write = |pen: &mut Pen, label: &str, (x, y): ScreenPoint| {
            pen.text(label, (x + SYMBOL + 6.0, y), TEXT, INK, Align::Left);
        };
        for (key, (name, &(x, y))) in keys.iter().zip(of_curves).enumerate() {
            segment(pen, key, (x, y), (x + SYMBOL, y));
            draw_mark(pen, key, (x + SYMBOL / 2.0, y), 1.0);
            write(pen, name, (x, y));
        }
        for (sign, &at) in signs.iter().zip(of_signs) {
            sign.draw(pen, at);
            write(pen, sign.label(), at);
        }
    }
}
