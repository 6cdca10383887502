//! Reference slopes: a small triangle in the lower corner on the side of the large errors, where curves are far above.

use super::axis::LogAxis;
use super::pen::{Align, Pen, ScreenPoint};
use super::series::Orders;
use super::style::{GREY, draw_slope};

/// Room to keep from the frame.
const CLEAR: f64 = 8.0;
/// Room for a label, and for one with a fraction.
const LABEL: f64 = 14.0;
const FRACTION: f64 = 26.0;

/// An order over a dimension, as short as it goes.
fn fraction(order: f64, dimension: u32) -> String {
    let quotient = order / f64::from(dimension);
    let hundredths = (100.0 * quotient).round();
    match 100.0 * quotient == hundredths || order.fract() != 0.0 {
        true => (hundredths / 100.0).to_string(),
        false => format!("{order}/{dimension}"),
    }
}

/// Draws lines of ascending orders from a common point, in an area of this size with its upper left corner at `origin`.
/// Falling slopes, each over a dimension, stand in the lower left corner, others in the lower right one.
pub(crate) fn draw_slopes(
    pen: &mut Pen,
    Orders { orders, falls_over, are_promised }: &Orders,
    (x, y): (&LogAxis, &LogAxis),
    size: (f64, f64),
    origin: ScreenPoint,
) {
    let Some(&steepest) = orders.last() else { return };
    let dimension = falls_over.unwrap_or(1).max(1);
    // height over width of a line of slope 1, or 1 over the dimension
    let unit = (size.1 / (y.high - y.low)) / (size.0 / (x.high - x.low)) / f64::from(dimension);
    let width = (0.22 * size.0).min(size.1 / 3.0 / (steepest * unit));
    let bottom = origin.1 + size.1 - CLEAR;
    let (steep, tip, beside, align) = match falls_over {
        Some(_) => {
            let left = origin.0 + CLEAR + FRACTION;
            (left, left + width, left - 4.0, Align::Right)
        }
        None => {
            let right = origin.0 + size.0 - CLEAR - LABEL;
            (right, right - width, right + 4.0, Align::Left)
        }
    };
    let top = steepest * unit * width;
    pen.line((tip, bottom), (steep, bottom), 0.8, GREY);
    pen.line((steep, bottom), (steep, bottom - top), 0.8, GREY);
    for &order in orders {
        let end = (steep, bottom - order * unit * width);
        draw_slope(pen, (tip, bottom), end, *are_promised);
        // labels on flat triangles would overlap: only the steepest slope has one
        if top / orders.len() as f64 >= 10.0 || order == steepest {
            pen.text(&fraction(order, dimension), (beside, end.1), 13.0, GREY, align);
        }
    }
}
