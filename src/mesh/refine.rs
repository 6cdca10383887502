//! Uniform refinement, with the parents of vertices and cells.

use crate::parallel::vectors::{collect, concat, for_each_chunk_of_groups, map_chunks};

use super::boundary::BoundaryFacet;
use super::edges::{Edges, edge_vertices};
use super::error::MeshError;
use super::part::extent::Extent;
use super::shapes::shape::Shapes;
use super::simplicial::Mesh;
use super::validate::check_size;
use crate::arrays::map_entries;
use crate::instances::compiled;
use crate::memory::in_large_pages;

/// The parents of the vertices of a refined mesh. The parent of fine cell `c` is coarse cell
/// `c / 2^D`; on [parts](super::Part::refine) this holds for the numbers of cells in the whole mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Refinement {
    /// The two coarse vertices whose midpoint a fine vertex is; twice the same one for a vertex of the
    /// coarse mesh.
    pub parents: Vec<[u32; 2]>,
}

/// Children of a simplex. A vertex is the midpoint of two vertices of the parent, named by their
/// local numbers.
type Children = &'static [&'static [[usize; 2]]];

/// The children of a simplex in dimensions 1, 2, 3: those at the corners first, then the inner ones.
/// In three dimensions the inner octahedron is cut around the diagonal between the midpoints of 02 and
/// 13.
///
/// Every list is ascending in lexicographic order.
const CHILDREN: [Children; 3] = [
    &[&[[0, 0], [0, 1]], &[[0, 1], [1, 1]]],
    &[
        &[[0, 0], [0, 1], [0, 2]],
        &[[0, 1], [1, 1], [1, 2]],
        &[[0, 2], [1, 2], [2, 2]],
        &[[0, 1], [0, 2], [1, 2]],
    ],
    &[
        &[[0, 0], [0, 1], [0, 2], [0, 3]],
        &[[0, 1], [1, 1], [1, 2], [1, 3]],
        &[[0, 2], [1, 2], [2, 2], [2, 3]],
        &[[0, 3], [1, 3], [2, 3], [3, 3]],
        &[[0, 1], [0, 2], [0, 3], [1, 3]],
        &[[0, 1], [0, 2], [1, 2], [1, 3]],
        &[[0, 2], [0, 3], [1, 3], [2, 3]],
        &[[0, 2], [1, 2], [1, 3], [2, 3]],
    ],
];

/// The children of a tetrahedron whose inner octahedron is cut around the diagonal between the
/// midpoints of 01 and 23.
const AROUND_01_23: Children = &[
    CHILDREN[2][0],
    CHILDREN[2][1],
    CHILDREN[2][2],
    CHILDREN[2][3],
    &[[0, 1], [0, 2], [0, 3], [2, 3]],
    &[[0, 1], [0, 3], [1, 3], [2, 3]],
    &[[0, 1], [1, 2], [1, 3], [2, 3]],
    &[[0, 1], [0, 2], [1, 2], [2, 3]],
];

/// The children of a tetrahedron whose inner octahedron is cut around the diagonal between the
/// midpoints of 03 and 12.
const AROUND_03_12: Children = &[
    CHILDREN[2][0],
    CHILDREN[2][1],
    CHILDREN[2][2],
    CHILDREN[2][3],
    &[[0, 1], [0, 2], [0, 3], [1, 2]],
    &[[0, 2], [0, 3], [1, 2], [2, 3]],
    &[[0, 3], [1, 2], [1, 3], [2, 3]],
    &[[0, 1], [0, 3], [1, 2], [1, 3]],
];

/// Relative amount by which a diagonal must be shorter than that of Bey's rule to be preferred, above
/// rounding errors of equal diagonals.
const SHORTER: f64 = 1e-3;

/// The children of a cell. A tetrahedron is cut around the shortest diagonal of its inner octahedron
/// (S. Zhang, Houston J. Math. 21 (1995), 541-556); of equal diagonals around the one between the
/// midpoints of 02 and 13 (J. Bey, Computing 55 (1995), 355-378).
///
/// Bey's rule alone makes at most three shapes of descendants, but depends on the order of vertices,
/// which in a mesh from a file is arbitrary, and may choose the longest diagonal. Refined Kuhn
/// triangulations of boxes are Kuhn triangulations.
fn children<const D: usize>(mesh: &Mesh<D>, cell: usize) -> Children {
    if D < 3 {
        return CHILDREN[D - 1];
    }
    let x = |k: usize| mesh.vertices[mesh.cell(cell)[k] as usize];
    let diagonal = |[a, b, c, d]: [usize; 4]| (x(a) + x(b) - x(c) - x(d)).norm();
    let mut best = (diagonal([0, 2, 1, 3]) * (1.0 - SHORTER), CHILDREN[2]);
    for (ends, children) in [([0, 1, 2, 3], AROUND_01_23), ([0, 3, 1, 2], AROUND_03_12)] {
        let length = diagonal(ends);
        if length < best.0 {
            best = (length, children);
        }
    }
    best.1
}

