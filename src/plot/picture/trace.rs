//! The contact boundary of a domain in the plane.

use super::axes::{CONTACT, Stroke, Symbol};
use super::graph::Graph;
use crate::arrays::map_entries;
use crate::measure::Fields;
use crate::mesh::{BoundaryCondition, Mesh};
use crate::problem::Problem;
use crate::real::Point;

/// Pieces of a facet at which exact data are looked at.
const PARTS: usize = 8;
/// A boundary that departs by less than this from a line, in units of the domain, is straight.
const STRAIGHT: f64 = 1e-9;

/// A piece of a facet of the contact boundary.
pub(crate) struct Sample<const D: usize> {
    pub ends: [Point<D>; 2],
}

/// The facets of the contact boundary: cell, number in it, vertices.
fn facets<const D: usize>(mesh: &Mesh<D>) -> Vec<(usize, usize, Vec<u32>)> {
    let contact = mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact);
    contact
        .map(|f| {
            let (cell, local) = (f.cell as usize, usize::from(f.local));
            (cell, local, mesh.facet_vertices(cell, local).collect())
        })
        .collect()
}

/// The contact boundary in short pieces.
pub(crate) fn samples<const D: usize>(mesh: &Mesh<D>) -> Vec<Sample<D>> {
    let mut samples = Vec::new();
    for (_, _, vertices) in facets(mesh) {
        let [a, b] = map_entries([0, 1], |k| mesh.vertices()[vertices[k] as usize]);
        let at = |k: usize| a + (b - a) * (k as f64 / PARTS as f64);
        samples.extend((0..PARTS).map(|k| Sample { ends: [at(k), at(k + 1)] }));
    }
    samples
}

/// The multiplier along a straight contact boundary; none on another.
pub(crate) fn graph<const D: usize>(
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    fields: &Fields,
) -> Option<Graph> {
    let facets = facets(mesh);
    let points = || {
        let vertices = facets.iter().flat_map(|f| &f.2);
        vertices.map(|&v| mesh.vertices()[v as usize])
    };
    let extent = |axis: usize| {
        let (low, high) = points()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x[axis]), h.max(x[axis])));
        high - low
    };
    let axis = usize::from(extent(1) > extent(0));
    if extent(1 - axis) > STRAIGHT * mesh.domain_diameter() {
        return None;
    }
    let along = |v: u32| mesh.vertices()[v as usize][axis];
    let mut graph = Graph {
        title: "multiplier".to_owned(),
        axes: [["x", "y"][axis].to_owned(), "density".to_owned()],
        legend: vec![(Symbol::Line(Stroke::Solution), "density found".to_owned())],
        ..Graph::default()
    };
    let density = &fields.discrete_contact.density;
    for (_, _, vertices) in &facets {
        if let [Some(a), Some(b)] = map_entries([0, 1], |k| density[vertices[k] as usize]) {
            let ends = [[along(vertices[0]), a], [along(vertices[1]), b]];
            graph.lines.push((Stroke::Solution, ends));
        }
    }
    let exact = problem.exact.as_ref();
    if let Some(multiplier) = exact.and_then(|e| e.multiplier.as_ref()) {
        for sample in samples(mesh) {
            let ends = sample.ends.map(|x| [x[axis], multiplier(&x)]);
            graph.lines.push((Stroke::Exact, ends));
        }
        graph.legend.push((Symbol::Line(Stroke::Exact), "exact density".to_owned()));
    }
    for &(cell, local) in &fields.discrete_contact.facets {
        let ends: Vec<f64> = mesh.facet_vertices(cell, local).map(along).collect();
        graph.contact.push([ends[0].min(ends[1]), ends[0].max(ends[1])]);
    }
    if !graph.contact.is_empty() {
        graph.legend.push((Symbol::Area(CONTACT), "in contact".to_owned()));
    }
    if let Some(set) = exact.and_then(|e| e.contact.as_ref()) {
        graph.marks = set.free_boundary.iter().map(|x| x[axis]).collect();
    }
    if !graph.marks.is_empty() {
        graph.legend.push((Symbol::Mark, "free boundary, exact".to_owned()));
    }
    Some(graph)
}
