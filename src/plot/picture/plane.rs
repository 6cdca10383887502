//! The panels of a picture in the plane: a domain there, or a section of one in space.

use super::axes::{CONTACT, FAINT, Stroke, Symbol};
use super::bands::{band, contour};
use super::colour::Scale;
use super::edges::{Edge, edges, mean_jump};
use super::level_line::{distance, level_line};
use super::map::Map;
use super::panel::Panel;
use super::section::{PlanePoint, Section, Slice, View};
use super::trace;
use crate::measure::Fields;
use crate::mesh::{BoundaryCondition, Mesh};
use crate::plot::pen::PAPER;
use crate::plot::style::INK;
use crate::problem::{ContactSet, Problem};

/// Most cells whose edges are drawn.
const MOST_EDGES: usize = 1500;
/// Jumps below this many roundings of the largest value are none.
const ROUNDINGS: f64 = 256.0;
/// Levels from one contour line to the next.
const STRIDE: usize = 2;

/// The data of the panels.
pub(crate) struct Plane<'a, const D: usize> {
    problem: &'a Problem<D>,
    pub view: View<'a, D>,
    pub sections: Vec<Section>,
    edges: Vec<Edge>,
    /// Whether each cell, or in a slice along the contact boundary its facet there, is in contact.
    touches: Vec<bool>,
    low: PlanePoint,
    high: PlanePoint,
}

impl<'a, const D: usize> Plane<'a, D> {
    pub fn new(
        problem: &'a Problem<D>,
        mesh: &'a Mesh<D>,
        fields: &'a Fields,
        slice: Option<Slice>,
    ) -> Self {
        let view = View::new(mesh, fields, slice);
        let sections = view.sections();
        let mut touches = vec![false; mesh.n_cells()];
        fields.discrete_contact.cells.iter().for_each(|&cell| touches[cell] = true);
        for &(cell, local) in &fields.discrete_contact.facets {
            touches[cell] |= view.lies_in_slice(cell, local);
        }
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in sections.iter().flat_map(|s| &s.corners) {
            for k in 0..2 {
                low[k] = low[k].min(corner.at[k]);
                high[k] = high[k].max(corner.at[k]);
            }
        }
        let edges = edges(&sections);
        Plane { problem, edges, view, sections, touches, low, high }
    }

    /// All panels that are not empty.
    pub fn panels(&self) -> Vec<Panel> {
        let mut panels = vec![Panel::Map(self.solution())];
        if self.problem.is_constrained() {
            panels.push(Panel::Map(self.contact()));
        }
        panels.push(Panel::Map(self.jumps()));
        if self.problem.is_constrained() && !self.view.fields.discrete_contact.density.is_empty() {
            panels.push(self.multiplier());
        }
        if !self.view.fields.bound.is_empty() {
            panels.push(Panel::Map(self.bound()));
        }
        panels
    }

    /// Areas in contact.
    pub fn contact_area(&self) -> f64 {
        let touching = self.sections.iter().filter(|s| self.touches[s.cell]);
        touching.map(Section::area).sum()
    }

    fn size(&self) -> f64 {
        distance(self.low, self.high)
    }

    fn map(&self, title: &str) -> Map {
        let axes = self.view.axes.map(|k| ["x", "y", "z"][k]);
        Map { title: title.to_owned(), low: self.low, high: self.high, axes, ..Map::default() }
    }

    /// Edges with a cell on one side only.
    fn rim(&self) -> impl Iterator<Item = (Stroke, [PlanePoint; 2])> {
        let outer = self.edges.iter().filter(|e| e.sides.len() == 1);
        outer.map(|e| (Stroke::Coloured(INK, 0.8), e.ends))
    }

    fn solution(&self) -> Map {
        let view = &self.view;
        let value = |piece: &Section, k: usize| {
            let corner = &piece.corners[k];
            (corner.at, view.value(piece.cell, &corner.barycentric))
        };
        let triangles: Vec<_> =
            view.linear_pieces().iter().map(|p| [value(p, 0), value(p, 1), value(p, 2)]).collect();
        let mut map = self.map("solution");
        shade(&mut map, "u", &triangles, true);
        map.lines.extend(self.rim());
        map
    }

