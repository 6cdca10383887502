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
}

/// An entry of the legend.
#[derive(Clone, Debug, PartialEq)]
enum Entry {
    Curve(usize, String),
    Sign(Sign),
}

impl Entry {
    fn label(&self) -> &str {
        match self {
            Entry::Curve(_, label) => label,
            Entry::Sign(Sign::Failed) => "did not converge",
            Entry::Sign(Sign::Promised) => "orders promised by theory",
            Entry::Sign(Sign::Compared) => "slopes for comparison",
            Entry::Sign(Sign::Limit) => "limit",
            Entry::Sign(Sign::Band) => "band: up to the bound on the error",
        }
    }
    fn width(&self) -> f64 {
        SYMBOL + 6.0 + text_width(self.label(), TEXT)
    }
}

/// Positions of panels and legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FigureLayout {
    /// Width and height of the figure.
    pub size: (f64, f64),
    /// Upper left corners of the panels.
    pub panels: Vec<ScreenPoint>,
    legend: Vec<(ScreenPoint, Entry)>,
}

impl FigureLayout {
    /// Panels in a grid, the legend below them in as many lines as it takes.
    pub fn new(panels: usize, columns: usize, keys: &[String], signs: &[Sign]) -> Self {
        let rows = panels.max(1).div_ceil(columns);
        let places = (0..panels).map(|i| {
            (MARGIN + (i % columns) as f64 * PANEL.0, MARGIN + (i / columns) as f64 * PANEL.1)
        });

        let mut entries: Vec<Entry> =
            keys.iter().enumerate().map(|(k, key)| Entry::Curve(k, key.clone())).collect();
        entries.extend(signs.iter().copied().map(Entry::Sign));
        // an entry of the legend may be wider than the panels
        let widest = entries.iter().map(Entry::width).fold(columns as f64 * PANEL.0, f64::max);
        let width = 2.0 * MARGIN + widest;
        let mut lines: Vec<Vec<Entry>> = vec![Vec::new()];
        let room = width - 4.0 * MARGIN;
        let line_width = |line: &[Entry]| line.iter().map(|e| e.width() + GAP).sum::<f64>() - GAP;
        for entry in entries {
            let last = lines.len() - 1;
            if !lines[last].is_empty() && line_width(&lines[last]) + GAP + entry.width() > room {
                lines.push(vec![entry]);
            } else {
                lines[last].push(entry);
            }
        }
        let mut legend = Vec::new();
        let mut y = MARGIN + rows as f64 * PANEL.1 + LINE / 2.0;
        for line in lines {
            let mut x = (width - line_width(&line)) / 2.0;
            for entry in line {
                let step = entry.width() + GAP;
                legend.push(((x, y), entry));
                x += step;
            }
            y += LINE;
        }
        FigureLayout { size: (width, y - LINE / 2.0 + MARGIN), panels: places.collect(), legend }
    }

    /// Draws the legend.
    pub fn draw_legend(&self, pen: &mut Pen) {
        for ((x, y), entry) in &self.legend {
            let middle = (x + SYMBOL / 2.0, *y);
            match entry {
                Entry::Curve(key, _) => {
                    segment(pen, *key, (*x, *y), (x + SYMBOL, *y));
                    draw_mark(pen, *key, middle, 1.0);
                }
                Entry::Sign(Sign::Failed) => draw_failed(pen, middle),
                Entry::Sign(sign @ (Sign::Promised | Sign::Compared)) => {
                    let (tip, right) = ((x + 4.0, y + 6.0), x + SYMBOL - 4.0);
                    pen.line(tip, (right, y + 6.0), 0.8, GREY);
                    pen.line((right, y + 6.0), (right, y - 6.0), 0.8, GREY);
                    draw_slope(pen, tip, (right, y - 6.0), *sign == Sign::Promised);
                }
                Entry::Sign(Sign::Band) => {
                    let corners = [
                        (*x, y + 6.0),
                        (x + SYMBOL, y + 6.0),
                        (x + SYMBOL, y - 6.0),
                        (*x, y - 6.0),
                    ];
                    pen.fill_faintly(&corners, INK);
                }
                Entry::Sign(Sign::Limit) => draw_limit(pen, (*x, *y), (x + SYMBOL, *y)),
            }
            pen.text(entry.label(), (x + SYMBOL + 6.0, *y), TEXT, INK, Align::Left);
        }
    }
}
