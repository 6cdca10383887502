//! The affine geometry of one cell, and the search of the cells at a point.

pub(super) mod box_search;
pub(super) mod simplex;

use super::simplicial::Mesh;
use crate::arrays::array_of;
use crate::real::Point;
use simplex::{FACTORIAL, cofactors, longest_edge, with_zeros};

/// Volume of a cell and gradients of its barycentric coordinates.
///
/// # Panics
/// A method that takes the number of a vertex in the cell panics if that is above three.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct CellGeometry<const D: usize> {
    /// The cell's `D`-dimensional measure.
    pub volume: f64,
    gradients: [Point<D>; 4],
    is_positive: bool,
}

impl<const D: usize> CellGeometry<D> {
    /// The geometry of the simplex with these `D + 1` corners.
    ///
    /// The gradients of a simplex without volume are zero; no mesh has such cells.
    #[inline(always)]
    pub fn new(corner: impl Fn(usize) -> Point<D>) -> Self {
        const { assert!(D >= 1 && D <= 3, "simplices of dimension 1, 2 and 3 only") }
        let origin = corner(0);
        let edge = |k: usize| corner(k + 1) - origin;
        let edges = array_of(|k| if k < D { with_zeros(edge(k)) } else { [0.0; 3] });
        let (normals, determinant) = cofactors::<D>(edges);
        let mut gradients = [Point::zeros(); 4];
        let inverse = if determinant == 0.0 { 0.0 } else { 1.0 / determinant };
        for k in 1..=D {
            let gradient = Point::from_fn(|axis, _| normals[k - 1][axis]) * inverse;
            gradients[k] = gradient;
            gradients[0] -= gradient;
        }
        let magnitude = if determinant < 0.0 { -determinant } else { determinant };
        let volume = magnitude / FACTORIAL[D];
        Self { volume, gradients, is_positive: determinant > 0.0 }
    }

    /// Whether the determinant of the edges from corner 0 to the others is positive.
    #[inline(always)]
    pub(crate) fn is_positive(&self) -> bool {
        self.is_positive
    }

    /// The gradient of barycentric coordinate `i`.
    #[inline(always)]
    pub fn gradient(&self, i: usize) -> &Point<D> {
        &self.gradients[i]
    }
    /// The outward unit normal of facet `i`.
    #[inline(always)]
    pub fn normal(&self, i: usize) -> Point<D> {
        let height = 1.0 / self.gradients[i].norm();
        self.gradients[i] * -height
    }
    /// The `(D - 1)`-dimensional measure of facet `i`; one in one dimension.
    #[inline(always)]
    pub fn facet_measure(&self, i: usize) -> f64 {
        if D == 1 { 1.0 } else { (D as f64) * self.volume * self.gradients[i].norm() }
    }
}

impl<const D: usize> Mesh<D> {
    /// The geometry of a cell.
    #[inline(always)]
    pub fn geometry(&self, c: usize) -> CellGeometry<D> {
        let cell = self.cell(c);
        CellGeometry::new(|k| self.vertices[cell[k] as usize])
    }
    /// The barycentric coordinates of a point in a cell, and zeros.
    pub(crate) fn barycentric(&self, c: usize, x: &Point<D>) -> [f64; 4] {
        let geometry = self.geometry(c);
        let mut lambda = [0.0; 4];
        for ((k, coordinate), &v) in lambda.iter_mut().enumerate().zip(self.cell(c)) {
            let from = x - (self.vertices[v as usize]);
            *coordinate = 1.0 + geometry.gradient(k).dot(&from);
        }
        lambda
    }
    /// The point of a cell with these barycentric coordinates.
    #[inline(always)]
    pub fn point(&self, c: usize, barycentric: &[f64]) -> Point<D> {
        self.cell(c)
            .iter()
            .zip(barycentric)
            .fold(Point::zeros(), |x, (&v, &b)| x + self.vertices[v as usize] * b)
    }
    /// The barycentre of a facet.
    pub fn facet_barycentre(&self, c: usize, local: usize) -> Point<D> {
        let sum = self
            .facet_vertices(c, local)
            .fold(Point::zeros(), |s: Point<D>, v| s + self.vertices[v as usize]);
        sum / (D as f64)
    }
    /// The largest distance of two vertices of a facet: the length of an edge in two dimensions,
    /// the diameter of a triangle in three; zero in one.
    #[inline(always)]
    pub fn facet_diameter(&self, c: usize, local: usize) -> f64 {
        let cell = self.cell(c);
        longest_edge(|k| self.vertices[cell[k] as usize], Some(local))
    }
}

/// The coordinates of a point in parentheses, for messages.
pub(crate) fn describe_point<const D: usize>(x: &Point<D>) -> String {
    let coordinates: Vec<String> = x.iter().map(|c| format!("{c:.6}")).collect();
    format!("({})", coordinates.join(", "))
}
