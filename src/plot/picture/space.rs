//! The panels of a picture of a domain in space: its surface and the contact set, seen from outside in a parallel
//! projection, and the contact boundary seen flat.

use super::axes::{CONTACT, Stroke, Symbol};
use super::bands::bands;
use super::colour::Scale;
use super::edges::edges;
use super::level_line::{distance, level_line};
use super::map::Map;
use super::panel::Panel;
use super::plane::Plane;
use super::triangle::{PlanePoint, Triangle, View};
use crate::arrays::{array_of, map_entries};
use crate::measure::Fields;
use crate::mesh::{BoundaryCondition, HalfFacet, Mesh, Neighbour, Neighbours, cross};
use crate::plot::pen::Colour;
use crate::plot::style::INK;
use crate::problem::{ContactSet, Problem};
use crate::real::Point;

/// Where the viewer stands, unless that hides the contact boundary.
const TOWARDS_VIEWER: [f64; 3] = [0.5, -0.8, 0.45];
/// Facets whose normals have a smaller cosine than this meet at an edge that is drawn.
const SHARP: f64 = 0.8;
/// Points of a line of sight at which the exact contact set is looked for.
const POINTS: usize = 64;

/// An area, or a line of two points, with its distance towards the viewer.
type Shape = (f64, Colour, Vec<PlanePoint>);

/// A facet of a surface.
struct Facet<const D: usize> {
    triangle: Triangle,
    normal: Point<D>,
    middle: Point<D>,
    depth: f64,
}

/// The axis along which most of the contact boundary faces, and the sign of its outward normal there; none without one.
fn facing<const D: usize>(mesh: &Mesh<D>, facets: &[HalfFacet]) -> Option<(usize, f64)> {
    let area = |&(axis, sign): &(usize, f64)| -> f64 {
        let faces = |&(cell, local): &HalfFacet| {
            let geometry = mesh.geometry(cell);
            (sign * geometry.normal(local)[axis]).max(0.0) * geometry.facet_measure(local)
        };
        facets.iter().map(faces).sum()
    };
    let directions = (0..D).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]);
    directions.filter(|_| !facets.is_empty()).max_by(|a, b| area(a).total_cmp(&area(b)))
}

/// The data of the panels.
pub(crate) struct Space<'a, const D: usize> {
    problem: &'a Problem<D>,
    view: View<'a, D>,
    neighbours: Neighbours,
    towards_viewer: Point<D>,
    /// Where the contact boundary faces.
    facing: Option<(usize, f64)>,
    /// The surface of the domain.
    surface: Vec<Facet<D>>,
}

impl<'a, const D: usize> Space<'a, D> {
    pub fn new(problem: &'a Problem<D>, mesh: &'a Mesh<D>, fields: &'a Fields) -> Self {
        let facing = facing(mesh, &fields.contact_boundary);
        let mut towards = TOWARDS_VIEWER;
        // without a contact boundary nothing is hidden
        let (axis, sign) = facing.unwrap_or((0, TOWARDS_VIEWER[0]));
        let is_hidden = sign * towards[axis] < 0.0;
        let mut turn = 1.0;
        if is_hidden && axis == 2 {
            // the lower side is turned up: a box seen from below looks like a room seen from above
            (towards, turn) = (towards.map(|x| -x), -1.0);
        } else if is_hidden {
            towards[axis] = -towards[axis];
        }
        let right = [-turn * towards[1], turn * towards[0], 0.0];
        let vector = |entries: [f64; 3]| Point::<D>::from_fn(|k, _| entries[k]).normalize();
        let axes = [vector(right), vector(cross(towards, right))];
        let view = View { mesh, fields, axes };
        let mut space = Space {
            problem,
            neighbours: Neighbours::new(mesh),
            view,
            towards_viewer: vector(towards),
            facing,
            surface: Vec::new(),
        };
        space.surface = space.surface_of(&|_| true);
        space
    }

    /// All panels that are not empty.
    pub fn panels(&self) -> Vec<Panel> {
        let mut panels = Vec::new();
        let mesh = self.view.mesh;
        let is_free = mesh.boundary().iter().any(|f| f.condition != BoundaryCondition::Dirichlet);
        if is_free || !self.problem.has_obstacle() {
            panels.push(Panel::Map(self.solution()));
        }
        if self.problem.has_obstacle() {
            panels.push(Panel::Map(self.contact()));
        }
        if let Some(facing) = self.facing.filter(|_| self.problem.acts_on_boundary()) {
            let (problem, fields) = (self.problem, self.view.fields);
            let plane = Plane::of_contact_boundary(problem, mesh, fields, facing);
            panels.push(Panel::Map(plane.contact()));
        }
        panels
    }

    /// The surface of a set of cells.
    fn surface_of(&self, contains: &dyn Fn(usize) -> bool) -> Vec<Facet<D>> {
        let halves =
            (0..self.view.mesh.n_cells()).flat_map(|c| (0..=D).map(move |local| (c, local)));
        let is_outer = |&(cell, local): &HalfFacet| {
            let across = self.neighbours.across(cell, local);
            let is_inside =
                matches!(across, Neighbour::Cell { cell, .. } if contains(cell as usize));
            contains(cell) && !is_inside
        };
        let facet = |(cell, local): HalfFacet| {
            let middle = self.view.mesh.facet_barycentre(cell, local);
            Facet {
                triangle: self.view.facet(cell, local),
                normal: self.view.mesh.geometry(cell).normal(local),
                middle,
                depth: middle.dot(&self.towards_viewer),
            }
        };
        halves.filter(is_outer).map(facet).collect()
    }

