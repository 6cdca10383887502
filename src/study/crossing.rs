//! Lower bounds above upper ones, looked for before anything is solved.

use std::ops::Range;

use crate::assemble::DataQuadrature;
use crate::assemble::cut_simplices::in_space;
use crate::error::Error;
use crate::mesh::{BoundaryCondition, Edges, Mesh, describe_point, edge_vertices};
use crate::parallel::cells;
use crate::problem::{DataOnMesh, Datum, Problem};
use crate::quadrature::facet_to_cell;
use crate::real::Point;
use crate::scheme::Scheme;
use crate::study::compatibility::cube;

/// Bounds cross if they do so by more than this share of the largest of them: less is rounding in the data.
const RELATIVE_SLACK: f64 = 1e-9;

/// Barycentric points of cells and of contact facets at which bounds are compared.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    in_cells: Vec<[f64; 4]>,
    on_facets: Vec<[f64; 4]>,
}

/// Two bounds at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing<const D: usize> {
    x: Point<D>,
    lower: f64,
    upper: f64,
}

impl<const D: usize> Crossing<D> {
    /// The error of the data.
    pub fn error(&self) -> Error {
        let Self { x, lower, upper } = self;
        Error::BoundsCross(format!(
            "no function is admissible: at {}, a point of the finest mesh, the lower bound {lower} exceeds the upper bound {upper}",
            describe_point(x)
        ))
    }
}

/// The bounds that differ most, of those seen, and the size of the largest bound.
#[derive(Clone, Copy)]
pub(super) struct Seen<const D: usize> {
    worst: Option<Crossing<D>>,
    pub size: f64,
}

impl<const D: usize> Seen<D> {
    const NOTHING: Self = Self { worst: None, size: 0.0 };

    /// Compares two bounds; those that are not finite are found elsewhere.
    fn compare(&mut self, crossing: Crossing<D>) {
        let Crossing { lower, upper, .. } = crossing;
        if lower.is_finite() && upper.is_finite() {
            self.size = self.size.max(lower.abs()).max(upper.abs());
            if self.worst.is_none_or(|worst| lower - upper > worst.lower - worst.upper) {
                self.worst = Some(crossing);
            }
        }
    }

    /// The worst place, if the bounds cross there by more than rounding of data of a size.
    pub fn crossing(&self, size: f64) -> Option<Crossing<D>> {
        let slack = RELATIVE_SLACK * size;
        self.worst.filter(|worst| worst.lower - worst.upper > slack)
    }

    /// The worst crossing and the largest size of two parts of a mesh.
    fn merged(mut self, other: Self) -> Self {
        other.worst.into_iter().for_each(|crossing| self.compare(crossing));
        Self { size: self.size.max(other.size), ..self }
    }
}

impl Points {
    /// Adds the points of a scheme, with the constraint set of a problem without data: its nodes, and the points of its
    /// rules for data. They are those on any mesh. A scheme that is made for none has none.
    pub fn add<const D: usize>(
        &mut self,
        scheme: &dyn Scheme<D>,
        without_data: &Problem<D>,
        quadrature: DataQuadrature,
    ) -> Result<(), Error> {
        let mesh = cube()?;
        let Ok(of) = scheme.discretise(without_data, &mesh, quadrature) else { return Ok(()) };
        let nodes = of.space.nodes.iter().map(|node| node.centre(D));
        let points = nodes.chain(of.space.cell_rule.points.iter().copied());
        for point in points {
            if !self.in_cells.contains(&point) {
                self.in_cells.push(point);
            }
        }
        for point in &of.space.facet_rule.points {
            if !self.on_facets.contains(point) {
                self.on_facets.push(*point);
            }
        }
        Ok(())
    }

    /// The worst crossing of lower and upper bounds on a mesh: obstacles at vertices, midpoints of edges and
    /// these points of cells, gaps at vertices, midpoints of edges and these points of contact facets. At vertices and
    /// on edges the bounds of all cells and contact facets around count together.
    pub fn look<const D: usize>(
        &self,
        problem: &Problem<D>,
        mesh: &Mesh<D>,
    ) -> Result<Seen<D>, Error> {
        let data = DataOnMesh::new(problem, mesh)?;
        let has_lower = data.lower.is_given() || data.gap.is_given();
        if !has_lower || !data.upper.is_given() {
            return Ok(Seen::NOTHING);
        }
        let on_mesh = OnMesh { data: &data, mesh };
        let seen = cells::map(mesh.n_cells(), &|cells: Range<usize>| {
            let mut seen = Seen::NOTHING;
            cells.for_each(|cell| on_mesh.compare_in(cell, &self.in_cells, &mut seen));
            seen
        });
        let mut seen = seen.into_iter().fold(Seen::NOTHING, Seen::merged);
        for f in mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact) {
            let place = (f.cell as usize, usize::from(f.local));
            on_mesh.compare_on(place, usize::from(f.group), &self.on_facets, &mut seen);
        }
        on_mesh.compare_at_shared_nodes(&mut seen);
        Ok(seen)
    }
}

