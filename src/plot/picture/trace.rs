//! The contact boundary of a domain in the plane.

use crate::arrays::{array_of, map_entries};
use crate::mesh::{HalfFacet, Mesh};
use crate::real::Point;

/// Pieces of a facet at which exact data are looked at.
const PARTS: usize = 8;

/// The vertices of a facet in the plane.
pub(crate) fn ends<const D: usize>(mesh: &Mesh<D>, (cell, local): HalfFacet) -> [u32; 2] {
    let mut vertices = mesh.facet_vertices(cell, local);
    array_of(|_| vertices.next().expect("a facet in the plane has two vertices"))
}

/// The facets of a contact boundary in short pieces.
pub(crate) fn samples<const D: usize>(mesh: &Mesh<D>, facets: &[HalfFacet]) -> Vec<[Point<D>; 2]> {
    let mut samples = Vec::new();
    for &facet in facets {
        let [a, b] = map_entries(ends(mesh, facet), |v| mesh.vertices()[v as usize]);
        let at = |k: usize| a + (b - a) * (k as f64 / PARTS as f64);
        samples.extend((0..PARTS).map(|k| [at(k), at(k + 1)]));
    }
    samples
}
