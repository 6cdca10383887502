//! The line on which a function changes sign.

use super::bands::contour;
use super::triangle::{Corner, PlanePoint, Triangle, quarters};

/// The longest piece into which the edge of a triangle is cut, over the size of the picture.
const FINEST: f64 = 1.0 / 120.0;
/// Most often that a triangle is cut.
const MOST: u32 = 6;

/// Segments of the line on which a function changes its sign within triangles, in a picture of this size; between the
/// points of fine cuts the function is drawn as linear. `value` returns the function at a point of a cell.
pub(crate) fn level_line<'t>(
    triangles: impl IntoIterator<Item = &'t Triangle>,
    size: f64,
    value: &dyn Fn(usize, &[f64; 4]) -> f64,
) -> Vec<[PlanePoint; 2]> {
    let mut segments = Vec::new();
    for triangle in triangles {
        let [a, b, c] = triangle.corners;
        let longest = [(a, b), (b, c), (c, a)].map(|(a, b)| distance(a.at, b.at));
        let longest = longest.into_iter().fold(0.0, f64::max);
        let cuts = (longest / (FINEST * size)).log2().ceil().clamp(0.0, f64::from(MOST)) as u32;
        let at = |corner: Corner| (corner.at, value(triangle.cell, &corner.barycentric));
        let mut pieces = vec![triangle.corners];
        for _ in 0..cuts {
            pieces = pieces.into_iter().flat_map(quarters).collect();
        }
        segments.extend(pieces.iter().filter_map(|piece| contour(&piece.map(at), 0.0)));
    }
    segments
}

pub(crate) fn distance(a: PlanePoint, b: PlanePoint) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