/// The data of a problem on a mesh.
struct OnMesh<'m, const D: usize> {
    data: &'m DataOnMesh<D>,
    mesh: &'m Mesh<D>,
}

impl<const D: usize> OnMesh<'_, D> {
    /// Compares the obstacles of a cell.
    fn compare_in(&self, cell: usize, points: &[[f64; 4]], seen: &mut Seen<D>) {
        let region = self.mesh.region(cell);
        let Some((lower, upper)) = self.data.lower.of(region).zip(self.data.upper.of(region))
        else {
            return;
        };
        let corners = self.mesh.corners(cell);
        for point in nodes_of_cell::<D>().chain(points.iter().copied()) {
            let x = in_space(&point, &corners);
            let [lower, upper] = [lower, upper].map(|psi| psi.in_cell(self.mesh, cell, &x));
            seen.compare(Crossing { x, lower, upper });
        }
    }

    /// Compares the gap of a contact facet with the upper obstacle of its cell.
    fn compare_on(
        &self,
        (cell, local): (usize, usize),
        group: usize,
        points: &[[f64; 4]],
        seen: &mut Seen<D>,
    ) {
        let upper = self.data.upper.of(self.mesh.region(cell));
        let Some((gap, upper)) = self.data.gap.of(group).zip(upper) else { return };
        let corners = self.mesh.corners(cell);
        for point in points {
            let x = in_space(&facet_to_cell(point, local), &corners);
            let [lower, upper] = [gap, upper].map(|bound| bound.in_cell(self.mesh, cell, &x));
            seen.compare(Crossing { x, lower, upper });
        }
    }

    /// Compares the largest lower bound with the smallest upper one at vertices and midpoints of edges, where several
    /// cells and contact facets have different ones.
    fn compare_at_shared_nodes(&self, seen: &mut Seen<D>) {
        let data = self.data;
        if !(data.obstacles_differ() || data.gap.is_given()) {
            return;
        }
        let n_vertices = self.mesh.vertices().len();
        let (edges, of_cells) = Edges::with_cell_edges(self.mesh);
        let per_cell = edge_vertices(D).len();
        let number = |cell: usize, k: usize| match k.checked_sub(D + 1) {
            None => self.mesh.cell(cell)[k] as usize,
            Some(edge) => n_vertices + of_cells[cell * per_cell + edge] as usize,
        };
        let free = (0, f64::NEG_INFINITY, f64::INFINITY);
        let mut bounds = vec![free; n_vertices + edges.len()];
        let mut add = |cell: usize, k: usize, lower: Option<f64>, upper: Option<f64>| {
            let (of_cell, low, high) = &mut bounds[number(cell, k)];
            *of_cell = cell;
            *low = lower.map_or(*low, |lower| low.max(lower));
            *high = upper.map_or(*high, |upper| high.min(upper));
        };
        for cell in 0..self.mesh.n_cells() {
            let region = self.mesh.region(cell);
            let (lower, upper) = (data.lower.of(region), data.upper.of(region));
            let corners = self.mesh.corners(cell);
            for (k, point) in nodes_of_cell::<D>().enumerate() {
                let x = in_space(&point, &corners);
                let at = |psi: &Datum<D>| psi.in_cell(self.mesh, cell, &x);
                add(cell, k, lower.map(at), upper.map(at));
            }
        }
        for f in self.mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact) {
            let Some(gap) = data.gap.of(usize::from(f.group)) else { continue };
            let (cell, local) = (f.cell as usize, usize::from(f.local));
            let corners = self.mesh.corners(cell);
            let on_facet = nodes_of_cell::<D>().enumerate().filter(|(_, p)| p[local] == 0.0);
            for (k, point) in on_facet {
                let x = in_space(&point, &corners);
                add(cell, k, Some(gap.in_cell(self.mesh, cell, &x)), None);
            }
        }
        for cell in 0..self.mesh.n_cells() {
            let corners = self.mesh.corners(cell);
            for (k, point) in nodes_of_cell::<D>().enumerate() {
                let (of_cell, lower, upper) = bounds[number(cell, k)];
                if of_cell == cell {
                    seen.compare(Crossing { x: in_space(&point, &corners), lower, upper });
                }
            }
        }
    }
}

/// The vertices of a cell and, after them, the midpoints of its edges.
fn nodes_of_cell<const D: usize>() -> impl Iterator<Item = [f64; 4]> {
    let vertices = (0..D + 1).map(|k| [k; 2]);
    vertices.chain(edge_vertices(D).iter().copied()).map(|[a, b]| {
        let mut point = [0.0; 4];
        point[a] += 0.5;
        point[b] += 0.5;
        point
    })
}
