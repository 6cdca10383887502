//! Colours, dashes and marks of curves. Curves differ in all of them, so that they remain distinct in
//! grey; some marks are open, so that curves on top of each other are both visible.

use super::pen::{Colour, PAPER, Pen, ScreenPoint};

/// Text and frames.
pub(crate) const INK: Colour = Colour(30, 30, 30);
/// Reference slopes.
pub(crate) const GREY: Colour = Colour(120, 120, 120);
/// Lines behind the data.
pub(crate) const GRID: Colour = Colour(226, 226, 226);
/// Runs that did not converge.
pub(crate) const FAILED: Colour = Colour(214, 0, 0);

/// Colours that remain distinct to colour-blind readers (Okabe and Ito), without yellow, which is
/// faint on white.
const COLOURS: [Colour; 7] = [
    Colour(0, 114, 178),
    Colour(213, 94, 0),
    Colour(0, 158, 115),
    Colour(204, 121, 167),
    Colour(0, 0, 0),
    Colour(86, 180, 233),
    Colour(230, 159, 0),
];

/// A mark: corners on a circle around its centre.
struct Mark {
    corners: usize,
    /// Angle of the first corner in parts of a full turn; 0 is to the right, then clockwise.
    turn: f64,
    radius: f64,
    filled: bool,
}

const fn mark(corners: usize, turn: f64, radius: f64, filled: bool) -> Mark {
    Mark { corners, turn, radius, filled }
}

/// Small filled ones fit into large open ones.
const MARKS: [Mark; 10] = [
    mark(24, 0.0, 2.8, true),
    mark(4, 0.125, 5.6, false),
    mark(3, 0.75, 4.0, true),
    mark(4, 0.0, 5.6, false),
    mark(3, 0.25, 5.8, false),
    mark(4, 0.125, 3.2, true),
    mark(24, 0.0, 4.8, false),
    mark(3, 0.25, 4.0, true),
    mark(3, 0.75, 5.8, false),
    mark(4, 0.0, 3.6, true),
];

/// The colour of a curve.
pub(crate) fn colour(key: usize) -> Colour {
    COLOURS[key % COLOURS.len()]
}

/// Lengths of dashes and gaps in turn; none for a full line. Their number and that of the colours have no
/// common divisor.
const DASHES: [&[f64]; 4] = [&[], &[7.0, 3.0], &[1.8, 2.4], &[9.0, 2.6, 1.8, 2.6]];

/// The part of a curve between two marks.
pub(crate) fn segment(pen: &mut Pen, key: usize, from: ScreenPoint, to: ScreenPoint) {
    pen.dashes(from, to, 1.4, colour(key), DASHES[key % DASHES.len()]);
}

/// The mark of a curve, `size` times its usual size.
pub(crate) fn draw_mark(pen: &mut Pen, key: usize, at: ScreenPoint, size: f64) {
    let mark = &MARKS[key % MARKS.len()];
    let radius = size * mark.radius;
    let corners: Vec<ScreenPoint> = (0..mark.corners)
        .map(|i| {
            let angle = std::f64::consts::TAU * (mark.turn + i as f64 / mark.corners as f64);
            (at.0 + radius * angle.cos(), at.1 + radius * angle.sin())
        })
        .collect();
    if mark.filled {
        pen.fill(&corners, colour(key))
    } else {
        pen.outline(&corners, 1.3, colour(key))
    }
}

/// The slope of an order: a full line if theory promises it.
pub(crate) fn draw_slope(pen: &mut Pen, from: ScreenPoint, to: ScreenPoint, is_promised: bool) {
    pen.dashes(from, to, 0.8, GREY, if is_promised { &[] } else { &[1.5, 2.5] })
}

/// The line of a limit.
pub(crate) fn draw_limit(pen: &mut Pen, from: ScreenPoint, to: ScreenPoint) {
    pen.dashes(from, to, 1.0, GREY, &[2.0, 2.0]);
}

/// The mark of a run that did not converge: a hollow cross.
pub(crate) fn draw_failed(pen: &mut Pen, at: ScreenPoint) {
    // length and half width of the arms
    const R: f64 = 9.0;
    const W: f64 = 2.2;
    // The arm to the right of an upright cross, to be turned by an eighth and then by quarters.
    let arm = [(W, W), (R, W), (R, -W)];
    let corners: Vec<ScreenPoint> = (0..4)
        .flat_map(|quarter| {
            let (sin, cos) = (std::f64::consts::FRAC_PI_4 * f64::from(1 - 2 * quarter)).sin_cos();
            arm.map(|(x, y)| (at.0 + x * cos - y * sin, at.1 + x * sin + y * cos))
        })
        .collect();
    pen.fill(&corners, PAPER);
    pen.outline(&corners, 1.2, FAILED);
}
