//! The part of the plane that a picture shows: cells of a mesh in the plane, or the sections of
//! cells in space by a coordinate plane.

use crate::arrays::array_of;
use crate::measure::Fields;
use crate::mesh::{Mesh, edge_vertices};
use crate::real::Point;

/// A coordinate plane through a mesh in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// The coordinate that is fixed: 0, 1 or 2.
    pub axis: usize,
    /// The value of that coordinate.
    pub at: f64,
}

/// A point in the plane that is shown.
pub(crate) type PlanePoint = [f64; 2];

/// A corner of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    pub at: PlanePoint,
    /// Barycentric coordinates of the corner in the cell.
    pub barycentric: [f64; 4],
}

/// The visible part of a cell: a convex polygon.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Section {
    pub cell: usize,
    pub corners: Vec<Corner>,
}

/// Sections smaller than this in units of the whole, squared, are points and lines.
const FLAT: f64 = 1e-14;

/// A view of the mesh: the coordinates shown to the right and upwards, and the plane of the slice.
pub(crate) struct View<'a, const D: usize> {
    pub mesh: &'a Mesh<D>,
    pub fields: &'a Fields,
    pub axes: [usize; 2],
    slice: Option<Slice>,
    /// Whether points on the plane count as below it: on the lower end of the mesh nothing else is.
    on_is_below: bool,
    smallest: f64,
}

impl<'a, const D: usize> View<'a, D> {
    /// A mesh in the plane as it is, one in space cut by a plane.
    pub fn new(mesh: &'a Mesh<D>, fields: &'a Fields, slice: Option<Slice>) -> Self {
        let slice = slice.filter(|_| D == 3);
        let axes = match slice.map(|s| s.axis) {
            Some(0) => [1, 2],
            Some(1) => [0, 2],
            _ => [0, 1],
        };
        let lowest =
            |axis: usize| mesh.vertices().iter().map(|x| x[axis]).fold(f64::INFINITY, f64::min);
        let on_is_below = slice.is_some_and(|s| s.at <= lowest(s.axis));
        let smallest = FLAT * mesh.domain_diameter().powi(2);
        View { mesh, fields, axes, slice, on_is_below, smallest }
    }

    /// A corner of a cell in space.
    pub fn vertex(&self, cell: usize, k: usize) -> Point<D> {
        self.mesh.vertices()[self.mesh.cell(cell)[k] as usize]
    }

    /// A point of a cell in space.
    pub fn point(&self, cell: usize, barycentric: &[f64; 4]) -> Point<D> {
        (0..D + 1).fold(Point::zeros(), |x, k| x + self.vertex(cell, k) * barycentric[k])
    }

    fn plane_point(&self, x: &Point<D>) -> PlanePoint {
        // minus zero is the same place as zero
        self.axes.map(|k| x[k] + 0.0)
    }

    /// The sections of all cells.
    pub fn sections(&self) -> Vec<Section> {
        let whole = unit_corners::<D>();
        (0..self.mesh.n_cells()).filter_map(|cell| self.section(cell, &whole)).collect()
    }

    /// Triangles on which the function of a cell is drawn as linear: of a quadratic one those
    /// between its vertices and midpoints.
    pub fn linear_pieces(&self) -> Vec<Section> {
        let pieces = pieces::<D>(!self.fields.midpoints.is_empty());
        let of_cell = |cell| pieces.iter().filter_map(move |piece| self.section(cell, piece));
        (0..self.mesh.n_cells()).flat_map(of_cell).flat_map(triangles).collect()
    }

    /// The section of a simplex in a cell, given by barycentric coordinates of its corners.
    fn section(&self, cell: usize, simplex: &[[f64; 4]]) -> Option<Section> {
        let points: Vec<Point<D>> = simplex.iter().map(|b| self.point(cell, b)).collect();
        let corners = match self.slice {
            None => {
                let corner = |(b, x): (&[f64; 4], &Point<D>)| Corner {
                    at: self.plane_point(x),
                    barycentric: *b,
                };
                simplex.iter().zip(&points).map(corner).collect()
            }
            Some(slice) => self.cut(slice, simplex, &points),
        };
        let section = Section { cell, corners };
        (section.area() > self.smallest).then_some(section)
    }

    /// Where the plane crosses the edges of a simplex, in order around the section.
    fn cut(&self, slice: Slice, simplex: &[[f64; 4]], points: &[Point<D>]) -> Vec<Corner> {
        let height = |k: usize| points[k][slice.axis] - slice.at;
        let is_above =
            |k: &usize| if self.on_is_below { height(*k) > 0.0 } else { height(*k) >= 0.0 };
        let (above, below): (Vec<usize>, Vec<usize>) = (0..points.len()).partition(is_above);
        let mut edges: Vec<[usize; 2]> = Vec::new();
        for (turn, &a) in above.iter().enumerate() {
            let ends = below.iter().map(|&b| [a.min(b), a.max(b)]);
            // there and back, so that neighbours in the list share a face
            if turn % 2 == 0 { edges.extend(ends) } else { edges.extend(ends.rev()) }
        }
        let corner = |&[i, j]: &[usize; 2]| {
            let share = height(i) / (height(i) - height(j));
            let mut barycentric = [0.0; 4];
            for k in 0..4 {
                barycentric[k] = (1.0 - share) * simplex[i][k] + share * simplex[j][k];
            }
            // a vertex on the plane is where it is, in the section of every cell
            let at = match share == 1.0 {
                true => points[j],
                false => points[i] + (points[j] - points[i]) * share,
            };
            Corner { at: self.plane_point(&at), barycentric }
        };
        edges.iter().map(corner).collect()
    }

