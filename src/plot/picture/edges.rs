//! Edges of triangles: where two of them meet.

use std::collections::BTreeMap;

use super::triangle::{Triangle, View};
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

/// The size of the mean jump of the function across an edge; none at the boundary.
pub(crate) fn mean_jump<const D: usize>(
    view: &View<'_, D>,
    triangles: &[Triangle],
    edge: &Edge,
) -> Option<f64> {
    let [one, other] = edge.sides[..] else { return None };
    // Simpson's rule is exact for quadratics
    let mean = |side: usize| {
        let cell = triangles[side].cell;
        let (mut ends, mut middle) = (0.0, [0.0; 4]);
        for (k, v) in view.mesh.cell(cell).iter().enumerate() {
            if edge.vertices.contains(v) {
                let mut end = [0.0; 4];
                (end[k], middle[k]) = (1.0, 0.5);
                ends += view.value(cell, &end);
            }
        }
        (ends + 4.0 * view.value(cell, &middle)) / 6.0
    };
    Some((mean(one) - mean(other)).abs())
}
