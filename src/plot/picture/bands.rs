//! Triangles cut along the levels of a function that is linear on each.

use super::axes::Stroke;
use super::colour::Scale;
use super::panel::Panel;
use super::triangle::PlanePoint;
use crate::arrays::array_of;
use crate::plot::pen::PAPER;
use crate::plot::style::INK;

/// Levels from one contour line to the next.
const STRIDE: usize = 2;

/// A point with the value of the function there.
pub(crate) type Valued = (PlanePoint, f64);

/// Fills a panel with the bands of a function and its contour lines.
pub(crate) fn shade(panel: &mut Panel, triangles: &[[Valued; 3]]) {
    let values = triangles.as_flattened().iter().map(|corner| corner.1);
    let Some(scale) = Scale::over(values) else { return };
    let mut fills: Vec<_> = triangles.iter().flat_map(|t| bands(&scale, t)).collect();
    // those of a colour together, which keeps files short
    fills.sort_by_key(|fill| fill.0);
    panel.fills.extend(fills.into_iter().map(|(k, area)| (scale.colour(k), area)));
    let ink = |k: usize| if 2 * k < scale.bands() { PAPER } else { INK };
    for k in (STRIDE..scale.bands()).step_by(STRIDE) {
        let lines = triangles.iter().filter_map(|t| contour(t, scale.levels[k]));
        panel.lines.extend(lines.map(|ends| (Stroke(0.6, ink(k)), ends)));
    }
    panel.scale = Some(scale);
}

/// The areas that paint a triangle: number of the band, corners. Each is the part on which the function is not below
/// the band, the first one the whole triangle, so that neighbours leave no gap where coordinates are rounded.
pub(crate) fn bands(scale: &Scale, triangle: &[Valued; 3]) -> Vec<(usize, Vec<PlanePoint>)> {
    let mut values = triangle.map(|corner| scale.band(corner.1));
    values.sort_unstable();
    let part = |k: usize| {
        let level = if k == values[0] { f64::NEG_INFINITY } else { scale.levels[k] };
        (k, not_below(triangle, level))
    };
    let highest = triangle.map(|corner| corner.1).into_iter().fold(f64::NEG_INFINITY, f64::max);
    let is_painted = |&k: &usize| k == values[0] || scale.levels[k] < highest;
    (values[0]..=values[2]).filter(is_painted).map(part).collect()
}

/// The segment on which the function has a value; none where it only touches.
pub(crate) fn contour(triangle: &[Valued; 3], level: f64) -> Option<[PlanePoint; 2]> {
    let mut ends = Vec::new();
    for k in 0..3 {
        let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
        if (a.1 < level) != (b.1 < level) {
            ends.push(crossing(a, b, level));
        }
    }
    <[PlanePoint; 2]>::try_from(ends).ok()
}

/// The part of a triangle on which the function is not below a level, corner by corner as by I. E. Sutherland and
/// G. W. Hodgman, Comm. ACM 17 (1974), 32-42.
fn not_below(triangle: &[Valued; 3], level: f64) -> Vec<PlanePoint> {
    let mut kept = Vec::new();
    for (k, &b) in triangle.iter().enumerate() {
        let a = triangle[(k + 2) % 3];
        if (a.1 < level) != (b.1 < level) {
            kept.push(crossing(a, b, level));
        }
        if b.1 >= level {
            kept.push(b.0);
        }
    }
    kept
}

fn crossing(a: Valued, b: Valued, level: f64) -> PlanePoint {
    let share = (level - a.1) / (b.1 - a.1);
    array_of(|k| a.0[k] + share * (b.0[k] - a.0[k]))
}
