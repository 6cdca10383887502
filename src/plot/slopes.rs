//! Reference slopes: a small triangle where no data are.

use super::axis::LogAxis;
use super::pen::{Align, Pen, ScreenPoint};
use super::series::Orders;
use super::style::{GREY, draw_slope};

/// Room to keep from data and frame.
const CLEAR: f64 = 8.0;
/// Room for a label, and for one with a fraction.
const LABEL: f64 = 14.0;
const FRACTION: f64 = 26.0;

/// Lines of given slopes from a common point, the corner of a triangle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slopes {
    /// Lower left corner, relative to the panel's.
    corner: ScreenPoint,
    width: f64,
    /// The label of each slope and the height of its line.
    rises: Vec<(String, f64)>,
    /// Whether lines fall to the common point instead of rising from it.
    falls: bool,
    are_promised: bool,
}

/// An order over a dimension, as short as it goes.
fn fraction(order: f64, dimension: u32) -> String {
    let quotient = order / f64::from(dimension);
    let hundredths = (100.0 * quotient).round();
    match 100.0 * quotient == hundredths || order.fract() != 0.0 {
        true => (hundredths / 100.0).to_string(),
        false => format!("{order}/{dimension}"),
    }
}

impl Slopes {
    /// The triangle of ascending orders in the lower right or the upper left corner of an area of this size, the first
    /// that is free of data (given in pixels of the area). Falling slopes, each over a dimension,
    /// are placed in the lower left or the upper right corner.
    pub fn place(
        Orders { orders, falls_over, are_promised }: &Orders,
        (x, y): (&LogAxis, &LogAxis),
        size: (f64, f64),
        data: &[ScreenPoint],
    ) -> Option<Self> {
        let steepest = *orders.last()?;
        let dimension = falls_over.unwrap_or(1).max(1);
        // Height over width of a line of slope 1, or 1 over the dimension.
        let unit = (size.1 / (y.high - y.low)) / (size.0 / (x.high - x.low)) / f64::from(dimension);
        // Wide enough for labels on top of each other to be read apart, not higher than a third.
        let apart = (orders.len() as f64) * LABEL;
        let width = (0.22 * size.0).max(apart / (steepest * unit)).min(0.4 * size.0);
        let width = width.min(size.1 / 3.0 / (steepest * unit));
        let rises: Vec<_> =
            orders.iter().map(|&p| (fraction(p, dimension), p * unit * width)).collect();
        let height = steepest * unit * width;

        let falls = falls_over.is_some();
        let (before, after) = if falls { (FRACTION, 0.0) } else { (0.0, LABEL) };
        let right = size.0 - CLEAR - after - width;
        let left = CLEAR + before;
        let (low, high) = (size.1 - CLEAR, CLEAR + LABEL / 2.0 + height);
        let places =
            if falls { [(left, low), (right, high)] } else { [(right, low), (left, high)] };
        places
            .into_iter()
            .find(|&(left, bottom)| {
                let inside = |&(px, py): &ScreenPoint| {
                    (left - before - CLEAR..left + width + after + CLEAR).contains(&px)
                        && (bottom - height - LABEL..bottom + CLEAR).contains(&py)
                };
                !data.iter().any(inside)
            })
            .map(|corner| Slopes { corner, width, rises, falls, are_promised: *are_promised })
    }

    /// Draws the slopes, with the upper left corner of the area at `origin`.
    pub fn draw(&self, pen: &mut Pen, origin: ScreenPoint) {
        let (left, bottom) = (origin.0 + self.corner.0, origin.1 + self.corner.1);
        let right = left + self.width;
        let top = self.rises.iter().map(|r| r.1).fold(0.0, f64::max);
        pen.line((left, bottom), (right, bottom), 0.8, GREY);
        let (steep, tip) = if self.falls { (left, right) } else { (right, left) };
        let (beside, align) =
            if self.falls { (steep - 4.0, Align::Right) } else { (steep + 4.0, Align::Left) };
        pen.line((steep, bottom), (steep, bottom - top), 0.8, GREY);
        let step = top / self.rises.len() as f64;
        for (label, rise) in &self.rises {
            let end = (steep, bottom - rise);
            draw_slope(pen, (tip, bottom), end, self.are_promised);
            // labels on flat triangles would overlap: only the steepest slope has one
            if step >= 10.0 || *rise == top {
                pen.text(label, (beside, end.1), 13.0, GREY, align);
            }
        }
    }
}
