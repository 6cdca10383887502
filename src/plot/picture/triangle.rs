//! The triangles that a picture shows: the cells of a mesh in the plane, facets of cells of one in space.

use crate::arrays::{array_of, map_entries};
use crate::measure::Fields;
use crate::mesh::{Mesh, edge_vertices};
use crate::real::Point;

/// A point in the plane of the picture.
pub(crate) type PlanePoint = [f64; 2];

/// A point of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    pub at: PlanePoint,
    /// Its barycentric coordinates in the cell.
    pub barycentric: [f64; 4],
}

/// A cell in the plane, or a facet of a cell in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Triangle {
    pub cell: usize,
    /// The numbers of its vertices in the cell.
    pub locals: [usize; 3],
    pub corners: [Corner; 3],
}

impl Triangle {
    /// The places of its corners.
    pub fn places(&self) -> Vec<PlanePoint> {
        self.corners.iter().map(|corner| corner.at).collect()
    }
}

/// A view of a mesh: its projection along straight lines.
pub(crate) struct View<'a, const D: usize> {
    pub mesh: &'a Mesh<D>,
    pub fields: &'a Fields,
    /// The unit vectors that point to the right and upwards in the picture.
    pub axes: [Point<D>; 2],
}

impl<'a, const D: usize> View<'a, D> {
    /// The view with these coordinates to the right and upwards.
    pub fn along_coordinates(mesh: &'a Mesh<D>, fields: &'a Fields, axes: [usize; 2]) -> Self {
        let unit = |axis: usize| Point::from_fn(|k, _| f64::from(u8::from(k == axis)));
        View { mesh, fields, axes: map_entries(axes, unit) }
    }

    /// The place of a point in the picture.
    pub fn place(&self, x: &Point<D>) -> PlanePoint {
        map_entries([0, 1], |k| self.axes[k].dot(x))
    }

    /// The places of vertices.
    pub fn places(&self, vertices: [u32; 2]) -> [PlanePoint; 2] {
        map_entries(vertices, |v| self.place(&self.mesh.vertices()[v as usize]))
    }

    /// A cell of a mesh in the plane.
    pub fn cell(&self, cell: usize) -> Triangle {
        self.facet(cell, D + 1)
    }

    /// A facet of a cell in space: that opposite the vertex of this number.
    pub fn facet(&self, cell: usize, opposite: usize) -> Triangle {
        let mut others = (0..=D).filter(|k| *k != opposite);
        let locals = array_of(|_| others.next().expect("a triangle has three vertices"));
        let corner = |local: usize| {
            let vertex = self.mesh.cell(cell)[local] as usize;
            let barycentric = array_of(|k| f64::from(u8::from(k == local)));
            Corner { at: self.place(&self.mesh.vertices()[vertex]), barycentric }
        };
        Triangle { cell, locals, corners: map_entries(locals, corner) }
    }

    /// The triangles on which the solution on a triangle is drawn as linear, with its values at their corners: of a
    /// quadratic function those between the vertices and the midpoints of the edges.
    pub fn linear_pieces(&self, triangle: &Triangle) -> Vec<[(PlanePoint, f64); 3]> {
        let valued = |c: Corner| (c.at, self.value(triangle.cell, &c.barycentric));
        let pieces = match self.fields.midpoints.is_empty() {
            true => vec![triangle.corners],
            false => quarters(triangle.corners).to_vec(),
        };
        pieces.into_iter().map(|piece| map_entries(piece, valued)).collect()
    }

    /// The value of the solution at a point of a cell.
    pub fn value(&self, cell: usize, barycentric: &[f64; 4]) -> f64 {
        let b = barycentric;
        let corners = &self.fields.u[cell * (D + 1)..(cell + 1) * (D + 1)];
        let edges = edge_vertices(D);
        let Some(middles) = self.fields.midpoints.get(cell * edges.len()..(cell + 1) * edges.len())
        else {
            return corners.iter().zip(b).map(|(u, b)| u * b).sum();
        };
        let at_corners: f64 = corners.iter().zip(b).map(|(u, b)| u * b * (2.0 * b - 1.0)).sum();
        let at_middles = edges.iter().zip(middles).map(|(&[i, j], u)| 4.0 * u * b[i] * b[j]);
        at_corners + at_middles.sum::<f64>()
    }
}

/// The triangles between the corners of a triangle and the midpoints of its edges.
pub(crate) fn quarters([a, b, c]: [Corner; 3]) -> [[Corner; 3]; 4] {
    let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// The middle of a segment.
fn middle(a: Corner, b: Corner) -> Corner {
    Corner {
        at: array_of(|k| 0.5 * (a.at[k] + b.at[k])),
        barycentric: array_of(|k| 0.5 * (a.barycentric[k] + b.barycentric[k])),
    }
}
