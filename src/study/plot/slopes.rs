//! Reference slopes: a small triangle where no data are.

use super::axis::LogAxis;
use super::pen::{Align, Drawn, Pen, Place};
use super::style::GREY;
use plotters::prelude::DrawingBackend;

/// Room to keep from data and frame.
const CLEAR: f64 = 8.0;
/// Room for a label.
const LABEL: f64 = 14.0;

/// Lines of given slopes from a common point, the corner of a triangle.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slopes {
    /// Lower left corner, relative to the panel's.
    corner: Place,
    width: f64,
    /// Each slope and the height of its line.
    rises: Vec<(u32, f64)>,
}

impl Slopes {
    /// The triangle in the lower right or the upper left corner of an area of this size, the first
    /// that is free of data (given in pixels of the area).
    pub fn place(
        slopes: &[u32],
        (x, y): (&LogAxis, &LogAxis),
        size: (f64, f64),
        data: &[Place],
    ) -> Option<Self> {
        let steepest = f64::from(*slopes.iter().max()?);
        // Height over width of a line of slope 1.
        let unit = (size.1 / (y.high - y.low)) / (size.0 / (x.high - x.low));
        // Wide enough for labels on top of each other to be read apart, not higher than a third.
        let apart = (slopes.len() as f64) * LABEL;
        let width = (0.22 * size.0).max(apart / (steepest * unit)).min(0.4 * size.0);
        let width = width.min(size.1 / 3.0 / (steepest * unit));
        let rises: Vec<_> = slopes.iter().map(|&s| (s, f64::from(s) * unit * width)).collect();
        let height = steepest * unit * width;

        let right = size.0 - CLEAR - LABEL - width;
        [(right, size.1 - CLEAR), (CLEAR, CLEAR + LABEL / 2.0 + height)]
            .into_iter()
            .find(|&(left, bottom)| {
                let inside = |&(px, py): &Place| {
                    (left - CLEAR..left + width + LABEL + CLEAR).contains(&px)
                        && (bottom - height - LABEL..bottom + CLEAR).contains(&py)
                };
                !data.iter().any(inside)
            })
            .map(|corner| Slopes { corner, width, rises })
    }

    /// Draws it, the area's upper left corner at `origin`.
    pub fn draw<DB: DrawingBackend>(&self, pen: &Pen<DB>, origin: Place) -> Drawn {
        let (left, bottom) = (origin.0 + self.corner.0, origin.1 + self.corner.1);
        let right = left + self.width;
        let top = self.rises.iter().map(|r| r.1).fold(0.0, f64::max);
        pen.line((left, bottom), (right, bottom), 0.8, GREY)?;
        pen.line((right, bottom), (right, bottom - top), 0.8, GREY)?;
        let step = top / self.rises.len() as f64;
        for (slope, rise) in &self.rises {
            let end = (right, bottom - rise);
            pen.line((left, bottom), end, 0.8, GREY)?;
            // On flat triangles labels would run into each other: the steepest speaks for all.
            if step >= 10.0 || *rise == top {
                pen.text(&slope.to_string(), (right + 4.0, end.1), 13.0, GREY, Align::Left)?;
            }
        }
        Ok(())
    }
}
