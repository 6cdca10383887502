//! Obstacles and gaps of degree two that are convex in each cell: a linear function that exceeds them at the vertices
//! exceeds them everywhere.

use nalgebra::SMatrix;

use crate::assemble::space::Space;
use crate::mesh::{BoundaryCondition, HalfFacet};
use crate::problem::Datum;
use crate::real::Point;

/// An eigenvalue of a Hessian counts as zero below this many units of rounding of the largest value.
const ROUNDINGS: f64 = 64.0;

impl<const D: usize> Space<'_, D> {
    /// Whether a linear function within the constraints at all vertices is within them everywhere, if lower obstacles and
    /// gaps are convex functions of degree two in each cell and upper obstacles concave ones.
    pub(super) fn has_convex_obstacles(&self) -> bool {
        let in_cell = |cell: usize| {
            let (region, corners) = (self.mesh.region(cell), self.mesh.corners(cell));
            let is_convex = |psi: Option<&Datum<D>>, sign: f64| {
                psi.is_none_or(|psi| self.is_convex(psi, sign, cell, &corners[..=D]))
            };
            is_convex(self.data.lower.of(region), 1.0)
                && is_convex(self.data.upper.of(region), -1.0)
        };
        let on_facet = |(facet, group): (HalfFacet, usize)| {
            let vertices = self.mesh.facet_vertices(facet.0, facet.1);
            let corners: Vec<_> = vertices.map(|v| self.mesh.vertices()[v as usize]).collect();
            self.data.gap.of(group).is_none_or(|gap| self.is_convex(gap, 1.0, facet.0, &corners))
        };
        (0..self.mesh.n_cells()).all(in_cell)
            && self.grouped_facets_of(BoundaryCondition::Contact).all(on_facet)
    }

    /// Whether a function of degree two, times a sign, is convex on the simplex with these corners. With Bernstein
    /// coefficients `c` its second derivatives along the edges from the first corner are
    /// `2 (c_ij - c_0i - c_0j + c_00)`; the matrix of these has no negative eigenvalue if, with rounding added to its
    /// diagonal, all pivots are positive.
    fn is_convex(&self, psi: &Datum<D>, sign: f64, cell: usize, corners: &[Point<D>]) -> bool {
        let at = |x: &Point<D>| sign * self.at(psi, cell, x);
        let of_corners: Vec<f64> = corners.iter().map(at).collect();
        let coefficient = |i: usize, j: usize| {
            let middle = at(&((corners[i] + corners[j]) * 0.5));
            2.0 * middle - 0.5 * (of_corners[i] + of_corners[j])
        };
        let n = corners.len() - 1;
        let largest = of_corners.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let rounding = ROUNDINGS * (f64::EPSILON * largest + psi.rounding());
        let entry = |i: usize, j: usize| match (i < n, j < n) {
            (true, true) => {
                let mixed = coefficient(i + 1, j + 1) - coefficient(0, i + 1);
                let shift = if i == j { rounding } else { 0.0 };
                mixed - coefficient(0, j + 1) + of_corners[0] + shift
            }
            _ => f64::from(u8::from(i == j)),
        };
        SMatrix::<f64, 3, 3>::from_fn(entry).cholesky().is_some()
    }
}
