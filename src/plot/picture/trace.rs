//! The contact boundary of a domain in the plane.

use crate::arrays::{array_of, map_entries};
use crate::mesh::{BoundaryCondition, HalfFacet, Mesh};
use crate::real::Point;

/// Pieces of a facet at which exact data are looked at.
const PARTS: usize = 8;

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
