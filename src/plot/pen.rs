//! Lines, areas and text as the text of an SVG file.

/// A position on the drawing: distances from its upper left corner to the right and down.
pub(crate) type ScreenPoint = (f64, f64);

/// Red, green and blue, each up to 255.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Colour(pub u8, pub u8, pub u8);

/// Paper.
pub(crate) const PAPER: Colour = Colour(255, 255, 255);

/// The typefaces, of which a viewer takes the first that it has.
const FAMILY: &str = "Arial, Liberation Sans, Helvetica, DejaVu Sans, sans-serif";

/// The opacity of faint areas.
const FAINT: f64 = 0.12;

/// Coordinates in the file are whole numbers of this part of a unit.
const PARTS: f64 = 8.0;

/// About the width of a text: typefaces and letters differ.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    0.58 * size * text.chars().count() as f64
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

/// A path to which shapes of the same style are added.
struct OpenPath {
    style: String,
    /// Where the last shape ends.
    end: Option<(i64, i64)>,
}

/// Writes the shapes of a drawing, in their order. Shapes of one style that follow each other become one path.
pub(crate) struct Pen {
    text: String,
    /// Whether filled areas of a colour become one path too, as the parts of a map do: a viewer that smooths the edges of
    /// each area alone leaves hair lines between neighbouring areas. Marks stay separate paths, since marks may overlap.
    areas_meet: bool,
    open: Option<OpenPath>,
}

impl Pen {
    /// Empty paper of this width and height.
    pub fn new((width, height): (f64, f64), areas_meet: bool) -> Self {
        let (width, height) = (width.ceil(), height.ceil());
        let colour = colour_text(PAPER);
        let text = format!(
            "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {} {}\" \
             xmlns=\"http://www.w3.org/2000/svg\" font-family=\"{FAMILY}\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"{colour}\"/>\n",
            PARTS * width,
            PARTS * height
        );
        Self { text, areas_meet, open: None }
    }

    /// The file.
    pub fn finish(mut self) -> String {
        self.close_path();
        self.text + "</svg>\n"
    }

    /// A straight line.
    pub fn line(&mut self, from: ScreenPoint, to: ScreenPoint, width: f64, colour: Colour) {
        self.dashes(from, to, width, colour, &[]);
    }

    /// A straight line of dashes and gaps of these lengths in turn; a full one without any.
    pub fn dashes(
        &mut self,
        from: ScreenPoint,
        to: ScreenPoint,
        width: f64,
        colour: Colour,
        lengths: &[f64],
    ) {
        if pixel(from) != pixel(to) {
            self.shape(stroke(width, colour, lengths), &[from, to], false);
        }
    }

    /// A closed outline.
    pub fn outline(&mut self, corners: &[ScreenPoint], width: f64, colour: Colour) {
        self.shape(stroke(width, colour, &[]), corners, true);
    }

    /// A filled area.
    pub fn fill(&mut self, corners: &[ScreenPoint], colour: Colour) {
        let colour = colour_text(colour);
        if self.areas_meet {
            let style = format!("shape-rendering=\"crispEdges\" fill=\"{colour}\"");
            return self.shape(style, corners, true);
        }
        self.close_path();
        self.shape(format!("fill=\"{colour}\""), corners, true);
        self.close_path();
    }

    /// A filled area through which the drawing below is seen.
    pub fn fill_faintly(&mut self, corners: &[ScreenPoint], colour: Colour) {
        self.close_path();
        let style = format!("fill=\"{}\" opacity=\"{FAINT}\"", colour_text(colour));
        self.shape(style, corners, true);
        self.close_path();
    }

    /// Text, its middle at the height of its position.
    pub fn text(&mut self, text: &str, at: ScreenPoint, size: f64, colour: Colour, align: Align) {
        self.close_path();
        let (x, y) = pixel(at);
        let anchor = match align {
            Align::Left => "start",
            Align::Centre | Align::Upwards => "middle",
            Align::Right => "end",
        };
        let turn = match align {
            Align::Upwards => format!(" transform=\"rotate(-90 {x} {y})\""),
            _ => String::new(),
        };
        let (size, colour) = (PARTS * size, colour_text(colour));
        self.text += &format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"{:.0}\" font-size=\"{size:.0}\" text-anchor=\"{anchor}\" \
             fill=\"{colour}\"{turn}>{}</text>\n",
            0.35 * size,
            escaped(text)
        );
    }

    /// Adds a shape to the open path if that has its style, else to a new one. Steps are relative, the first one to
    /// where the path ends.
    fn shape(&mut self, style: String, corners: &[ScreenPoint], is_closed: bool) {
        if self.open.as_ref().is_none_or(|path| path.style != style) {
            self.close_path();
            self.text += &format!("<path {style} d=\"");
            self.open = Some(OpenPath { style, end: None });
        }
        let Some(path) = &mut self.open else { return };
        let mut first = None;
        for (x, y) in corners.iter().map(|&corner| pixel(corner)) {
            let step = path.end.map(|(a, b)| (x - a, y - b));
            match (first, step) {
                (None, Some((0, 0))) => {}
                (None, Some((dx, dy))) => push_pair('m', dx, dy, &mut self.text),
                (_, None) => push_pair('M', x, y, &mut self.text),
                (Some(_), Some((dx, 0))) => self.text += &format!("h{dx}"),
                (Some(_), Some((0, dy))) => self.text += &format!("v{dy}"),
                (Some(_), Some((dx, dy))) => push_pair('l', dx, dy, &mut self.text),
            }
            first = first.or(Some((x, y)));
            path.end = Some((x, y));
        }
        if is_closed {
            self.text.push('z');
            path.end = first;
        }
    }

    fn close_path(&mut self) {
        if self.open.take().is_some() {
            self.text += "\"/>\n";
        }
    }
}

/// A position in whole parts of a unit.
fn pixel((x, y): ScreenPoint) -> (i64, i64) {
    ((x * PARTS).round() as i64, (y * PARTS).round() as i64)
}

fn colour_text(Colour(red, green, blue): Colour) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// The style of a line.
fn stroke(width: f64, colour: Colour, dashes: &[f64]) -> String {
    let width = (width * PARTS).round().max(1.0);
    let mut style =
        format!("fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"", colour_text(colour));
    if !dashes.is_empty() {
        let lengths: Vec<String> = dashes.iter().map(|s| format!("{:.0}", s * PARTS)).collect();
        style += &format!(" stroke-dasharray=\"{}\"", lengths.join(" "));
    }
    style
}

/// A command of a path; a sign separates numbers as well as a space does.
fn push_pair(command: char, x: i64, y: i64, text: &mut String) {
    let space = if y < 0 { "" } else { " " };
    *text += &format!("{command}{x}{space}{y}");
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
