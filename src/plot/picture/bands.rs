//! A triangle cut along the levels of a linear function on it.

use super::section::PlanePoint;
use crate::arrays::array_of;

/// A point with the value of the function there.
type Valued = (PlanePoint, f64);

/// The part of a triangle on which the function lies between two levels; empty if there is none.
pub(crate) fn band(triangle: &[Valued; 3], low: f64, high: f64) -> Vec<PlanePoint> {
    let above = keep(triangle, |v| v - low);
    let within = keep(&above, |v| high - v);
    within.into_iter().map(|(at, _)| at).collect()
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

/// The part of a polygon on which a measure of the values is not negative, corner by corner as by
/// I. E. Sutherland and G. W. Hodgman, Comm. ACM 17 (1974), 32-42.
fn keep(polygon: &[Valued], measure: impl Fn(f64) -> f64) -> Vec<Valued> {
    let mut kept = Vec::new();
    for (k, &b) in polygon.iter().enumerate() {
        let a = polygon[(k + polygon.len() - 1) % polygon.len()];
        let (at_a, at_b) = (measure(a.1), measure(b.1));
        if (at_a < 0.0) != (at_b < 0.0) {
            let share = at_a / (at_a - at_b);
            let mix = |x: f64, y: f64| x + share * (y - x);
            let at = [mix(a.0[0], b.0[0]), mix(a.0[1], b.0[1])];
            kept.push((at, mix(a.1, b.1)));
        }
        if at_b >= 0.0 {
            kept.push(b);
        }
    }
    kept
}

fn crossing(a: Valued, b: Valued, level: f64) -> PlanePoint {
    let share = (level - a.1) / (b.1 - a.1);
    array_of(|k| a.0[k] + share * (b.0[k] - a.0[k]))
}

#[cfg(test)]
mod tests {
    use super::{band, contour};
    use crate::plot::picture::section::area;

    #[test]
    fn bands_make_up_the_triangle() {
        let triangle = [([0.0, 0.0], -0.3), ([2.0, 0.0], 1.7), ([0.5, 1.5], 0.4)];
        let levels = [-0.3, 0.0, 0.4, 1.0, 1.7];
        let areas: f64 = levels.windows(2).map(|l| area(&band(&triangle, l[0], l[1]))).sum();
        assert!((areas - 1.5).abs() < 1e-12, "{areas}");
        assert!(band(&triangle, 2.0, 3.0).is_empty());
        assert_eq!(contour(&triangle, 3.0), None);
        let [from, to] = contour(&triangle, 0.4).unwrap();
        // the value grows by one along the lower side, and is that of the third corner there
        assert!((from[0] - 0.7).abs() < 1e-12 && to == [0.5, 1.5], "{from:?} {to:?}");
    }
}
