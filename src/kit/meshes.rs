//! The meshes on which schemes are tested.

use super::split_mix::SplitMix64;
use crate::mesh::{BoundaryCondition, BoxDomain, Mesh, MeshError, TaggedFacet};
use crate::real::Point;

/// Largest displacement of a vertex along an axis, in units of the distance between neighbours.
const SHIFT: f64 = 0.2;

/// A mesh with a name for messages.
pub(super) struct Sample<const D: usize> {
    pub name: &'static str,
    pub mesh: Mesh<D>,
}

/// Subdivisions of the boxes on which matrices are tested.
pub(super) const fn subdivisions(dimension: usize) -> usize {
    match dimension {
        1 => 6,
        2 => 4,
        _ => 2,
    }
}

/// The unit box with Dirichlet data everywhere.
pub(super) fn clamped<const D: usize>() -> BoxDomain<D> {
    BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
}

/// The unit box with Neumann data at the upper end of the first axis, Dirichlet data elsewhere.
pub(super) fn mixed<const D: usize>() -> BoxDomain<D> {
    clamped().side(0, 1, BoundaryCondition::Neumann)
}

/// The Kuhn triangulation of a box.
pub(super) fn regular<const D: usize>(
    domain: &BoxDomain<D>,
    n: usize,
) -> Result<Sample<D>, MeshError> {
    let mesh = Mesh::kuhn_box(domain, [n; D])?;
    Ok(Sample { name: "a regular box", mesh })
}

/// The Kuhn triangulation of a box with pseudo-randomly moved vertices; vertices of the boundary move
/// along the boundary.
pub(super) fn moved<const D: usize>(
    domain: &BoxDomain<D>,
    n: usize,
) -> Result<Sample<D>, MeshError> {
    let mesh = regular::<D>(domain, n)?.mesh;
    let mut random = SplitMix64(7);
    let move_one = |x: &Point<D>| {
        Point::from_fn(|k, _| {
            let shift = SHIFT * (2.0 * random.unit() - 1.0) / n as f64;
            let inside = x[k] > domain.lower[k] && x[k] < domain.upper[k];
            if inside { x[k] + shift } else { x[k] }
        })
    };
    let vertices = mesh.vertices().iter().map(move_one).collect();
    let mesh = Mesh::new(vertices, mesh.cells().to_vec(), &tagged(&mesh, |v| v))?;
    Ok(Sample { name: "a box with moved vertices", mesh })
}

/// The facets of the boundary by the new numbers of their vertices.
pub(crate) fn tagged<const D: usize>(
    mesh: &Mesh<D>,
    number: impl Fn(u32) -> u32,
) -> Vec<TaggedFacet<D>> {
    let tag = |facet: &crate::mesh::BoundaryFacet| {
        let mut vertices = [0; D];
        let old = mesh.facet_vertices(facet.cell as usize, facet.local as usize);
        vertices.iter_mut().zip(old).for_each(|(v, old)| *v = number(old));
        TaggedFacet { vertices, condition: facet.condition }
    };
    mesh.boundary().iter().map(tag).collect()
}

/// A mesh with pseudo-randomly renumbered vertices and cells, and the old number of each vertex and of each cell.
pub(super) fn renumbered<const D: usize>(
    mesh: &Mesh<D>,
    seed: u64,
) -> Result<(Mesh<D>, Vec<u32>, Vec<u32>), MeshError> {
    let mut random = SplitMix64(seed);
    let vertices = random.permutation(mesh.vertices().len());
    let cells = random.permutation(mesh.n_cells());
    let mut new = vec![0; vertices.len()];
    for (k, &old) in vertices.iter().enumerate() {
        new[old as usize] = k as u32;
    }
    let points = vertices.iter().map(|&old| mesh.vertices()[old as usize]).collect();
    let mut corners = Vec::with_capacity(mesh.cells().len());
    for &old in &cells {
        corners.extend(mesh.cell(old as usize).iter().map(|&v| new[v as usize]));
    }
    let mesh = Mesh::new(points, corners, &tagged(mesh, |v| new[v as usize]))?;
    Ok((mesh, vertices, cells))
}
