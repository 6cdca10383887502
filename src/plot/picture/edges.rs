//! Edges of triangles: where two of them meet.

use std::collections::BTreeMap;

use super::triangle::Triangle;
use crate::mesh::Mesh;

/// An edge, and the triangles beside it by their numbers.
pub(crate) struct Edge {
    pub vertices: [u32; 2],
    pub sides: Vec<usize>,
}

/// All edges of triangles, each once.
pub(crate) fn edges<const D: usize>(mesh: &Mesh<D>, triangles: &[Triangle]) -> Vec<Edge> {
    let mut known: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (k, triangle) in triangles.iter().enumerate() {
        let [a, b, c] = triangle.locals.map(|local| mesh.cell(triangle.cell)[local]);
        for vertices in [[a, b], [a, c], [b, c]] {
            known.entry(vertices).or_default().push(k);
        }
    }
    known.into_iter().map(|(vertices, sides)| Edge { vertices, sides }).collect()
}
