//! The panels of a picture of a domain in the plane, and of a contact boundary in space, which is seen flat.

use std::collections::BTreeSet;

use super::axes::{CONTACT, Stroke, Symbol};
use super::bands::shade;
use super::edges::{Edge, edges};
use super::level_line::{distance, level_line};
use super::map::Map;
use super::panel::Panel;
use super::trace;
use super::triangle::{PlanePoint, Triangle, View};
use crate::measure::Fields;
use crate::mesh::{HalfFacet, Mesh};
use crate::plot::style::INK;
use crate::problem::{ContactSet, Problem};

/// Most triangles whose edges are drawn.
const MOST_EDGES: usize = 1500;

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
        let edges = edges(mesh, &triangles);
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
        let edges = edges(mesh, &triangles);
        Plane { problem, axes, edges, view, triangles, touches, is_partial }
    }

    /// The panels of a domain in the plane.
    pub fn panels(&self) -> Vec<Panel> {
        let contact = self.problem.is_constrained().then(|| self.contact());
        [self.solution()].into_iter().chain(contact).map(Panel::Map).collect()
    }

    fn map(&self, title: &str) -> Map {
        let places = self.triangles.iter().flat_map(|t| t.corners).map(|corner| corner.at);
        Map { axes: self.axes.map(|k| ["x", "y", "z"][k]), ..Map::around(title, places) }
    }

    fn ends(&self, edge: &Edge) -> [PlanePoint; 2] {
        self.view.places(edge.vertices)
    }

    /// Edges with a triangle on one side only.
    fn rim(&self) -> impl Iterator<Item = (Stroke, [PlanePoint; 2])> {
        let outer = self.edges.iter().filter(|e| e.sides.len() == 1);
        outer.map(|e| (Stroke::Coloured(INK, 0.8), self.ends(e)))
    }

    fn solution(&self) -> Map {
        let pieces = self.triangles.iter().flat_map(|t| self.view.linear_pieces(t));
        let mut map = self.map("solution");
        shade(&mut map, "u", &pieces.collect::<Vec<_>>());
        map.lines.extend(self.rim());
        map
    }

    /// The contact set, with the free boundary.
    pub fn contact(&self) -> Map {
        let mut map = self.map(match self.is_partial {
            true => "contact set (one side)",
            false => "contact set",
        });
        let touching = self.triangles.iter().zip(&self.touches).filter(|(_, touches)| **touches);
        map.fills.extend(touching.map(|(triangle, _)| (CONTACT, triangle.places())));
        if self.triangles.len() <= MOST_EDGES {
            map.lines.extend(self.edges.iter().map(|e| (Stroke::Mesh, self.ends(e))));
        }
        map.lines.extend(self.rim());
        let before = map.lines.len();
        if D == 2 {
            let facets = self.view.fields.discrete_contact.facets.iter();
            map.lines.extend(facets.map(|&facet| (Stroke::Touching, self.facet_ends(facet))));
        }
        let of_contact = match map.lines.len() == before {
            true => Symbol::Area(CONTACT),
            false => Symbol::Line(Stroke::Touching),
        };
        map.legend.push((of_contact, "in contact".to_owned()));
        let found = self.edges.iter().filter(|e| self.separates_contact(e));
        let before = map.lines.len();
        map.lines.extend(found.map(|e| (Stroke::Discrete, self.ends(e))));
        if map.lines.len() > before {
            map.legend.push((Symbol::Line(Stroke::Discrete), "free boundary, found".to_owned()));
        }
        if let Some(set) = self.problem.exact.as_ref().and_then(|e| e.contact.as_ref()) {
            self.add_exact(set, &mut map);
        }
        map
    }

    /// Whether an edge separates triangles in contact from others.
    fn separates_contact(&self, edge: &Edge) -> bool {
        let any = |touches: bool| edge.sides.iter().any(|&side| self.touches[side] == touches);
        any(true) && any(false)
    }

    /// The ends of a facet in the plane.
    fn facet_ends(&self, facet: HalfFacet) -> [PlanePoint; 2] {
        self.view.places(trace::ends(self.view.mesh, facet))
    }

    fn add_exact(&self, set: &ContactSet<D>, map: &mut Map) {
        let inside = |x: &_| (set.indicator)(x) > 0.0;
        if D == 3 || self.problem.has_obstacle() {
            let at = |cell: usize, b: &[f64; 4]| inside(&self.view.mesh.point(cell, b));
            let size = distance(map.low, map.high);
            let mut line = level_line(&self.triangles, size, &at);
            if line.is_empty() && D == 2 {
                // a set without inner points
                let points: Vec<PlanePoint> =
                    set.free_boundary.iter().map(|x| [x[0], x[1]]).collect();
                let near = |pair: &&[PlanePoint]| distance(pair[0], pair[1]) < 0.02 * size;
                line = points.windows(2).filter(near).map(|pair| [pair[0], pair[1]]).collect();
                if line.is_empty() {
                    map.marks = points;
                }
            }
            map.lines.extend(line.iter().map(|&ends| (Stroke::Exact, ends)));
            if !line.is_empty() {
                let exact = "free boundary, exact".to_owned();
                map.legend.push((Symbol::Line(Stroke::Exact), exact));
            }
        } else {
            let exact = trace::samples(self.view.mesh, &self.view.fields.contact_boundary)
                .into_iter()
                .filter(|s| inside(&(0.5 * (s[0] + s[1]))));
            let before = map.lines.len();
            map.lines.extend(exact.map(|s| (Stroke::Exact, s.map(|x| [x[0], x[1]]))));
            if map.lines.len() > before {
                map.legend.push((Symbol::Line(Stroke::Exact), "exact contact".to_owned()));
            }
            map.marks = set.free_boundary.iter().map(|x| [x[0], x[1]]).collect();
        }
        if !map.marks.is_empty() {
            map.legend.push((Symbol::Mark, "free boundary, exact".to_owned()));
        }
    }
}
