//! Drawings as SVG and PNG files.

use super::figure::Figure;
use super::layout::Layer;
use super::panel::draw_panel;
use super::pen::{Drawn, FAMILY, Pen};
use super::style::PAPER;
use super::svg::merge_shapes;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::Once;

/// Embeds a typeface, since a machine that computes often has none: Ubuntu Light, under the Ubuntu
/// Font Licence 1.0, which allows it to be embedded and passed on unchanged.
fn embed_font() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // without the font every drawing of text returns an error
        let _ = register_font(FAMILY, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    });
}

/// What can be drawn on any backend.
pub(crate) trait Drawing {
    /// Width and height.
    fn size(&self) -> (f64, f64);
    /// Draws on empty paper.
    fn draw<DB: DrawingBackend>(&self, pen: &Pen<DB>) -> Drawn;

    /// Whether areas of a colour meet, as the parts of a map do and the marks of a curve do not.
    fn areas_meet(&self) -> bool {
        false
    }

    /// Width and height in pixels.
    fn pixels(&self, scale: u32) -> (u32, u32) {
        let (width, height) = self.size();
        (scale * width.ceil() as u32, scale * height.ceil() as u32)
    }

    /// Pixels to the unit, and how many times finer to draw: the backend leaves jagged edges, which
    /// averaging smooths. Both are lowered for figures of very many panels, to save memory.
    fn resolution(&self) -> (u32, u32) {
        let fits = |&(scale, smooth): &(u32, u32)| {
            let (w, h) = self.pixels(scale * smooth);
            u64::from(w) * u64::from(h) <= 60_000_000
        };
        [(2, 3), (2, 2), (1, 3), (1, 2)].into_iter().find(fits).unwrap_or((1, 1))
    }
}

/// A layer of a figure.
struct Part<'a>(&'a Figure, Layer);

impl Drawing for Part<'_> {
    fn size(&self) -> (f64, f64) {
        self.0.layout().size
    }

    fn draw<DB: DrawingBackend>(&self, pen: &Pen<DB>) -> Drawn {
        let layout = self.0.layout();
        for (panel, &at) in self.0.panels.iter().zip(&layout.panels) {
            draw_panel(pen, panel, at, self.1)?;
        }
        layout.draw_legend(pen, self.1)
    }
}

impl Figure {
    /// The figure as the text of an SVG file.
    ///
    /// # Errors
    /// The backend's reason, as text.
    pub fn to_svg(&self) -> Result<String, String> {
        draw_svg(&Part(self, Layer::All))
    }

    /// The entries of the legend.
    pub(crate) fn labels(&self) -> impl Iterator<Item = &String> {
        self.keys.iter().map(|key| &key.label)
    }

    /// The figure as the text of an SVG file in which the curve of an entry of the legend is a group of the
    /// class `s` and the place of the entry in a list, so that a page can hide it.
    ///
    /// # Errors
    /// The backend's reason, as text.
    pub(crate) fn to_svg_in_groups(&self, series: &[String]) -> Result<String, String> {
        let mut text = draw_svg(&Part(self, Layer::Frame))?.replacen("</svg>", "", 1);
        for (key, label) in self.labels().enumerate() {
            let class = series.iter().position(|name| name == label).unwrap_or(series.len());
            let curve = draw_svg(&Part(self, Layer::Curve(key)))?;
            // the first element is the file itself, the second one the paper
            let drawn = curve.split_inclusive("/>").skip(1).collect::<String>();
            let drawn = drawn.replacen("</svg>", "", 1);
            text += &format!("<g class=\"s{class}\">{}</g>\n", drawn.trim());
        }
        Ok(text + "</svg>\n")
    }

    /// Writes the figure as a PNG file, two pixels to the unit where its size allows.
    ///
    /// # Errors
    /// The backend's reason, as text.
    pub fn write_png(&self, path: &Path) -> Result<(), String> {
        draw_png(&Part(self, Layer::All), path)
    }
}

/// Draws on paper.
fn draw<DB: DrawingBackend>(drawing: &impl Drawing, pen: &Pen<DB>) -> Drawn {
    pen.area.fill(&PAPER).map_err(|e| e.to_string())?;
    drawing.draw(pen)?;
    pen.area.present().map_err(|e| e.to_string())
}

/// A drawing as the text of an SVG file.
pub(crate) fn draw_svg(drawing: &impl Drawing) -> Result<String, String> {
    // The backend rounds to whole pixels. The drawing is made larger and shown smaller, so that the
    // error of rounding is small.
    const FINE: u32 = 8;
    embed_font();
    let (size, shown) = (drawing.pixels(FINE), drawing.pixels(1));
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        draw(drawing, &Pen { area: &area, scale: f64::from(FINE), lift: 0.0 })?;
    }
    let drawn = format!("<svg width=\"{}\" height=\"{}\"", size.0, size.1);
    let wanted = format!("<svg width=\"{}\" height=\"{}\"", shown.0, shown.1);
    Ok(merge_shapes(&text.replacen(&drawn, &wanted, 1), drawing.areas_meet()))
}

/// Writes a drawing as a PNG file.
pub(crate) fn draw_png(drawing: &impl Drawing, path: &Path) -> Result<(), String> {
    embed_font();
    let (scale, smooth) = drawing.resolution();
    let drawn = drawing.pixels(scale * smooth);
    let mut fine = vec![0; 3 * drawn.0 as usize * drawn.1 as usize];
    {
        let area = BitMapBackend::with_buffer(&mut fine, drawn).into_drawing_area();
        draw(drawing, &Pen { area: &area, scale: f64::from(scale * smooth), lift: 0.14 })?;
    }
    let (size, pixels) = (drawing.pixels(scale), average(&fine, drawn, smooth));
    write_pixels(path, size, &pixels).map_err(|e| e.to_string())
}

/// Writes rows of red, green and blue as a PNG file.
fn write_pixels(
    path: &Path,
    (width, height): (u32, u32),
    pixels: &[u8],
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()
}

/// Each pixel the mean of a square of finer ones.
fn average(fine: &[u8], (width, height): (u32, u32), side: u32) -> Vec<u8> {
    let (width, side) = (width as usize, side as usize);
    let (columns, rows) = (width / side, height as usize / side);
    let mut pixels = Vec::with_capacity(3 * columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            for channel in 0..3 {
                let mut sum = 0;
                for y in row * side..(row + 1) * side {
                    for x in column * side..(column + 1) * side {
                        sum += usize::from(fine[3 * (y * width + x) + channel]);
                    }
                }
                pixels.push((sum / (side * side)) as u8);
            }
        }
    }
    pixels
}
