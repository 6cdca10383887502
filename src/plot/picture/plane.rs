//! The panels of a picture of a domain in the plane, and of a contact boundary in space, which is seen flat.

use std::collections::{BTreeMap, BTreeSet};

use super::axes::{CONTACT, Stroke, Symbol};
use super::bands::shade;
use super::level_line::{distance, level_line};
use super::panel::Panel;
use super::triangle::{PlanePoint, Triangle, View};
use crate::arrays::{array_of, map_entries};
use crate::measure::Fields;
use crate::mesh::{HalfFacet, Mesh};
use crate::problem::{ContactSet, Problem};

/// Most triangles whose edges are drawn.
const MOST_EDGES: usize = 1500;
/// Pieces of a facet at which exact data are looked at.
const PARTS: usize = 8;

/// An edge, and the triangles beside it by their numbers.
pub(crate) struct Edge {
    pub vertices: [u32; 2],
    pub sides: Vec<usize>,
}

/// All edges of triangles, each once.
pub(crate) fn edges<const D: usize>(
    mesh: &Mesh<D>,
    triangles: impl Iterator<Item = Triangle>,
) -> Vec<Edge> {
    let mut known: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (k, triangle) in triangles.enumerate() {
        let [a, b, c] = triangle.locals.map(|local| mesh.cell(triangle.cell)[local]);
        for vertices in [[a, b], [a, c], [b, c]] {
            known.entry(vertices).or_default().push(k);
        }
    }
    known.into_iter().map(|(vertices, sides)| Edge { vertices, sides }).collect()
}

/// The data of the panels.
pub(crate) struct Plane<'a, const D: usize> {
    problem: &'a Problem<D>,
    view: View<'a, D>,
    axes: [usize; 2],
    triangles: Vec<Triangle>,
    edges: Vec<Edge>,
    /// Whether each triangle is in contact.
    touches: Vec<bool>,
    /// Whether the contact boundary has facets that face elsewhere.
    is_partial: bool,
}

impl<'a, const D: usize> Plane<'a, D> {
    /// A domain in the plane.
    pub fn of_cells(problem: &'a Problem<D>, mesh: &'a Mesh<D>, fields: &'a Fields) -> Self {
        let axes = [0, 1];
        let view = View::along_coordinates(mesh, fields, axes);
        let triangles: Vec<Triangle> = (0..mesh.n_cells()).map(|cell| view.cell(cell)).collect();
        let mut touches = vec![false; mesh.n_cells()];
        fields.discrete_contact.cells.iter().for_each(|&cell| touches[cell] = true);
        let edges = edges(mesh, triangles.iter().copied());
        Plane { problem, axes, edges, view, triangles, touches, is_partial: false }
    }

    /// The facets of the contact boundary in space that face along a coordinate axis, up to half a right angle:
    /// forwards for a positive sign.
    pub fn of_contact_boundary(
        problem: &'a Problem<D>,
        mesh: &'a Mesh<D>,
        fields: &'a Fields,
        (axis, sign): (usize, f64),
    ) -> Self {
        let axes = [[1, 2], [0, 2], [0, 1]][axis];
        let view = View::along_coordinates(mesh, fields, axes);
        let faces =
            |&(cell, local): &HalfFacet| sign * mesh.geometry(cell).normal(local)[axis] > 0.7;
        let all = &fields.contact_boundary;
        let facets: Vec<HalfFacet> = all.iter().copied().filter(faces).collect();
        let is_partial = facets.len() < all.len();
        let triangles: Vec<Triangle> = facets.iter().map(|&(c, k)| view.facet(c, k)).collect();
        let touching: BTreeSet<&HalfFacet> = fields.discrete_contact.facets.iter().collect();
        let touches = facets.iter().map(|facet| touching.contains(facet)).collect();
        let edges = edges(mesh, triangles.iter().copied());
        Plane { problem, axes, edges, view, triangles, touches, is_partial }
    }

    /// The panels of a domain in the plane.
    pub fn panels(&self) -> Vec<Panel> {
        let contact = self.problem.is_constrained().then(|| self.contact());
        [self.solution()].into_iter().chain(contact).collect()
    }

