//! The panels of a picture of a domain in space: facets painted from back to front, with the third axis upwards, and the
//! contact side seen flat.

use super::axes::{CONTACT, Stroke, Symbol};
use super::bands::bands;
use super::colour::Scale;
use super::panel::Panel;
use super::plane::{Plane, edges};
use super::triangle::{PlanePoint, Triangle, View};
use crate::arrays::{array_of, map_entries};
use crate::measure::Fields;
use crate::mesh::{BoundaryCondition, HalfFacet, Mesh, Neighbour, Neighbours, cross};
use crate::plot::pen::Colour;
use crate::problem::Problem;
use crate::real::Point;

/// Where the viewer stands, unless that hides the contact boundary.
const TOWARDS_VIEWER: [f64; 3] = [0.5, -0.8, 0.45];
/// Facets whose normals have a smaller cosine than this meet at an edge that is drawn.
const SHARP: f64 = 0.8;
/// The sides of a domain behind what is in contact.
const BEHIND: Colour = Colour(225, 225, 225);

/// A facet of a surface.
struct Facet<const D: usize> {
    triangle: Triangle,
    normal: Point<D>,
    /// The distance of its middle towards the viewer.
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

/// The panels of a domain in space.
pub(crate) fn panels<const D: usize>(
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    fields: &Fields,
) -> Vec<Panel> {
    let facing = facing(mesh, &fields.contact_boundary);
    let mut towards = TOWARDS_VIEWER;
    if let Some((axis, sign)) = facing {
        towards[axis] = sign * towards[axis].abs();
    }
    let right = [-towards[1], towards[0], 0.0];
    let vector = |entries: [f64; 3]| Point::<D>::from_fn(|k, _| entries[k]).normalize();
    let axes = [vector(right), vector(cross(towards, right))];
    let view = View { mesh, fields, axes };
    let space = Space { view, neighbours: Neighbours::new(mesh), towards_viewer: vector(towards) };
    let mut panels = Vec::new();
    let is_free = mesh.boundary().iter().any(|f| f.condition != BoundaryCondition::Dirichlet);
    if is_free || !problem.has_obstacle() {
        panels.push(space.solution());
    }
    if problem.has_obstacle() {
        panels.push(space.contact());
    }
    if let Some(facing) = facing.filter(|_| problem.acts_on_boundary()) {
        panels.push(Plane::of_contact_boundary(problem, mesh, fields, facing).contact());
    }
    panels
}

/// A domain in space and where it is seen from.
struct Space<'a, const D: usize> {
    view: View<'a, D>,
    neighbours: Neighbours,
    towards_viewer: Point<D>,
}

impl<const D: usize> Space<'_, D> {
    /// The surface of a set of cells, from back to front.
    fn surface(&self, contains: &dyn Fn(usize) -> bool) -> Vec<Facet<D>> {
        let mesh = self.view.mesh;
        let halves = (0..mesh.n_cells()).flat_map(|c| (0..=D).map(move |local| (c, local)));
        let is_outer = |&(cell, local): &HalfFacet| {
            let across = self.neighbours.across(cell, local);
            let is_inside =
                matches!(across, Neighbour::Cell { cell, .. } if contains(cell as usize));
            contains(cell) && !is_inside
        };
        let facet = |(cell, local): HalfFacet| Facet {
            triangle: self.view.facet(cell, local),
            normal: mesh.geometry(cell).normal(local),
            depth: mesh.facet_barycentre(cell, local).dot(&self.towards_viewer),
        };
        let mut surface: Vec<Facet<D>> = halves.filter(is_outer).map(facet).collect();
        surface.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        surface
    }

    fn is_seen(&self, facet: &Facet<D>) -> bool {
        facet.normal.dot(&self.towards_viewer) > 0.0
    }

    /// A panel around the surface of the domain.
    fn panel(&self, title: &'static str, surface: &[Facet<D>]) -> Panel {
        let corners = surface.iter().flat_map(|facet| facet.triangle.corners);
        let unit = |axis: usize| map_entries([0, 1], |k| self.view.axes[k][axis]);
        let directions = Some(array_of(unit));
        Panel { directions, ..Panel::around(title, corners.map(|corner| corner.at)) }
    }

    /// The solution on the surface of the domain.
    fn solution(&self) -> Panel {
        let surface = self.surface(&|_| true);
        let mut panel = self.panel("solution on the surface", &surface);
        let seen = surface.iter().filter(|facet| self.is_seen(facet));
        let pieces: Vec<_> =
            seen.flat_map(|facet| self.view.linear_pieces(&facet.triangle)).collect();
        panel.scale = Scale::over(pieces.as_flattened().iter().map(|corner| corner.1));
        if let Some(scale) = &panel.scale {
            let areas = pieces.iter().flat_map(|piece| bands(scale, piece));
            panel.fills = areas.map(|(band, area)| (scale.colour(band), area)).collect();
        }
        panel.lines = self.outline(&surface);
        panel
    }

    /// The surface of the cells in contact, before the sides of the domain behind them.
    fn contact(&self) -> Panel {
        let mut touches = vec![false; self.view.mesh.n_cells()];
        let found = &self.view.fields.discrete_contact.cells;
        found.iter().for_each(|&cell| touches[cell] = true);
        let walls = self.surface(&|_| true);
        let title = if found.is_empty() { "no cell is in contact" } else { "contact set" };
        let mut panel = self.panel(title, &walls);
        let behind = walls.iter().filter(|facet| !self.is_seen(facet));
        panel.fills.extend(behind.map(|f| (self.lit(BEHIND, &-f.normal), f.triangle.places())));
        let surface = self.surface(&|cell| touches[cell]);
        let seen = surface.iter().filter(|facet| self.is_seen(facet));
        panel.fills.extend(seen.map(|f| (self.lit(CONTACT, &f.normal), f.triangle.places())));
        panel.legend.push((Symbol::Area(CONTACT), "in contact"));
        panel
    }

    /// The edges at which seen facets meet others in an angle.
    fn outline(&self, surface: &[Facet<D>]) -> Vec<(Stroke, [PlanePoint; 2])> {
        let mut edges = edges(self.view.mesh, surface.iter().map(|facet| facet.triangle));
        edges.retain(|edge| {
            let sides = || edge.sides.iter().map(|&side| &surface[side]);
            let is_flat = sides().is_sorted_by(|a, b| a.normal.dot(&b.normal) > SHARP);
            !is_flat && sides().any(|facet| self.is_seen(facet))
        });
        edges.iter().map(|edge| (Stroke::RIM, self.view.places(edge.vertices))).collect()
    }

    /// A colour on a side with this normal under a light from above at the left.
    fn lit(&self, colour: Colour, normal: &Point<D>) -> Colour {
        let [right, up] = self.view.axes;
        let light = (self.towards_viewer + up * 0.9 - right * 0.5).normalize();
        let share = 0.6 + 0.45 * normal.dot(&light).max(0.0);
        let channel = |c: u8| (f64::from(c) * share).min(255.0).round() as u8;
        Colour(channel(colour.0), channel(colour.1), channel(colour.2))
    }
}
