//! The panels of a picture in one dimension: functions over the line.

use super::axes::{Stroke, Symbol};
use super::graph::Graph;
use crate::arrays::map_entries;
use crate::measure::Fields;
use crate::mesh::Mesh;
use crate::problem::{DataOnMesh, Datum, Problem};
use crate::real::Point;

/// Pieces of a cell on which given functions are drawn as linear.
const PARTS: usize = 6;

/// The data of the panels.
pub(crate) struct Line<'a, const D: usize> {
    problem: &'a Problem<D>,
    mesh: &'a Mesh<D>,
    fields: &'a Fields,
}

impl<'a, const D: usize> Line<'a, D> {
    pub fn new(problem: &'a Problem<D>, mesh: &'a Mesh<D>, fields: &'a Fields) -> Self {
        Line { problem, mesh, fields }
    }

    /// The ends of a cell.
    fn ends(&self, cell: usize) -> [f64; 2] {
        let cell = self.mesh.cell(cell);
        map_entries([0, 1], |k| self.mesh.vertices()[cell[k] as usize][0])
    }

    /// Cells in contact, and points.
    fn contact(&self) -> Vec<[f64; 2]> {
        let cells = self.fields.discrete_contact.cells.iter().map(|&cell| {
            let [a, b] = self.ends(cell);
            [a.min(b), a.max(b)]
        });
        let points = self.fields.discrete_contact.facets.iter().map(|&(cell, local)| {
            let x = self.ends(cell)[1 - local];
            [x, x]
        });
        cells.chain(points).collect()
    }

    /// Segments of data that are given, by cell.
    fn given<'d>(
        &self,
        of: &dyn Fn(usize) -> Option<&'d Datum<D>>,
        stroke: Stroke,
    ) -> Vec<(Stroke, [[f64; 2]; 2])> {
        let mut lines = Vec::new();
        for cell in 0..self.mesh.n_cells() {
            let Some(datum) = of(cell) else { continue };
            let [a, b] = self.ends(cell);
            let at = |k: usize| {
                let x = a + (b - a) * k as f64 / PARTS as f64;
                [x, datum.in_cell(self.mesh, cell, &Point::repeat(x))]
            };
            lines.extend((0..PARTS).map(|k| (stroke, [at(k), at(k + 1)])));
        }
        lines
    }

    fn mark_contact(&self, graph: &mut Graph) {
        let exact = self.problem.exact.as_ref().and_then(|e| e.contact.as_ref());
        let marks = exact.iter().flat_map(|set| &set.free_boundary).map(|x| x[0]).collect();
        graph.mark(self.contact(), marks);
    }

    /// The solution over its obstacles, with the contact set and the free boundary.
    pub fn solution(&self) -> Graph {
        let mut graph = Graph::of_found("solution", ["x", "u"], "u");
        // a problem that was solved on the mesh has its data there
        if let Ok(data) = DataOnMesh::new(self.problem, self.mesh) {
            for obstacle in [&data.lower, &data.upper] {
                let of = |cell| obstacle.of(self.mesh.region(cell));
                graph.lines.extend(self.given(&of, Stroke::Given));
            }
        }
        if self.problem.has_obstacle() {
            graph.legend.push((Symbol::Line(Stroke::Given), "obstacle".to_owned()));
        }
        for cell in 0..self.mesh.n_cells() {
            let [a, b] = self.ends(cell);
            let u = map_entries([0, 1], |k| self.fields.u[2 * cell + k]);
            match self.fields.midpoints.get(cell) {
                None => graph.lines.push((Stroke::Solution, [[a, u[0]], [b, u[1]]])),
                Some(&middle) => {
                    let at = |k: usize| {
                        let t = k as f64 / PARTS as f64;
                        let value = u[0] * (1.0 - t) * (1.0 - 2.0 * t)
                            + u[1] * t * (2.0 * t - 1.0)
                            + 4.0 * middle * t * (1.0 - t);
                        [a + (b - a) * t, value]
                    };
                    graph.lines.extend((0..PARTS).map(|k| (Stroke::Solution, [at(k), at(k + 1)])));
                }
            }
        }
        self.mark_contact(&mut graph);
        graph
    }
}