    fn contact(&self) -> Map {
        let mut map = self.map("contact set");
        let touching = self.sections.iter().filter(|s| self.touches[s.cell]);
        map.fills.extend(touching.map(|s| (CONTACT, s.corners.iter().map(|c| c.at).collect())));
        if self.sections.len() <= MOST_EDGES {
            map.lines.extend(self.edges.iter().map(|e| (Stroke::Mesh, e.ends)));
        }
        map.lines.extend(self.rim());
        let on_boundary = self.facets_seen();
        map.lines.extend(on_boundary.iter().map(|&(_, _, ends)| (Stroke::Touching, ends)));
        let of_contact = match on_boundary.is_empty() {
            true => Symbol::Area(CONTACT),
            false => Symbol::Line(Stroke::Touching),
        };
        map.legend.push((of_contact, "in contact".to_owned()));
        let found = self.edges.iter().filter(|e| self.separates_contact(e));
        let before = map.lines.len();
        map.lines.extend(found.map(|e| (Stroke::Discrete, e.ends)));
        if map.lines.len() > before {
            map.legend.push((Symbol::Line(Stroke::Discrete), "free boundary, found".to_owned()));
        }
        if let Some(set) = self.problem.exact.as_ref().and_then(|e| e.contact.as_ref()) {
            self.add_exact(set, &mut map);
        }
        map
    }

    /// Whether an edge separates cells in contact from cells that are not.
    fn separates_contact(&self, edge: &Edge) -> bool {
        let any = |touches: bool| edge.sides.iter().any(|s| self.touches[s.cell] == touches);
        any(true) && any(false)
    }

    /// Facets in contact that are seen as lines: cell, number in it, ends.
    fn facets_seen(&self) -> Vec<(usize, usize, [PlanePoint; 2])> {
        let facets = self.view.fields.discrete_contact.facets.iter();
        let outside = facets.filter(|&&(cell, local)| !self.view.lies_in_slice(cell, local));
        outside.filter_map(|&(c, l)| self.view.facet(c, l).map(|ends| (c, l, ends))).collect()
    }