    fn is_seen(&self, facet: &Facet<D>) -> bool {
        facet.normal.dot(&self.towards_viewer) > 0.0
    }

    /// Whether no facet of the surface lies before the plane of one that is seen.
    fn is_convex(&self) -> bool {
        let rounding = 1e-9 * self.view.mesh.domain_diameter();
        let mut seen = self.surface.iter().filter(|facet| self.is_seen(facet));
        seen.all(|a| {
            let height = |b: &Facet<D>| a.normal.dot(&(b.middle - a.middle));
            self.surface.iter().all(|b| height(b) <= rounding)
        })
    }

    /// A map with these shapes and the edges of the domain, painted from back to front.
    fn map(&self, title: &str, mut shapes: Vec<Shape>) -> Map {
        shapes.extend(self.outline());
        shapes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let corners = self.surface.iter().flat_map(|facet| facet.triangle.corners);
        let unit = |axis: usize| map_entries([0, 1], |k| self.view.axes[k][axis]);
        Map {
            directions: Some(array_of(unit)),
            fills: shapes.into_iter().map(|(_, colour, corners)| (colour, corners)).collect(),
            ..Map::around(title, corners.map(|corner| corner.at))
        }
    }

    /// The edges of the domain and of its silhouette that are seen.
    fn outline(&self) -> Vec<Shape> {
        let triangles: Vec<Triangle> = self.surface.iter().map(|facet| facet.triangle).collect();
        let mut shapes = Vec::new();
        for edge in edges(self.view.mesh, &triangles) {
            let sides = || edge.sides.iter().map(|&side| &self.surface[side]);
            let seen = sides().filter(|facet| self.is_seen(facet));
            let is_flat = sides().is_sorted_by(|a, b| a.normal.dot(&b.normal) > SHARP);
            let n_seen = seen.clone().count();
            let Some(depth) = seen.map(|facet| facet.depth).reduce(f64::max) else { continue };
            if n_seen == 1 || !is_flat {
                shapes.push((depth, INK, self.view.places(edge.vertices).to_vec()));
            }
        }
        shapes
    }

    /// The solution on the surface of the domain.
    fn solution(&self) -> Map {
        let seen = || self.surface.iter().filter(|facet| self.is_seen(facet));
        let pieces = |facet: &Facet<D>| self.view.linear_pieces(&facet.triangle);
        let values = seen().flat_map(pieces).flatten().map(|corner| corner.1);
        let Some(scale) = Scale::linear("u", values) else {
            return self.map("solution on the surface", Vec::new());
        };
        // facets of a convex domain hide nothing: those of a colour together keep files short
        let is_convex = self.is_convex();
        let depth = |facet: &Facet<D>| if is_convex { f64::NEG_INFINITY } else { facet.depth };
        let mut areas = Vec::new();
        for facet in seen() {
            let of_facet = pieces(facet).into_iter().flat_map(|piece| bands(&scale, &piece));
            areas.extend(of_facet.map(|(band, area)| (band, depth(facet), area)));
        }
        areas.sort_by_key(|area| area.0);
        let shape = |(band, depth, area)| (depth, scale.colour(band), area);
        let shapes = areas.into_iter().map(shape).collect();
        Map { scale: Some(scale), ..self.map("solution on the surface", shapes) }
    }

    /// The surface of the cells in contact, within the edges of the domain.
    fn contact(&self) -> Map {
        let mut touches = vec![false; self.view.mesh.n_cells()];
        let found = &self.view.fields.discrete_contact.cells;
        found.iter().for_each(|&cell| touches[cell] = true);
        let surface = self.surface_of(&|cell| touches[cell]);
        let seen = surface.iter().filter(|facet| self.is_seen(facet));
        let shape = |f: &Facet<D>| (f.depth, self.lit(&f.normal), f.triangle.places());
        let mut map = self.map("contact set", seen.map(shape).collect());
        if surface.is_empty() {
            map.note = Some("no cell is in contact");
            return map;
        }
        map.legend.push((Symbol::Area(CONTACT), "in contact".to_owned()));
        if let Some(set) = self.problem.exact.as_ref().and_then(|e| e.contact.as_ref()) {
            let outline = self.outline_of(set, distance(map.low, map.high));
            if !outline.is_empty() {
                let text = "outline of the exact set".to_owned();
                map.legend.push((Symbol::Line(Stroke::Exact), text));
            }
            map.lines.extend(outline.into_iter().map(|ends| (Stroke::Exact, ends)));
        }
        map
    }

    /// The colour of a contact facet under a light from above at the left.
    fn lit(&self, normal: &Point<D>) -> Colour {
        let [right, up] = self.view.axes;
        let light = (self.towards_viewer + up * 0.9 - right * 0.5).normalize();
        let share = 0.6 + 0.45 * normal.dot(&light).max(0.0);
        let channel = |c: u8| (f64::from(c) * share).min(255.0).round() as u8;
        Colour(channel(CONTACT.0), channel(CONTACT.1), channel(CONTACT.2))
    }

    /// The outline of the exact contact set: where lines of sight touch it.
    fn outline_of(&self, set: &ContactSet<D>, size: f64) -> Vec<[PlanePoint; 2]> {
        let step = self.view.mesh.domain_diameter() / POINTS as f64;
        let meets = |cell: usize, barycentric: &[f64; 4]| {
            let x = self.view.mesh.point(cell, barycentric);
            let behind = |k: usize| x - self.towards_viewer * (k as f64 * step);
            (0..POINTS).any(|k| (set.indicator)(&behind(k)) > 0.0)
        };
        let seen = self.surface.iter().filter(|facet| self.is_seen(facet));
        level_line(seen.map(|facet| &facet.triangle), size, &meets)
    }
}
