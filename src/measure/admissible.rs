//! Continuous functions within the constraints, evaluated in cells.

use crate::mesh::{Mesh, edge_vertices};
use crate::problem::Datum;
use crate::real::Point;

/// The step of difference quotients of obstacles, as a share of the diameter of the cell.
const STEP: f64 = 1e-5;

/// By cell a function whose error is measured.
pub(crate) type InCells<'f, const D: usize> = &'f (dyn Fn(usize) -> Admissible<'f, D> + Sync);

/// An admissible function in a cell.
pub(crate) struct Admissible<'d, const D: usize> {
    /// The mesh and the number of the cell.
    pub place: (&'d Mesh<D>, usize),
    /// At the vertices.
    pub values: [f64; 4],
    /// The gradient of the linear interpolant.
    pub gradient: Point<D>,
    /// For quadratics, by edge, four times the value at the midpoint less that of the linear interpolant.
    pub excess: Option<[f64; 6]>,
    /// The gradients of the barycentric coordinates.
    pub gradients: [Point<D>; 4],
    /// The obstacles, lower and upper one.
    pub bounds: [Option<&'d Datum<D>>; 2],
}

impl<const D: usize> Admissible<'_, D> {
    /// Value and gradient at a point, by barycentric coordinates and in space.
    pub fn at(&self, point: &[f64; 4], x: &Point<D>) -> (f64, Point<D>) {
        let mut value = self.values.iter().zip(point).map(|(v, b)| v * b).sum();
        let mut gradient = self.gradient;
        if let Some(excess) = &self.excess {
            for (&[a, b], excess) in edge_vertices(D).iter().zip(excess) {
                value += excess * point[a] * point[b];
                gradient += (self.gradients[b] * point[a] + self.gradients[a] * point[b]) * *excess;
            }
        }
        let (mesh, cell) = self.place;
        let in_cell = |bound: &Datum<D>, x: &Point<D>| bound.in_cell(mesh, cell, x);
        for (bound, sign) in self.bounds.iter().zip([1.0, -1.0]) {
            let Some(bound) = bound else { continue };
            let at = in_cell(bound, x);
            if sign * (at - value) > 0.0 {
                value = at;
                // rounding of values divided by the step, and the square of the step, are of one size
                let step = STEP.max(bound.rounding().cbrt()) * mesh.cell_diameter(cell);
                gradient = Point::from_fn(|axis, _| {
                    let (mut ahead, mut behind) = (*x, *x);
                    ahead[axis] += step;
                    behind[axis] -= step;
                    (in_cell(bound, &ahead) - in_cell(bound, &behind)) / (2.0 * step)
                });
            }
        }
        (value, gradient)
    }
    /// Whether the function is known to be linear in its cell: it has no values on edges, and obstacles are affine and
    /// nowhere beyond it.
    pub fn is_linear(&self, corners: &[Point<D>; 4]) -> bool {
        let is_beyond = |(bound, sign): (&Datum<D>, f64)| {
            let (mesh, cell) = self.place;
            let within = |(x, value): (&Point<D>, &f64)| {
                sign * (value - bound.in_cell(mesh, cell, x)) >= 0.0
            };
            bound.is_discrete()
                || bound.degree_on(self.place.0, None).is_none_or(|degree| degree > 1)
                || !corners[..=D].iter().zip(&self.values).all(within)
        };
        let bounds = self.bounds.into_iter().zip([1.0, -1.0]);
        let mut given = bounds.filter_map(|(bound, sign)| Some((bound?, sign)));
        self.excess.is_none() && !given.any(is_beyond)
    }
}