/// The parents of the fine vertices, in lexicographic order.
///
/// In this order of the fine vertices the lists of [`CHILDREN`] are ascending, and stand in the order
/// on which Bey's rule depends.
fn parents(edges: &Edges, n_vertices: usize) -> Vec<[u32; 2]> {
    concat(map_chunks(n_vertices, |vertices| {
        let with_own = |a: u32| {
            let upper = edges.upper_ends(a).iter().map(move |&b| [a, b]);
            std::iter::once([a, a]).chain(upper)
        };
        vertices.flat_map(|a| with_own(a as u32)).collect()
    }))
}

/// The fine vertices of a coarse cell: entry `i, j` is the midpoint of its vertices `i <= j`.
fn midpoints<const D: usize>(edges: &Edges, cell: &[u32], numbers: &[u32]) -> [[u32; 4]; 4] {
    let mut midpoints = [[0; 4]; 4];
    for (i, &a) in cell.iter().enumerate() {
        midpoints[i][i] = a + edges.first_at(a);
    }
    // before the midpoint of edge `k` with lower vertex `a` stand `k` midpoints and `a + 1` vertices
    for (&[i, j], number) in edge_vertices(D).iter().zip(numbers) {
        midpoints[i][j] = cell[i] + 1 + number;
    }
    midpoints
}

impl<const D: usize> Mesh<D> {
    /// Cuts every cell into `2^D` of equal volume; regions, boundary conditions and groups are inherited. New vertices
    /// are middles of edges, or lie on the [shape](Mesh::with_shape) of a boundary group.
    ///
    /// # Errors
    /// `MeshErrorKind::TooLarge`, and `MeshErrorKind::Shape` as [`Mesh::with_shape`] says.
    pub fn refine(&self) -> Result<(Self, Refinement), MeshError> {
        compiled!(const D: fn(&Mesh<D>) -> Result<(Mesh<D>, Refinement), MeshError>
                = Mesh::refine_uniformly
        )(self)
    }
    fn refine_uniformly(&self) -> Result<(Self, Refinement), MeshError> {
        let n_children = 1 << D;
        let n_fine = self.n_cells().saturating_mul(n_children);
        check_size(n_fine, 0)?;
        let (edges, numbers) = Edges::with_cell_edges(self);
        let parents = parents(&edges, self.vertices.len());
        check_size(n_fine, parents.len())?;
        let vertices = collect(parents.len(), |i| {
            let [a, b] = parents[i];
            let (x, y) = (self.vertices[a as usize], self.vertices[b as usize]);
            if a == b { x } else { (x + y) * 0.5 }
        });
        let mut cells = in_large_pages(vec![0; n_fine * (D + 1)]);
        let per_cell = edge_vertices(D).len();
        let cut = |c: usize, out: &mut [u32]| {
            let numbers = &numbers[c * per_cell..(c + 1) * per_cell];
            let midpoints = midpoints::<D>(&edges, self.cell(c), numbers);
            for (out, child) in out.chunks_exact_mut(D + 1).zip(children(self, c)) {
                out.iter_mut().zip(*child).for_each(|(vertex, &[i, j])| *vertex = midpoints[i][j]);
            }
        };
        let group = n_children * (D + 1);
        for_each_chunk_of_groups(&mut cells, group, |range, cells| {
            let first = range.start / group;
            cells.chunks_exact_mut(group).enumerate().for_each(|(k, out)| cut(first + k, out));
        });
        let regions = &self.cell_regions;
        let mut fine = Self {
            vertices,
            cells,
            boundary: self.refined_boundary(),
            is_supported: self.is_supported,
            groups: self.groups.clone(),
            cell_regions: collect(regions.len() << D, |cell| regions[cell >> D]),
            whole: self.whole.map(Extent::refined),
            shapes: Shapes::default(),
        };
        if self.has_shapes() {
            let is_old = |(_, [a, b]): &(u32, &[u32; 2])| a == b;
            let numbers: Vec<u32> = (0..).zip(&parents).filter(is_old).map(|(v, _)| v).collect();
            let number = |&ends: &[u32; 2]| map_entries(ends, |v| numbers[v as usize]);
            fine.shapes = self.shapes.renumbered(&numbers);
            let in_fine: Vec<[u32; 2]> = parents.iter().map(number).collect();
            fine.follow_shapes(&in_fine, |cell| cell >> D)?;
        }
        Ok((fine, Refinement { parents }))
    }

    /// The boundary facets of the refined mesh.
    fn refined_boundary(&self) -> Vec<BoundaryFacet> {
        let mut boundary = Vec::with_capacity(self.boundary.len() << (D - 1));
        for facet in &self.boundary {
            for (k, child) in children(self, facet.cell as usize).iter().enumerate() {
                // a fine facet lies on the coarse facet if no parent of its vertices is the opposite vertex
                let off = |v: &[usize; 2]| v.contains(&(facet.local as usize));
                for local in 0..=D {
                    if child.iter().enumerate().all(|(i, v)| i == local || !off(v)) {
                        let cell = (facet.cell << D) + k as u32;
                        boundary.push(BoundaryFacet { cell, local: local as u8, ..*facet });
                    }
                }
            }
        }
        BoundaryFacet::sort(&mut boundary);
        boundary
    }
}
