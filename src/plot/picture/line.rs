//! The panel of a picture in one dimension: the solution over its obstacles, with the contact set and the free boundary.

use super::axes::{CONTACT, Stroke, Symbol};
use super::panel::Panel;
use super::triangle::PlanePoint;
use crate::arrays::map_entries;
use crate::measure::Fields;
use crate::mesh::Mesh;
use crate::problem::{DataOnMesh, Problem};
use crate::real::Point;

/// Pieces of a cell on which curves are drawn as linear.
const PARTS: usize = 6;
/// Height of the bar that marks contact over that of the graph, and the least width of one over that of the graph.
const BAR: f64 = 9.0 / 179.0;
const POINT: f64 = 8.0 / 358.0;

/// The ends of a cell.
fn ends<const D: usize>(mesh: &Mesh<D>, cell: usize) -> [f64; 2] {
    let cell = mesh.cell(cell);
    map_entries([0, 1], |k| mesh.vertices()[cell[k] as usize][0])
}

/// A curve over a cell in so many pieces, given by its value at a share of the length.
fn curve(
    [a, b]: [f64; 2],
    parts: usize,
    value: impl Fn(f64) -> f64,
) -> impl Iterator<Item = [PlanePoint; 2]> {
    let at = move |k: usize| {
        let share = k as f64 / parts as f64;
        [a + (b - a) * share, value(share)]
    };
    (0..parts).map(move |k| [at(k), at(k + 1)])
}

/// The panel.
pub(crate) fn solution<const D: usize>(
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    fields: &Fields,
) -> Panel {
    let mut obstacles = Vec::new();
    // a problem that was solved on the mesh has its data there
    if let Ok(data) = DataOnMesh::new(problem, mesh) {
        for obstacle in [&data.lower, &data.upper] {
            for cell in 0..mesh.n_cells() {
                let [a, b] = ends(mesh, cell);
                let Some(psi) = obstacle.of(mesh.region(cell)) else { continue };
                let value = |share| psi.in_cell(mesh, cell, &Point::repeat(a + (b - a) * share));
                obstacles.extend(curve([a, b], PARTS, value));
            }
        }
    }
    let parts = if fields.midpoints.is_empty() { 1 } else { PARTS };
    let mut solution = Vec::new();
    for cell in 0..mesh.n_cells() {
        let [a, b] = map_entries([0, 1], |k| fields.u[2 * cell + k]);
        let middle = fields.midpoints.get(cell).copied().unwrap_or(0.5 * (a + b));
        let value = |t: f64| {
            a * (1.0 - t) * (1.0 - 2.0 * t) + b * t * (2.0 * t - 1.0) + 4.0 * middle * t * (1.0 - t)
        };
        solution.extend(curve(ends(mesh, cell), parts, value));
    }
    for lines in [&mut obstacles, &mut solution] {
        lines.retain(|line| line.iter().all(|point| point[1].is_finite()));
    }
    let mut panel = Panel::around("solution", obstacles.iter().chain(&solution).flatten().copied());
    (panel.is_graph, panel.axes) = (true, ["x", "u"]);
    for k in 0..2 {
        if panel.low[k] > panel.high[k] {
            (panel.low[k], panel.high[k]) = (0.0, 1.0);
        }
    }
    let height = panel.high[1] - panel.low[1];
    let room = if height > 0.0 { 0.08 * height } else { 0.5 * panel.high[1].abs().max(1e-300) };
    panel.low[1] -= 1.5 * room;
    panel.high[1] += room;
    panel.add_lines(Stroke::OBSTACLE, obstacles, "obstacle");
    panel.add_lines(Stroke::solution(), solution, "u");
    mark_contact(&mut panel, mesh, fields);
    let exact = problem.exact.as_ref().and_then(|exact| exact.contact.as_ref());
    let marks = exact.iter().flat_map(|set| &set.free_boundary).map(|x| [x[0], panel.low[1]]);
    let marks = marks.collect();
    panel.add_marks(marks);
    panel
}

/// Bars at the lower edge below cells and points in contact.
fn mark_contact<const D: usize>(panel: &mut Panel, mesh: &Mesh<D>, fields: &Fields) {
    let found = &fields.discrete_contact;
    let points = found.facets.iter().map(|&(cell, local)| [ends(mesh, cell)[1 - local]; 2]);
    let (low, high) = (panel.low, panel.high);
    let (bottom, top) = (low[1], low[1] + BAR * (high[1] - low[1]));
    for [a, b] in found.cells.iter().map(|&cell| ends(mesh, cell)).chain(points) {
        let missing = (POINT * (high[0] - low[0]) - (b - a).abs()).max(0.0);
        let (a, b) = (a.min(b) - 0.5 * missing, a.max(b) + 0.5 * missing);
        panel.fills.push((CONTACT, vec![[a, bottom], [b, bottom], [b, top], [a, top]]));
    }
    if !panel.fills.is_empty() {
        panel.legend.push((Symbol::Area(CONTACT), "in contact"));
    }
}
