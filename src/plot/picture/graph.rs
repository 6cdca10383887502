//! A panel that shows functions of one coordinate.

use super::axes::{
    BOTTOM, CONTACT, Frame, LEFT, LINE, RIGHT, Stroke, Symbol, TITLE, TOP, draw_legend, draw_mark,
};
use super::triangle::PlanePoint;
use crate::plot::pen::{Align, Pen, ScreenPoint};
use crate::plot::style::INK;

/// Height of the data on paper over their width.
const RATIO: f64 = 0.5;
/// Height on paper of the bar that marks contact, and the width of a single point in it.
const BAR: f64 = 9.0;
const POINT: f64 = 8.0;

/// A panel of functions of one coordinate.
#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    pub title: String,
    pub axes: [String; 2],
    /// Segments of functions, drawn in this order.
    pub lines: Vec<(Stroke, [PlanePoint; 2])>,
    /// Intervals found to be in contact, at the lower edge; of no length where it is a point.
    pub contact: Vec<[f64; 2]>,
    /// Points of the exact free boundary, at the lower edge.
    pub marks: Vec<f64>,
    pub legend: Vec<(Symbol, String)>,
}

impl Graph {
    /// A graph to which lines are added later. Its legend shows the discrete solution under `name`.
    pub fn of_found(title: &str, axes: [&str; 2], name: &str) -> Self {
        Graph {
            title: title.to_owned(),
            axes: axes.map(str::to_owned),
            legend: vec![(Symbol::Line(Stroke::Solution), name.to_owned())],
            ..Graph::default()
        }
    }

    /// Curves with their names through points, in the order in which they are drawn.
    pub fn of_curves(axes: [&str; 2], curves: &[(&str, Vec<PlanePoint>)]) -> Self {
        let mut graph = Graph { axes: axes.map(str::to_owned), ..Graph::default() };
        for (key, (name, points)) in curves.iter().enumerate() {
            let stroke = Stroke::Curve(key);
            let ends = points.windows(2).map(|ends| (stroke, [ends[0], ends[1]]));
            graph.lines.extend(ends);
            graph.legend.push((Symbol::Line(stroke), (*name).to_owned()));
        }
        graph
    }

    /// Shows these intervals to be in contact, and these points of the exact free boundary.
    pub fn mark(&mut self, contact: Vec<[f64; 2]>, free_boundary: Vec<f64>) {
        (self.contact, self.marks) = (contact, free_boundary);
        if !self.contact.is_empty() {
            self.legend.push((Symbol::Area(CONTACT), "in contact".to_owned()));
        }
        if !self.marks.is_empty() {
            self.legend.push((Symbol::Mark, "free boundary, exact".to_owned()));
        }
    }

    /// Height of the panel.
    pub fn height(&self, width: f64) -> f64 {
        let legend = self.legend.len() as f64 * LINE + 8.0;
        TOP + RATIO * (width - LEFT - RIGHT) + BOTTOM + legend
    }

    /// The ends of the axes: those of the data, with room above and below.
    fn ends(&self) -> (PlanePoint, PlanePoint) {
        let points = || self.lines.iter().flat_map(|l| l.1);
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for point in points().filter(|p| p[1].is_finite()) {
            for k in 0..2 {
                low[k] = low[k].min(point[k]);
                high[k] = high[k].max(point[k]);
            }
        }
        for k in 0..2 {
            if low[k] > high[k] {
                (low[k], high[k]) = (0.0, 1.0);
            }
        }
        let height = high[1] - low[1];
        let room = if height > 0.0 { 0.08 * height } else { 0.5 * high[1].abs().max(1e-300) };
        ([low[0], low[1] - 1.5 * room], [high[0], high[1] + room])
    }

    pub fn draw(&self, pen: &mut Pen, at: ScreenPoint, width: f64) {
        let room = width - LEFT - RIGHT;
        let size = (room, RATIO * room);
        let (low, high) = self.ends();
        let frame = Frame { origin: (at.0 + LEFT, at.1 + TOP), size, low, high };
        let middle = at.0 + LEFT + 0.5 * room;
        pen.text(&self.title, (middle, at.1 + TOP / 2.0), TITLE, INK, Align::Centre);
        let bottom = frame.origin.1 + size.1;
        let across = |x: f64| frame.place([x, low[1]]).0;
        for &[from, to] in &self.contact {
            let (mut a, mut b) = (across(from), across(to));
            if b - a < POINT {
                (a, b) = (a - 0.5 * (POINT - (b - a)), b + 0.5 * (POINT - (b - a)));
            }
            pen.fill(&[(a, bottom), (b, bottom), (b, bottom - BAR), (a, bottom - BAR)], CONTACT);
        }
        for (stroke, ends) in self.lines.iter().filter(|l| l.1.iter().all(|p| p[1].is_finite())) {
            stroke.draw(pen, frame.place(ends[0]), frame.place(ends[1]));
        }
        for &x in &self.marks {
            draw_mark(pen, (across(x), bottom));
        }
        frame.draw(pen, [&self.axes[0], &self.axes[1]]);
        draw_legend(pen, &self.legend, (at.0 + LEFT, at.1 + TOP + size.1 + BOTTOM + 4.0))
    }
}