    /// The visible part of a facet: the whole facet in the plane, in space its section if the facet
    /// crosses the plane.
    pub fn facet(&self, cell: usize, local: usize) -> Option<[PlanePoint; 2]> {
        let whole = unit_corners::<D>();
        let corners: Vec<[f64; 4]> =
            whole.iter().enumerate().filter(|(k, _)| *k != local).map(|(_, b)| *b).collect();
        let points: Vec<Point<D>> = corners.iter().map(|b| self.point(cell, b)).collect();
        let ends: Vec<PlanePoint> = match self.slice {
            None => points.iter().map(|x| self.plane_point(x)).collect(),
            Some(slice) => self.cut(slice, &corners, &points).iter().map(|c| c.at).collect(),
        };
        <[PlanePoint; 2]>::try_from(ends).ok()
    }

    /// Whether a facet lies in the plane of the slice.
    pub fn lies_in_slice(&self, cell: usize, local: usize) -> bool {
        let corners = || (0..D + 1).filter(|k| *k != local);
        self.slice.is_some_and(|s| corners().all(|k| self.vertex(cell, k)[s.axis] == s.at))
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

    /// The density of the multiplier at a point of a cell. Dirichlet vertices have no density: there it
    /// is zero in a cell that is not in contact and has zero density at its other vertices, and unknown
    /// otherwise.
    pub fn density(&self, cell: usize, touches: bool, barycentric: &[f64; 4]) -> Option<f64> {
        let known = &self.fields.discrete_contact.density;
        let at = |k: usize| known.get(self.mesh.cell(cell)[k] as usize).copied().flatten();
        let free = !touches && (0..D + 1).all(|k| at(k).is_none_or(|density| density == 0.0));
        let mut sum = 0.0;
        for k in (0..D + 1).filter(|k| barycentric[*k] != 0.0) {
            match at(k) {
                Some(density) => sum += density * barycentric[k],
                None if free => {}
                None => return None,
            }
        }
        Some(sum)
    }
}

impl Section {
    /// The area of the section.
    pub fn area(&self) -> f64 {
        area(&self.corners.iter().map(|c| c.at).collect::<Vec<_>>())
    }
}

/// The area of a polygon, by the formula of the shoelace.
pub(crate) fn area(corners: &[PlanePoint]) -> f64 {
    let Some(&first) = corners.first() else { return 0.0 };
    // relative to a corner, so that little is lost far from the origin
    let at = |k: usize| [corners[k][0] - first[0], corners[k][1] - first[1]];
    let n = corners.len();
    let twice: f64 = (0..n)
        .map(|k| {
            let (a, b) = (at(k), at((k + 1) % n));
            a[0] * b[1] - a[1] * b[0]
        })
        .sum();
    0.5 * twice.abs()
}

/// A convex polygon cut into triangles.
fn triangles(section: Section) -> impl Iterator<Item = Section> {
    let Section { cell, corners } = section;
    (2..corners.len())
        .map(move |k| Section { cell, corners: vec![corners[0], corners[k - 1], corners[k]] })
}

fn unit_corners<const D: usize>() -> Vec<[f64; 4]> {
    (0..D + 1).map(|k| array_of(|i| f64::from(u8::from(i == k)))).collect()
}

/// The simplex, or the pieces between its vertices and the midpoints of its edges.
fn pieces<const D: usize>(quadratic: bool) -> Vec<Vec<[f64; 4]>> {
    let v = unit_corners::<D>();
    if !quadratic {
        return vec![v];
    }
    let middle = |i: usize, j: usize| array_of(|k| 0.5 * (v[i][k] + v[j][k]));
    let mut pieces: Vec<Vec<[f64; 4]>> = (0..D + 1)
        .map(|i| (0..D + 1).map(|j| if i == j { v[i] } else { middle(i, j) }).collect())
        .collect();
    if D == 2 {
        pieces.push(vec![middle(0, 1), middle(0, 2), middle(1, 2)]);
    }
    if D == 3 {
        // the octahedron within, in four around one of its diagonals
        let around = [middle(0, 1), middle(0, 2), middle(2, 3), middle(1, 3)];
        for k in 0..4 {
            pieces.push(vec![middle(0, 3), middle(1, 2), around[k], around[(k + 1) % 4]]);
        }
    }
    pieces
}
