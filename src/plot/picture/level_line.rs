//! The line on which a function changes sign.

use super::triangle::{Corner, PlanePoint, Triangle, between, quarters};

/// The longest piece into which the edge of a triangle is cut, over the size of the picture.
const FINEST: f64 = 1.0 / 120.0;
/// Most often that a triangle is cut.
const MOST: u32 = 6;
/// Bisections of an edge on which the sign changes: the function may as well be a step.
const BISECTIONS: usize = 24;

/// Segments of the line on which the sign of a function changes within triangles, in a picture of
/// this size. `inside` returns the sign at a point of a cell.
pub(crate) fn level_line<'t>(
    triangles: impl IntoIterator<Item = &'t Triangle>,
    size: f64,
    inside: &dyn Fn(usize, &[f64; 4]) -> bool,
) -> Vec<[PlanePoint; 2]> {
    let mut segments = Vec::new();
    for triangle in triangles {
        let [a, b, c] = triangle.corners;
        let longest = [(a, b), (b, c), (c, a)].map(|(a, b)| distance(a.at, b.at));
        let longest = longest.into_iter().fold(0.0, f64::max);
        let cuts = (longest / (FINEST * size)).log2().ceil().clamp(0.0, f64::from(MOST)) as u32;
        follow(triangle.cell, [a, b, c], cuts, inside, &mut segments);
    }
    segments
}

fn follow(
    cell: usize,
    corners: [Corner; 3],
    cuts: u32,
    inside: &dyn Fn(usize, &[f64; 4]) -> bool,
    segments: &mut Vec<[PlanePoint; 2]>,
) {
    if cuts > 0 {
        for piece in quarters(corners) {
            follow(cell, piece, cuts - 1, inside, segments);
        }
        return;
    }
    let signs = corners.map(|corner| inside(cell, &corner.barycentric));
    let mut ends = Vec::new();
    for k in 0..3 {
        let next = (k + 1) % 3;
        if signs[k] != signs[next] {
            ends.push(change(cell, corners[k], corners[next], signs[k], inside));
        }
    }
    if let [from, to] = ends[..] {
        segments.push([from, to]);
    }
}

/// Where the sign changes between two points.
fn change(
    cell: usize,
    from: Corner,
    to: Corner,
    sign: bool,
    inside: &dyn Fn(usize, &[f64; 4]) -> bool,
) -> PlanePoint {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if inside(cell, &between(from, to, middle).barycentric) == sign {
            low = middle;
        } else {
            high = middle;
        }
    }
    between(from, to, 0.5 * (low + high)).at
}

pub(crate) fn distance(a: PlanePoint, b: PlanePoint) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
