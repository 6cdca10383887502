//! The contact boundary of a domain in the plane.

use super::axes::{Stroke, Symbol};
use super::graph::Graph;
use crate::arrays::{array_of, map_entries};
use crate::measure::Fields;
use crate::mesh::{BoundaryCondition, HalfFacet, Mesh};
use crate::problem::Problem;
use crate::real::Point;

/// Pieces of a facet at which exact data are looked at.
const PARTS: usize = 8;
/// A boundary that departs by less than this from a line, in units of the domain, is straight.
const STRAIGHT: f64 = 1e-9;

/// The facets of the contact boundary.
pub(crate) fn facets<const D: usize>(mesh: &Mesh<D>) -> Vec<HalfFacet> {
    let contact = mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact);
    contact.map(|f| (f.cell as usize, usize::from(f.local))).collect()
}

/// The vertices of a facet in the plane.
pub(crate) fn ends<const D: usize>(mesh: &Mesh<D>, (cell, local): HalfFacet) -> [u32; 2] {
    let mut vertices = mesh.facet_vertices(cell, local);
    array_of(|_| vertices.next().expect("a facet in the plane has two vertices"))
}

/// The contact boundary in short pieces.
pub(crate) fn samples<const D: usize>(mesh: &Mesh<D>) -> Vec<[Point<D>; 2]> {
    let mut samples = Vec::new();
    for facet in facets(mesh) {
        let [a, b] = map_entries(ends(mesh, facet), |v| mesh.vertices()[v as usize]);
        let at = |k: usize| a + (b - a) * (k as f64 / PARTS as f64);
        samples.extend((0..PARTS).map(|k| [at(k), at(k + 1)]));
    }
    samples
}

/// The multiplier along a straight contact boundary; none on another.
pub(crate) fn graph<const D: usize>(
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    fields: &Fields,
) -> Option<Graph> {
    let facets: Vec<[u32; 2]> = facets(mesh).into_iter().map(|facet| ends(mesh, facet)).collect();
    let points = || facets.as_flattened().iter().map(|&v| mesh.vertices()[v as usize]);
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
    let mut graph = Graph::of_found("multiplier", [["x", "y"][axis], "density"], "density found");
    let density = &fields.discrete_contact.density;
    for &[from, to] in &facets {
        if let [Some(a), Some(b)] = [from, to].map(|v| density[v as usize]) {
            graph.lines.push((Stroke::Solution, [[along(from), a], [along(to), b]]));
        }
    }
    let exact = problem.exact.as_ref();
    if let Some(multiplier) = exact.and_then(|e| e.multiplier.as_ref()) {
        for sample in samples(mesh) {
            let ends = sample.map(|x| [x[axis], multiplier(&x)]);
            graph.lines.push((Stroke::Exact, ends));
        }
        graph.legend.push((Symbol::Line(Stroke::Exact), "exact density".to_owned()));
    }
    let contact = fields.discrete_contact.facets.iter().map(|&facet| {
        let [a, b] = ends(mesh, facet).map(along);
        [a.min(b), a.max(b)]
    });
    let set = exact.and_then(|e| e.contact.as_ref());
    let marks = set.iter().flat_map(|set| &set.free_boundary).map(|x| x[axis]).collect();
    graph.mark(contact.collect(), marks);
    Some(graph)
}
