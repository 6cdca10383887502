//! The panels of a picture of a domain in the plane, and of a contact boundary in space, which is seen flat.

use std::collections::BTreeSet;

use super::axes::{CONTACT, FAINT, Stroke, Symbol};
use super::bands::shade;
use super::colour::Scale;
use super::edges::{Edge, edges, mean_jump};
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
/// Jumps below this many roundings of the largest value are none.
const ROUNDINGS: f64 = 256.0;

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
        let all = trace::facets(mesh);
        let facets: Vec<HalfFacet> = all.iter().copied().filter(faces).collect();
        let is_partial = facets.len() < all.len();
        let triangles: Vec<Triangle> = facets.iter().map(|&(c, k)| view.facet(c, k)).collect();
        let touching: BTreeSet<&HalfFacet> = fields.discrete_contact.facets.iter().collect();
        let touches = facets.iter().map(|facet| touching.contains(facet)).collect();
        let edges = edges(mesh, &triangles);
        Plane { problem, axes, edges, view, triangles, touches, is_partial }
    }

    /// All panels of a domain in the plane that are not empty.
    pub fn panels(&self) -> Vec<Panel> {
        let mut panels = vec![Panel::Map(self.solution())];
        if self.problem.is_constrained() {
            panels.push(Panel::Map(self.contact()));
        }
        panels.push(Panel::Map(self.jumps()));
        panels.extend(self.multiplier());
        if !self.view.fields.bound.is_empty() {
            panels.push(Panel::Map(self.bound()));
        }
        panels
    }

    /// The panels of a contact boundary.
    pub fn panels_of_contact(&self) -> Vec<Panel> {
        [Panel::Map(self.contact())].into_iter().chain(self.multiplier()).collect()
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
        shade(&mut map, "u", &pieces.collect::<Vec<_>>(), true);
        map.lines.extend(self.rim());
        map
    }

    fn contact(&self) -> Map {
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
            let exact = trace::samples(self.view.mesh)
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

    fn jumps(&self) -> Map {
        let mut map = self.map("jumps across facets");
        let largest = self.view.fields.u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
        let floor = ROUNDINGS * f64::EPSILON * largest;
        let jumps: Vec<(f64, [PlanePoint; 2])> = self
            .edges
            .iter()
            .filter_map(|e| Some((mean_jump(&self.view, &self.triangles, e)?, self.ends(e))))
            .collect();
        map.scale = Scale::logarithmic("|mean jump|", jumps.iter().map(|j| j.0), floor);
        let none = jumps.iter().filter(|j| j.0 <= floor);
        if self.triangles.len() <= MOST_EDGES {
            map.lines.extend(none.map(|j| (Stroke::Coloured(FAINT, 0.5), j.1)));
        }
        match &map.scale {
            None => map.note = Some("none beyond rounding"),
            Some(scale) => {
                let mean = jumps.iter().map(|j| distance(j.1[0], j.1[1])).sum::<f64>()
                    / jumps.len().max(1) as f64;
                let on_paper = 200.0 * mean / (map.high[0] - map.low[0]);
                let width = (0.35 * on_paper).clamp(0.6, 3.0);
                let mut coloured: Vec<(usize, [PlanePoint; 2])> =
                    jumps.iter().filter(|j| j.0 > floor).map(|j| (scale.band(j.0), j.1)).collect();
                coloured.sort_by_key(|line| line.0);
                let stroke = |band| Stroke::Coloured(scale.colour(band), width);
                map.lines.extend(coloured.into_iter().map(|(band, ends)| (stroke(band), ends)));
            }
        }
        map.lines.extend(self.rim());
        map
    }

    /// The density of the multiplier; none where it is not known.
    fn multiplier(&self) -> Option<Panel> {
        if self.view.fields.discrete_contact.density.is_empty() {
            return None;
        }
        if !self.problem.has_obstacle() && D == 2 {
            let graph = trace::graph(self.problem, self.view.mesh, self.view.fields);
            return Some(match graph {
                Some(graph) => Panel::Graph(graph),
                None => Panel::Map(self.multiplier_on_facets()),
            });
        }
        let mut map = self.map("multiplier");
        let with_touches = self.triangles.iter().zip(&self.touches);
        let valued = with_touches.filter_map(|(t, touches)| self.view.density(t, *touches));
        let valued: Vec<_> = valued.collect();
        shade(&mut map, "density of the multiplier", &valued, false);
        if map.scale.is_none() {
            map.note = Some("none known");
        } else if valued.len() < self.triangles.len() {
            map.title += " (white: none known)";
        }
        map.lines.extend(self.rim());
        Some(Panel::Map(map))
    }

    /// The share of each cell in the square of the error bound.
    fn bound(&self) -> Map {
        let mut map = self.map("share in the error bound");
        let share = |triangle: &Triangle| self.view.fields.bound[triangle.cell];
        let shares = self.triangles.iter().map(share);
        map.scale = Scale::logarithmic("share in the square of the bound", shares, 0.0);
        if let Some(scale) = &map.scale {
            // those of a colour together, which keeps files short
            let with_band = |t: &Triangle| (scale.band(share(t)), t.places());
            let mut fills: Vec<_> = self.triangles.iter().map(with_band).collect();
            fills.sort_by_key(|fill| fill.0);
            map.fills.extend(fills.into_iter().map(|(band, area)| (scale.colour(band), area)));
        }
        map.lines.extend(self.rim());
        map
    }

    /// The multiplier on a contact boundary that is not straight.
    fn multiplier_on_facets(&self) -> Map {
        let mut map = self.map("multiplier");
        let density = &self.view.fields.discrete_contact.density;
        let mut facets = Vec::new();
        for facet in trace::facets(self.view.mesh) {
            let ends = self.view.mesh.facet_vertices(facet.0, facet.1);
            let values: Vec<f64> = ends.filter_map(|v| density[v as usize]).collect();
            if !values.is_empty() {
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                facets.push((mean, self.facet_ends(facet)));
            }
        }
        map.scale = Scale::linear("density of the multiplier", facets.iter().map(|f| f.0));
        map.lines.extend(self.rim());
        if let Some(scale) = &map.scale {
            let coloured = |f: &(f64, [PlanePoint; 2])| {
                (Stroke::Coloured(scale.colour(scale.band(f.0)), 6.0), f.1)
            };
            map.lines.extend(facets.iter().map(coloured));
        }
        map
    }
}
