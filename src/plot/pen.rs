//! Lines, areas and text on any backend, in units that do not depend on its resolution.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Why a drawing failed, as text: backends differ in their errors.
pub(crate) type Drawn = Result<(), String>;

/// A position on the drawing: distances from its upper left corner to the right and down.
pub(crate) type ScreenPoint = (f64, f64);

/// The typeface. PNG files are drawn with the one of this name that [`crate::plot::render`] embeds;
/// an SVG file names it, and viewers that lack it take the next.
pub(crate) const FAMILY: &str = "Ubuntu, DejaVu Sans, Arial, sans-serif";

/// The opacity of faint areas.
const FAINT: f64 = 0.12;

/// A typeface's width of a text.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    // Measured large, since the answer is in whole pixels.
    let measured = (FAMILY, 10.0 * size).into_font().box_size(text);
    measured.map_or(0.6 * size * text.len() as f64, |(w, _)| f64::from(w) / 10.0)
}

/// How a text is aligned at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    /// The text starts at the position.
    Left,
    /// The text is centred.
    Centre,
    /// The text ends at the position.
    Right,
    /// The text is centred and runs upwards.
    Upwards,
}

/// Draws on a backend with `scale` pixels to the unit.
pub(crate) struct Pen<'a, DB: DrawingBackend> {
    pub area: &'a DrawingArea<DB, Shift>,
    pub scale: f64,
    /// Upward error of the backend in centred text, in parts of the size of the text.
    pub lift: f64,
}

impl<DB: DrawingBackend> Pen<'_, DB> {
    fn pixel(&self, (x, y): ScreenPoint) -> (i32, i32) {
        ((x * self.scale).round() as i32, (y * self.scale).round() as i32)
    }

    /// One straight line. Lines of several parts are drawn part by part: backends disagree on the
    /// corners of wide ones.
    pub fn line(&self, from: ScreenPoint, to: ScreenPoint, width: f64, colour: RGBColor) -> Drawn {
        let (from, to) = (self.pixel(from), self.pixel(to));
        if from == to {
            return Ok(());
        }
        let width = (width * self.scale).round().max(1.0) as u32;
        let line = PathElement::new(vec![from, to], colour.stroke_width(width));
        self.area.draw(&line).map_err(|e| e.to_string())
    }

    /// A line of dashes and gaps of these lengths in turn; a full one without any.
    pub fn dashes(
        &self,
        from: ScreenPoint,
        to: ScreenPoint,
        width: f64,
        colour: RGBColor,
        lengths: &[f64],
    ) -> Drawn {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy);
        let at = |s: f64| (from.0 + dx * s / length, from.1 + dy * s / length);
        let mut start = 0.0;
        for (k, &step) in lengths.iter().cycle().enumerate() {
            if start >= length || length.is_nan() {
                return Ok(());
            }
            if k % 2 == 0 {
                self.line(at(start), at((start + step).min(length)), width, colour)?;
            }
            start += step;
        }
        self.line(from, to, width, colour)
    }

    /// A closed outline.
    pub fn outline(&self, corners: &[ScreenPoint], width: f64, colour: RGBColor) -> Drawn {
        for (i, &from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            // Longer by half a width at both ends, so that corners close.
            let (dx, dy) = (to.0 - from.0, to.1 - from.1);
            let s = 0.4 * width / dx.hypot(dy).max(1e-9);
            self.line(
                (from.0 - s * dx, from.1 - s * dy),
                (to.0 + s * dx, to.1 + s * dy),
                width,
                colour,
            )?;
        }
        Ok(())
    }

    /// A filled area.
    pub fn fill(&self, corners: &[ScreenPoint], colour: RGBColor) -> Drawn {
        self.polygon(corners, colour)
    }

    /// A filled area through which the drawing below is seen.
    pub fn fill_faintly(&self, corners: &[ScreenPoint], colour: RGBColor) -> Drawn {
        self.polygon(corners, colour.mix(FAINT))
    }

    fn polygon(&self, corners: &[ScreenPoint], style: impl Into<ShapeStyle>) -> Drawn {
        let corners: Vec<_> = corners.iter().map(|&c| self.pixel(c)).collect();
        self.area.draw(&Polygon::new(corners, style)).map_err(|e| e.to_string())
    }

    /// Text, its middle at the height of its position.
    pub fn text(
        &self,
        text: &str,
        at: ScreenPoint,
        size: f64,
        colour: RGBColor,
        align: Align,
    ) -> Drawn {
        let horizontal = match align {
            Align::Left => HPos::Left,
            Align::Centre | Align::Upwards => HPos::Center,
            Align::Right => HPos::Right,
        };
        let mut font = (FAMILY, size * self.scale).into_font();
        let mut at = at;
        if align == Align::Upwards {
            font = font.transform(FontTransform::Rotate270);
            at.0 += self.lift * size;
        } else {
            at.1 += self.lift * size;
        }
        let style = font.color(&colour).pos(Pos::new(horizontal, VPos::Center));
        self.area.draw_text(text, &style, self.pixel(at)).map_err(|e| e.to_string())
    }
}