    fn panel(&self, title: &'static str) -> Panel {
        let places = self.triangles.iter().flat_map(|t| t.corners).map(|corner| corner.at);
        Panel { axes: self.axes.map(|k| ["x", "y", "z"][k]), ..Panel::around(title, places) }
    }

    /// The lines along edges.
    fn lines(
        &self,
        stroke: Stroke,
        wanted: impl Fn(&Edge) -> bool,
    ) -> Vec<(Stroke, [PlanePoint; 2])> {
        let wanted = self.edges.iter().filter(|edge| wanted(edge));
        wanted.map(|edge| (stroke, self.view.places(edge.vertices))).collect()
    }

    /// Edges with a triangle on one side only.
    fn rim(&self) -> Vec<(Stroke, [PlanePoint; 2])> {
        self.lines(Stroke::RIM, |edge| edge.sides.len() == 1)
    }

    fn solution(&self) -> Panel {
        let pieces = self.triangles.iter().flat_map(|t| self.view.linear_pieces(t));
        let mut panel = self.panel("solution");
        shade(&mut panel, &pieces.collect::<Vec<_>>());
        panel.lines.extend(self.rim());
        panel
    }

    /// The contact set, with the free boundary.
    pub fn contact(&self) -> Panel {
        let mut panel = self.panel(match self.is_partial {
            true => "contact set (one side)",
            false => "contact set",
        });
        let touching = self.triangles.iter().zip(&self.touches).filter(|(_, touches)| **touches);
        panel.fills.extend(touching.map(|(triangle, _)| (CONTACT, triangle.places())));
        if self.triangles.len() <= MOST_EDGES {
            panel.lines.extend(self.lines(Stroke::MESH, |_| true));
        }
        panel.lines.extend(self.rim());
        let facets = self.view.fields.discrete_contact.facets.iter().filter(|_| D == 2);
        let touching = facets.map(|&facet| self.view.places(self.facet_ends(facet)));
        if !panel.add_lines(Stroke::TOUCHING, touching, "in contact") {
            panel.legend.push((Symbol::Area(CONTACT), "in contact"));
        }
        let separates = |edge: &Edge| {
            let any = |touches: bool| edge.sides.iter().any(|&side| self.touches[side] == touches);
            any(true) && any(false)
        };
        let found = self.lines(Stroke::FOUND, separates);
        panel.add_lines(
            Stroke::FOUND,
            found.into_iter().map(|line| line.1),
            "free boundary, found",
        );
        if let Some(set) = self.problem.exact.as_ref().and_then(|e| e.contact.as_ref()) {
            self.add_exact(set, &mut panel);
        }
        panel
    }

    /// The vertices of a facet in the plane.
    fn facet_ends(&self, (cell, local): HalfFacet) -> [u32; 2] {
        let mut vertices = self.view.mesh.facet_vertices(cell, local);
        array_of(|_| vertices.next().expect("a facet in the plane has two vertices"))
    }

    fn add_exact(&self, set: &ContactSet<D>, panel: &mut Panel) {
        let View { mesh, fields, .. } = self.view;
        if D == 3 || self.problem.has_obstacle() {
            let at = |cell: usize, b: &[f64; 4]| (set.indicator)(&mesh.point(cell, b));
            let line = level_line(&self.triangles, distance(panel.low, panel.high), &at);
            panel.add_lines(Stroke::EXACT, line, "free boundary, exact");
            return;
        }
        let mut touching = Vec::new();
        for &facet in &fields.contact_boundary {
            let [a, b] = map_entries(self.facet_ends(facet), |v| mesh.vertices()[v as usize]);
            let at = |k: usize| a + (b - a) * (k as f64 / PARTS as f64);
            let pieces = (0..PARTS).map(|k| [at(k), at(k + 1)]);
            let pieces = pieces.filter(|[from, to]| (set.indicator)(&(0.5 * (from + to))) > 0.0);
            touching.extend(pieces.map(|ends| ends.map(|x| self.view.place(&x))));
        }
        panel.add_lines(Stroke::EXACT, touching, "exact contact");
        panel.add_marks(set.free_boundary.iter().map(|x| self.view.place(x)).collect());
    }
}