    fn add_exact(&self, set: &ContactSet<D>, map: &mut Map) {
        let is_boundary = !self.problem.has_obstacle();
        let inside = |x: &_| (set.indicator)(x) > 0.0;
        if !is_boundary || self.is_along_contact() {
            let at = |cell: usize, b: &[f64; 4]| inside(&self.view.point(cell, b));
            let mut line = level_line(&self.sections, self.size(), &at);
            if line.is_empty() && D == 2 {
                // a set without inner points
                let points: Vec<PlanePoint> =
                    set.free_boundary.iter().map(|x| [x[0], x[1]]).collect();
                let near = |pair: &&[PlanePoint]| distance(pair[0], pair[1]) < 0.02 * self.size();
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
        } else if D == 2 {
            let exact = trace::samples(self.view.mesh)
                .into_iter()
                .filter(|s| inside(&(0.5 * (s.ends[0] + s.ends[1]))));
            let before = map.lines.len();
            map.lines.extend(exact.map(|s| (Stroke::Exact, s.ends.map(|x| [x[0], x[1]]))));
            if map.lines.len() > before {
                map.legend.push((Symbol::Line(Stroke::Exact), "exact contact".to_owned()));
            }
            map.marks = set.free_boundary.iter().map(|x| [x[0], x[1]]).collect();
        }
        if !map.marks.is_empty() {
            map.legend.push((Symbol::Mark, "free boundary, exact".to_owned()));
        }
    }

    /// Whether the slice runs along the contact boundary.
    fn is_along_contact(&self) -> bool {
        let contact = self.view.mesh.boundary().iter();
        let mut contact = contact.filter(|f| f.condition == BoundaryCondition::Contact);
        contact.any(|f| self.view.lies_in_slice(f.cell as usize, usize::from(f.local)))
    }

    fn jumps(&self) -> Map {
        let title = if D == 3 { "jumps along the slice" } else { "jumps across facets" };
        let mut map = self.map(title);
        let largest = self.view.fields.u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
        let floor = ROUNDINGS * f64::EPSILON * largest;
        let jumps: Vec<(f64, [PlanePoint; 2])> =
            self.edges.iter().filter_map(|e| Some((mean_jump(&self.view, e)?, e.ends))).collect();
        map.scale = Scale::logarithmic("|mean jump|", jumps.iter().map(|j| j.0), floor);
        let none = jumps.iter().filter(|j| j.0 <= floor);
        if self.sections.len() <= MOST_EDGES {
            map.lines.extend(none.map(|j| (Stroke::Coloured(FAINT, 0.5), j.1)));
        }
        match &map.scale {
            None => map.note = Some("none beyond rounding"),
            Some(scale) => {
                let mean = jumps.iter().map(|j| distance(j.1[0], j.1[1])).sum::<f64>()
                    / jumps.len().max(1) as f64;
                let on_paper = 200.0 * mean / (self.high[0] - self.low[0]);
                let width = (0.35 * on_paper).clamp(0.6, 3.0);
                let mut coloured: Vec<(usize, [PlanePoint; 2])> =
                    jumps.iter().filter(|j| j.0 > floor).map(|j| (scale.band(j.0), j.1)).collect();
                sort_by_band(&mut coloured);
                let stroke = |band| Stroke::Coloured(scale.colour(band), width);
                map.lines.extend(coloured.into_iter().map(|(band, ends)| (stroke(band), ends)));
            }
        }
        map.lines.extend(self.rim());
        map
    }

    fn multiplier(&self) -> Panel {
        if !self.problem.has_obstacle() && D == 2 {
            if let Some(graph) = trace::graph(self.problem, self.view.mesh, self.view.fields) {
                return Panel::Graph(graph);
            }
            return Panel::Map(self.multiplier_on_facets());
        }
        let mut map = self.map("multiplier");
        if !self.problem.has_obstacle() && !self.is_along_contact() {
            map.note = Some("only on the contact boundary");
            map.lines.extend(self.rim());
            return Panel::Map(map);
        }
        let mut triangles = Vec::new();
        for section in &self.sections {
            let value = |k: usize| {
                let corner = &section.corners[k];
                Some((
                    corner.at,
                    self.view.density(
                        section.cell,
                        self.touches[section.cell],
                        &corner.barycentric,
                    )?,
                ))
            };
            for k in 2..section.corners.len() {
                if let (Some(a), Some(b), Some(c)) = (value(0), value(k - 1), value(k)) {
                    triangles.push([a, b, c]);
                }
            }
        }
        let drawn = triangles.len();
        shade(&mut map, "density of the multiplier", &triangles, false);
        let all: usize = self.sections.iter().map(|s| s.corners.len() - 2).sum();
        if map.scale.is_none() {
            map.note = Some("none in this slice");
        } else if drawn < all {
            map.title += " (white: none known)";
        }
        map.lines.extend(self.rim());
        Panel::Map(map)
    }

    /// The share of each cell in the square of the error bound.
    fn bound(&self) -> Map {
        let mut map = self.map("share in the error bound");
        let share = |section: &Section| self.view.fields.bound[section.cell];
        let shares = self.sections.iter().map(share);
        map.scale = Scale::logarithmic("share in the square of the bound", shares, 0.0);
        if let Some(scale) = &map.scale {
            let mut bands: Vec<(usize, &Section)> =
                self.sections.iter().map(|section| (scale.band(share(section)), section)).collect();
            // those of a colour together, which keeps files short
            sort_cells_by_band(&mut bands);
            let area = |section: &Section| section.corners.iter().map(|c| c.at).collect();
            map.fills.extend(bands.iter().map(|(band, s)| (scale.colour(*band), area(s))));
        }
        map.lines.extend(self.rim());
        map
    }

    /// The multiplier on a contact boundary that is not straight.
    fn multiplier_on_facets(&self) -> Map {
        let mut map = self.map("multiplier");
        let density = &self.view.fields.discrete_contact.density;
        let mut facets = Vec::new();
        for f in
            self.view.mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact)
        {
            let (cell, local) = (f.cell as usize, usize::from(f.local));
            let ends = self.view.mesh.facet_vertices(cell, local);
            let values: Vec<f64> = ends.filter_map(|v| density[v as usize]).collect();
            if let (Some(points), false) = (self.view.facet(cell, local), values.is_empty()) {
                facets.push((values.iter().sum::<f64>() / values.len() as f64, points));
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

/// Sorts sections by the numbers of their bands; not generic, so that the sorting code is compiled once.
fn sort_by_band(sections: &mut [(usize, [PlanePoint; 2])]) {
    sections.sort_by_key(|section| section.0);
}

/// Sorts sections of cells in this way.
fn sort_cells_by_band(sections: &mut [(usize, &Section)]) {
    sections.sort_by_key(|section| section.0);
}

/// Fills a map with the bands of a function that is linear on triangles, perhaps with its contour
/// lines.
fn shade(map: &mut Map, name: &str, triangles: &[[(PlanePoint, f64); 3]], with_lines: bool) {
    let values = triangles.as_flattened().iter().map(|corner| corner.1);
    let Some(scale) = Scale::linear(name, values) else { return };
    let mut fills = Vec::new();
    let mut lines = Vec::new();
    for triangle in triangles {
        let values = triangle.map(|corner| corner.1);
        let lowest = scale.band(values.iter().copied().fold(f64::INFINITY, f64::min));
        let highest = scale.band(values.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        for k in lowest..=highest {
            let low = if k == lowest { f64::NEG_INFINITY } else { scale.levels[k] };
            let high = if k == highest { f64::INFINITY } else { scale.levels[k + 1] };
            let area = match lowest == highest {
                true => triangle.map(|corner| corner.0).to_vec(),
                false => band(triangle, low, high),
            };
            if area.len() > 2 {
                fills.push((k, area));
            }
            if with_lines && k > lowest && k % STRIDE == 0 {
                lines.extend(contour(triangle, scale.levels[k]).map(|ends| (k, ends)));
            }
        }
    }
    // those of a colour together, which keeps files short
    fills.sort_by_key(|fill| fill.0);
    sort_by_band(&mut lines);
    map.fills.extend(fills.into_iter().map(|(k, area)| (scale.colour(k), area)));
    let ink = |k: usize| if 2 * k < scale.bands() { PAPER } else { INK };
    map.lines.extend(lines.into_iter().map(|(k, ends)| (Stroke::Coloured(ink(k), 0.6), ends)));
    map.scale = Some(scale);
}

/// The default slice: along the contact boundary if that is a coordinate
/// plane, otherwise through the middle across the last coordinate.
pub(crate) fn default_slice<const D: usize>(problem: &Problem<D>, mesh: &Mesh<D>) -> Slice {
    let corners = || {
        let contact = mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact);
        let vertices = contact.flat_map(|f| mesh.facet_vertices(f.cell as usize, f.local.into()));
        vertices.map(|v| &mesh.vertices()[v as usize])
    };
    if let (false, Some(first)) = (problem.has_obstacle(), corners().next()) {
        let is_flat = |axis: &usize| corners().all(|x| x[*axis] == first[*axis]);
        if let Some(axis) = (0..D).find(is_flat) {
            return Slice { axis, at: first[axis] };
        }
    }
    let heights = || mesh.vertices().iter().map(|x| x[D - 1]);
    let (low, high) =
        (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    Slice { axis: D - 1, at: 0.5 * (low + high) }
}
