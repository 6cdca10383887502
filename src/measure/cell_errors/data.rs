//! What the values of data at a few points tell of a cell.

use crate::assemble::space::Space;
use crate::mesh::edge_vertices;
use crate::problem::Datum;
use crate::real::Point;

/// The largest ratio of two values at the corners of a cell of a coefficient or reaction that counts as smooth there.
/// With a larger one a datum without a level, and with it the integrand, may jump within the cell.
const SMOOTH_RATIO: f64 = 2.0;

/// An obstacle is linear along an edge if its value at the middle differs from the mean of its values at the ends by at
/// most this share.
const LINEAR: f64 = 1e-14;

impl<const D: usize> Space<'_, D> {
    /// Whether obstacles are linear in a cell, as far as their values at corners and middles of edges tell. A linear
    /// obstacle exceeds no linear admissible function within a cell.
    pub(super) fn has_linear_obstacles(&self, cell: usize) -> bool {
        let (region, corners) = (self.mesh.region(cell), self.mesh.corners(cell));
        let is_linear = |bound: &Datum<D>| {
            let at = |x: &Point<D>| self.at(bound, cell, x);
            let at_corners = corners.map(|x| at(&x));
            edge_vertices(D).iter().all(|&[a, b]| {
                let at_middle = at(&((corners[a] + corners[b]) * 0.5));
                let deviation = (at_middle - 0.5 * (at_corners[a] + at_corners[b])).abs();
                let rounding = 8.0 * bound.rounding();
                deviation <= LINEAR * (at_corners[a].abs() + at_corners[b].abs()) + rounding
            })
        };
        let bounds = [self.data.lower.of(region), self.data.upper.of(region)];
        bounds.into_iter().flatten().all(is_linear)
    }
}

/// Whether a coefficient may jump within a cell with these corners, though no level says so.
pub(super) fn may_jump<const D: usize>(
    coefficient: Option<&Datum<D>>,
    corners: &[Point<D>; 4],
) -> bool {
    let Some(alpha) = coefficient else { return false };
    if alpha.constant().is_some() || alpha.level().is_some() {
        return false;
    }
    let values = corners[..=D].iter().map(|x| alpha.at(x));
    let (least, most) = values.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    most > SMOOTH_RATIO * least
}
