//! Points to test a scene at.

use crate::mesh::BoundaryPart;
use crate::real::Point;
use crate::scenes::BoxDomain;

/// Quasi-random points of a box: the additive recurrence `x_n = 1/2 + n theta mod 1`, where
/// `theta_k = 1/phi^k` and `phi` is the positive root of `phi^(D+1) = phi + 1`.
///
/// In one dimension this is the golden ratio; `1, theta_1, ..., theta_D` are independent over the
/// rationals, so the points fill the box evenly and never sit on mesh lines.
pub(super) fn in_box<const D: usize>(
    domain: &BoxDomain<D>,
) -> impl Iterator<Item = Point<f64, D>> + '_ {
    // The map contracts by a factor of at most 1/(D + 1) at its fixed point.
    let phi = (0..60).fold(2.0_f64, |phi, _| (1.0 + phi).powf(1.0 / (D as f64 + 1.0)));
    (1_u32..).map(move |n| {
        Point::from_fn(|k, _| {
            let theta = phi.powi(-(k as i32 + 1));
            let t = (0.5 + f64::from(n) * theta).fract();
            domain.lower[k] + t * (domain.upper[k] - domain.lower[k])
        })
    })
}

/// Vertices of a uniform lattice of the box, corners included, and the origin if it is inside:
/// points of symmetry and of dyadic fractions, where meshes put vertices and scenes their tips.
pub(super) fn lattice<const D: usize>(
    domain: &BoxDomain<D>,
) -> impl Iterator<Item = Point<f64, D>> + '_ {
    let per_axis: usize = if D < 3 { 16 } else { 8 };
    let origin = (0..D).all(|k| domain.lower[k] <= 0.0 && 0.0 <= domain.upper[k]);
    (0..(per_axis + 1).pow(D as u32))
        .map(move |mut code| {
            Point::from_fn(|k, _| {
                let step = code % (per_axis + 1);
                code /= per_axis + 1;
                let t = step as f64 / per_axis as f64;
                (1.0 - t) * domain.lower[k] + t * domain.upper[k]
            })
        })
        .chain(origin.then(Point::zeros))
}

/// A side of the box.
pub(super) struct Side<const D: usize> {
    /// Its part of the boundary.
    pub part: BoundaryPart,
    /// Its outward unit normal.
    pub normal: Point<f64, D>,
    axis: usize,
    level: f64,
}

impl<const D: usize> Side<D> {
    /// The point moved along the normal onto the side.
    pub fn project(&self, x: &Point<f64, D>) -> Point<f64, D> {
        let mut x = *x;
        x[self.axis] = self.level;
        x
    }
    /// Points of the side that rounding may make of one: a few units in the last place inside and
    /// outside, and the other zero.
    pub fn rounded(&self, x: &Point<f64, D>, length: f64) -> [Point<f64, D>; 3] {
        let shift = self.normal * (4.0 * f64::EPSILON * length.max(self.level.abs()));
        let mut negated = *x;
        if self.level == 0.0 {
            negated[self.axis] = -0.0;
        }
        [x - shift, x + shift, negated]
    }
}

/// The sides of the box.
pub(super) fn sides<const D: usize>(domain: &BoxDomain<D>) -> impl Iterator<Item = Side<D>> + '_ {
    (0..D).flat_map(move |axis| {
        [(0, -1.0, &domain.lower), (1, 1.0, &domain.upper)].map(|(end, sign, corner)| {
            let mut normal = Point::zeros();
            normal[axis] = sign;
            Side { part: domain.sides[axis][end], normal, axis, level: corner[axis] }
        })
    })
}
