//! Samples of free boundaries.

use std::f64::consts::{PI, TAU};

use crate::real::Point;

/// Distance of neighbouring points on a curve, relative to the side of the domain.
const ON_CURVES: f64 = 1.0 / 500.0;
/// Distance of neighbouring points on a surface, relative to the side of the domain.
const ON_SURFACES: f64 = 1.0 / 100.0;

/// Points of the sphere of this radius around the origin, in a domain of this side: two in one
/// dimension, a regular polygon in two, a spiral in three.
///
/// The spiral has equal areas between equal steps of height and turns by the golden angle from
/// point to point; see R. Swinbank, R. J. Purser, Q. J. R. Meteorol. Soc. 132 (2006), 1769-1793.
pub(super) fn sphere<const D: usize>(radius: f64, side: f64) -> Vec<Point<D>> {
    let on = |axes: &[f64]| Point::from_fn(|k, _| radius * axes[k]);
    match D {
        1 => vec![on(&[-1.0]), on(&[1.0])],
        2 => {
            let n = (TAU * radius / (ON_CURVES * side)).ceil();
            let angle = |k: u32| TAU * f64::from(k) / n;
            (0..n as u32).map(|k| on(&[angle(k).cos(), angle(k).sin()])).collect()
        }
        _ => {
            let n = (4.0 * PI * (radius / (ON_SURFACES * side)).powi(2)).ceil();
            let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
            (0..n as u32)
                .map(|k| {
                    let height = 1.0 - (2.0 * f64::from(k) + 1.0) / n;
                    let across = (1.0 - height * height).sqrt();
                    let angle = golden_angle * f64::from(k);
                    on(&[across * angle.cos(), across * angle.sin(), height])
                })
                .collect()
        }
    }
}

/// Points of a segment, both ends among them, in a domain of this side.
pub(super) fn segment<const D: usize>(from: Point<D>, to: Point<D>, side: f64) -> Vec<Point<D>> {
    let n = ((to - from).norm() / (ON_CURVES * side)).ceil().max(1.0);
    (0..=n as u32).map(|k| from + (to - from) * (f64::from(k) / n)).collect()
}

/// Points of the contact side of `(-1, 1)^(D-1) x (0, 1)` whose first coordinate is `c`: one in the plane, a segment in
/// space.
pub(super) fn transition_at<const D: usize>(c: f64) -> Vec<Point<D>> {
    let end = |y: f64| {
        Point::from_fn(|k, _| match k {
            0 => c,
            k if k + 1 == D => 0.0,
            _ => y,
        })
    };
    match D {
        2 => vec![end(0.0)],
        _ => segment(end(-1.0), end(1.0), 2.0),
    }
}

/// Points of the circle of this radius around the origin in the plane where the last coordinate is
/// zero, in a domain of this side.
pub(super) fn circle(radius: f64, side: f64) -> Vec<Point<3>> {
    sphere::<2>(radius, side).iter().map(|x| x.push(0.0)).collect()
}
